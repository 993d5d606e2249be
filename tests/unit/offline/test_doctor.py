from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from teachpath.errors import Conflict
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.doctor import examine
from teachpath.offline.lock import StationLock
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Scene, Shape, Task
from tests.unit.recording.hands import demonstration

SCENE = Scene("paper", (), Shape("block", "box", (0.04, 0.04, 0.04), (0.5, 0.0, 0.48)))


@pytest.fixture
def data(tmp_path: Path) -> Path:
    return tmp_path / "data"


@pytest.fixture
def store(data: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(data)))
    store.ensure_task("lift", scene="paper", calibration="identity")
    yield store
    store.close()


def torn_file(store: Store, count: int, keep: float = 1.0) -> Path:
    """Write `count` samples, flush, and leave the file as a killed process would; `keep` of its bytes remain."""
    take = store.recordings.begin("demo-torn", RecordingHeader("lift", "glove", Calibration("identity")))
    for i, sample in enumerate(demonstration()[:count]):
        take.write(sample)
        if i % 25 == 24:
            take.flush()
    take.leave()
    (part,) = store.recordings.unfinished()
    part.write_bytes(part.read_bytes()[: int(part.stat().st_size * keep)])
    return part


def examined(store: Store, data: Path) -> list[str]:
    return [f.sentence for f in examine(store, RecordingSettings(), {"paper": SCENE}, data)]


def test_a_torn_recording_becomes_a_demonstration_and_the_torn_file_is_kept(store: Store, data: Path) -> None:
    part = torn_file(store, 100)
    (sentence,) = examined(store, data)
    assert "100 samples" in sentence
    (row,) = store.demonstrations("lift")
    assert row.verdict == "clean"
    assert any("cut off" in note for note in row.statistics.notes)
    assert len(store.recordings.samples(row.recording)) == row.samples == 100
    assert part.with_name(part.name + ".salvaged").exists()
    assert examined(store, data) == []


def test_a_take_cut_off_in_transport_is_a_reject(store: Store, data: Path) -> None:
    torn_file(store, 60)
    examined(store, data)
    assert [row.verdict for row in store.demonstrations("lift")] == ["reject"]


@pytest.mark.parametrize("keep", [0.0, 0.01, 0.2, 0.4, 0.6, 0.8, 0.95])
def test_any_cut_is_examined_without_harm_to_what_is_stored(store: Store, data: Path, keep: float) -> None:
    torn_file(store, 100)
    examined(store, data)
    before = store.demonstrations("lift")
    torn_file(store, 100, keep=keep)
    assert len(examined(store, data)) == 1
    assert store.demonstrations("lift")[: len(before)] == before


def test_the_doctor_keeps_away_from_a_running_service(store: Store, data: Path) -> None:
    torn_file(store, 100)
    with StationLock(data), pytest.raises(Conflict, match="stop it first"):
        examine(store, RecordingSettings(), {"paper": SCENE}, data)


def test_a_whole_recording_without_a_row_is_adopted_as_it_was_judged(store: Store, data: Path) -> None:
    torn_file(store, 100)
    examined(store, data)
    (row,) = store.demonstrations("lift")
    other = Store(StoreSettings(data_dir=str(data), database=f"sqlite:///{data / 'other.sqlite'}"))
    try:
        assert f"made {row.id}" in examined(other, data)[0]
        assert other.demonstrations("lift") == [row]
        assert replace(other.task("lift"), created_ns=0) == Task("lift", "paper", "identity", 0)
        assert examined(other, data) == []
    finally:
        other.close()
