from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.store import Store, StoreSettings
from teachpath.offline.importing import Source, import_file
from teachpath.recording import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, Shape, Trajectory

EMPTY = Scene("empty")
BLOCK = Scene("paper", (), Shape("block", "box", (0.04, 0.04, 0.04), (0.5, 0.0, 0.48)))
IDENTITY = Calibration("identity")


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(tmp_path)))
    yield store
    store.close()


def csv(points: int) -> bytes:
    return ("t,x,y,z\n" + "".join(f"{i * 0.02},{i / 100},0,0.5\n" for i in range(points))).encode()


def imported(
    store: Store, content: bytes, task: str = "wipe", scene: Scene = EMPTY
) -> list[tuple[Demonstration, Trajectory]]:
    source = Source("wipe.csv", content)
    return import_file(store, RecordingSettings(), source, task=task, scene=scene, calibration=IDENTITY)


def test_an_imported_motion_is_a_clean_demonstration_of_its_whole_length(store: Store) -> None:
    ((row, trajectory),) = imported(store, csv(60))
    assert (row.samples, row.grasp, row.release, row.verdict) == (60, 0, 60, "clean")
    assert np.allclose(trajectory.positions[:, 0], np.arange(60) / 100)
    assert np.allclose(np.diff(trajectory.times), 0.02)
    assert store.demonstrations("wipe") == [row]


def test_a_refused_file_leaves_nothing(store: Store) -> None:
    with pytest.raises(UnusableRecording, match="empty"):
        imported(store, b"")
    assert store.tasks() == []
    with pytest.raises(UnusableInput, match="cannot name a task"):
        imported(store, csv(60), task="../wipe")
    assert store.tasks() == []


def test_a_motion_that_is_too_short_says_so(store: Store) -> None:
    with pytest.raises(UnusableRecording, match="10 samples are under the least of 20"):
        imported(store, csv(10))
    assert store.demonstrations("wipe") == []


def test_a_motion_away_from_the_object_says_where_the_object_is(store: Store) -> None:
    with pytest.raises(UnusableRecording, match=r"at \(0\.5, 0\.0, 0\.48\) m"):
        imported(store, csv(40), scene=BLOCK)
