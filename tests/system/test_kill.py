"""Fifty recorders, killed at random moments: what was recorded before the last second is on the disk."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from teachpath.io.store.salvage import salvage
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.offline.doctor import examine
from teachpath.recording.settings import RecordingSettings
from tests.waiting import HANG

pytestmark = pytest.mark.system

VICTIMS = 50
SECOND = 1.0  # [s] of the recorder's clock


@pytest.fixture(scope="module")
def victims(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    folder = tmp_path_factory.mktemp("victims")
    command = [sys.executable, "-m", "tests.system.victims", str(folder), str(VICTIMS), "1"]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=HANG)
    return [json.loads(line) for line in done.stdout.splitlines()]


def recorded(data: Path) -> set[int]:
    found: set[int] = set()
    for file in (data / "recordings").rglob("*.mcap*"):
        _, samples, _ = salvage(file)
        found |= {sample.sequence for sample in samples}
    return found


def test_nothing_before_the_last_second_is_ever_missing(victims: list[dict[str, Any]]) -> None:
    assert len(victims) == VICTIMS
    safe = 0
    for victim in victims:
        _, killed = victim["recorded"][-1]
        due = {number for number, at in victim["recorded"] if at < killed - SECOND}
        missing = due - recorded(Path(victim["data"]))
        assert not missing, (victim["data"], sorted(missing), len(victim["recorded"]))
        safe += len(due)
    assert safe > 20 * VICTIMS


def test_the_doctor_makes_of_each_what_can_be_made_and_harms_no_earlier_take(victims: list[dict[str, Any]]) -> None:
    takes = rescued = 0
    for victim in victims:
        data = Path(victim["data"])
        before = {f.name: f.read_bytes() for f in data.rglob("*.mcap")}
        store = Store(StoreSettings(data_dir=str(data)))
        try:
            rows = store.demonstrations("lift")
            findings = examine(store, RecordingSettings(), {"paper": paper_scene()}, data)
            after = store.demonstrations("lift")
            assert after[: len(rows)] == rows
            assert store.recordings.unfinished() == []
            for row in after:
                assert len(store.recordings.samples(row.recording)) == row.samples
            assert len({row.recording for row in after}) == len(list(data.rglob("*.mcap")))
        finally:
            store.close()
        assert {name: (data / "recordings" / "lift" / name).read_bytes() for name in before} == before
        takes += len(rows)
        rescued += sum(len(finding.demonstrations) for finding in findings)
    assert takes > VICTIMS / 2
    assert rescued > 0
