from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.file_samples import Source
from teachpath.offline.importing import import_file
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Sample, Scene, Shape, Trajectory
from tests.unit.recording.hands import demonstration

EMPTY_SCENE = Scene("empty")
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
    store: Store, content: bytes, task: str = "wipe", scene: Scene = EMPTY_SCENE
) -> list[tuple[Demonstration, Trajectory]]:
    source = Source("wipe.csv", content)
    return import_file(
        store, RecordingSettings(), source, task=task, scene=scene, calibration=IDENTITY, limits=ImportSettings()
    )


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


# round trips


def recorded(store: Store, samples: list[Sample], calibration: Calibration = IDENTITY) -> bytes:
    """Return a recording of `samples` as its file holds it."""
    take = store.recordings.begin(
        f"demo-{len(store.recordings.finished())}", RecordingHeader("old", "glove", calibration)
    )
    for sample in samples:
        take.write(sample)
    return take.finish({}).read_bytes()


def test_a_recording_is_imported_with_its_own_samples_phases_and_calibration(store: Store) -> None:
    shown = demonstration(at=(0.5, 0.0, 0.98))
    lab = Calibration("lab", 1.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, -0.5))
    source = Source("take.mcap", recorded(store, shown, lab), "mcap")
    ((row, _),) = import_file(
        store, RecordingSettings(), source, task="lift", scene=BLOCK, calibration=IDENTITY, limits=ImportSettings()
    )
    assert (row.source, row.calibration, row.verdict) == ("glove", lab, "clean")
    assert (row.grasp, row.release) == (20, 70)
    again = store.recordings.samples(row.recording)
    assert [(s.sequence, s.device_ns, s.receive_ns, s.position) for s in again] == [
        (s.sequence, s.device_ns, s.receive_ns, s.position) for s in shown[: row.samples]
    ]


def test_an_exported_recording_imports_as_the_same_demonstration(store: Store) -> None:
    ((first, way),) = imported(store, csv(60))
    exported = store.recordings.path(first.recording).read_bytes()
    source = Source("again.mcap", exported, "mcap")
    ((second, same),) = import_file(
        store,
        RecordingSettings(),
        source,
        task="wipe",
        scene=EMPTY_SCENE,
        calibration=IDENTITY,
        limits=ImportSettings(),
    )
    assert np.array_equal(way.positions, same.positions)
    assert np.array_equal(way.times, same.times)
    changed = {"id": second.id, "number": 2, "created_ns": second.created_ns, "recording": second.recording}
    assert first.digest is not None
    assert second.digest is not None
    assert replace(first.digest, sha256=second.digest.sha256) == second.digest  # each file says of what it is
    assert replace(first, **changed, digest=second.digest) == second


@pytest.mark.parametrize("keep", [0.0, 0.1, 0.5, 0.9])
def test_a_torn_recording_is_refused_and_leaves_nothing(store: Store, keep: float) -> None:
    content = recorded(store, demonstration())
    source = Source("torn.mcap", content[: int(keep * len(content))], "mcap")
    with pytest.raises(UnusableRecording, match=r"torn\.mcap: no whole recording .*teachpath doctor"):
        import_file(
            store,
            RecordingSettings(),
            source,
            task="lift",
            scene=EMPTY_SCENE,
            calibration=IDENTITY,
            limits=ImportSettings(),
        )
    assert store.tasks() == []


def test_a_recording_in_which_nothing_is_grasped_is_refused(store: Store) -> None:
    source = Source("idle.mcap", recorded(store, demonstration()[:15]), "mcap")
    with pytest.raises(UnusableRecording, match="does not begin at the object"):
        import_file(
            store, RecordingSettings(), source, task="lift", scene=BLOCK, calibration=IDENTITY, limits=ImportSettings()
        )
    assert store.tasks() == []
