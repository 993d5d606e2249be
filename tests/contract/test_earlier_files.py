"""What an earlier version has written is read as that read it: a data folder and an archive of a task, by 1.0.0.

Beside them files_1_0_0.zip has what 1.0.0 answered of that folder. The task was made over REST: three demonstrations
imported, a run of one path, a version of it that was edited, and its plan.
"""

import asyncio
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from teachpath.io.import_settings import ImportSettings
from teachpath.offline.task_archive import unpacked_archive
from tests.contract import stations
from tests.contract.desk import Desk

FILES = Path(__file__).with_name("files_1_0_0.zip")


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("earlier")
    with zipfile.ZipFile(FILES) as packed:
        packed.extractall(folder)
    return folder


@pytest.fixture(scope="module")
def station(files: Path) -> Iterator[Desk]:
    """A station of this version on the data folder of the earlier one."""
    with stations.station_in(files / "data") as station, asyncio.Runner() as loop:
        yield Desk(station, loop)


def lost(place: str, before: Any, now: Any) -> Iterator[str]:
    """Yield what is not as it was; fields may have come."""
    if isinstance(before, dict) and isinstance(now, dict):
        for name, value in before.items():
            yield from lost(f"{place}.{name}", value, now.get(name))
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for number, (one, other) in enumerate(zip(before, now, strict=True)):
            yield from lost(f"{place}[{number}]", one, other)
    elif before != now:
        yield f"{place} was {before} and is {now}"


def test_a_station_answers_of_earlier_data_as_the_earlier_one_did(station: Desk, files: Path) -> None:
    answers = json.loads((files / "answers.json").read_text())
    assert len(answers) > 10
    for address, before in answers.items():
        assert list(lost(address, before, station.get(address).json())) == []
    assert list(lost("x", {"a": [{"b": 1}]}, {"a": [{"b": 2}]})) == ["x.a[0].b was 1 and is 2"]


def test_an_earlier_plan_has_its_certificate_and_its_motion(station: Desk) -> None:
    (listed,) = station.get("/plans").json()
    plan = station.get(f"/plans/{listed['id']}").json()
    assert plan["certificate"]["clearance"]["value"] == listed["clearance"]
    assert len(station.get(f"/plans/{listed['id']}/motion").json()["times"]) > 10


def test_an_earlier_archive_and_its_recordings_are_imported(station: Desk, files: Path) -> None:
    known = station.get("/tasks/blocks/demonstrations").json()
    with unpacked_archive(files / "blocks.zip", ImportSettings()) as unpacked:
        assert unpacked.task.name == "blocks"
        imported = [station.import_("again", file.read_bytes())[0] for file in unpacked.files]
    for field in ("samples", "duration", "grasp", "release", "verdict", "statistics"):
        assert [each[field] for each in imported] == [each[field] for each in known]
