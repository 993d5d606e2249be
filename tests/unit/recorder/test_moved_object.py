"""An object that lies elsewhere in each demonstration: told to the recorder, or where the hand grasps."""

import numpy as np
import pytest

from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.importing import Source, import_file
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Amendment, Calibration, Demonstration, ObjectPose, Vector
from tests.unit.recorder.recorders import SCENE
from tests.unit.recording.hands import demonstration

SETTINGS = RecordingSettings()
PLACES: tuple[Vector, ...] = ((0.5, 0.0, 0.5), (0.3, -0.3, 0.5), (0.6, 0.25, 0.55))
IDENTITY_ORIENTATION = (1.0, 0.0, 0.0, 0.0)


@pytest.fixture
def store(tmp_path) -> Store:
    return Store(StoreSettings(data_dir=str(tmp_path / "data")))


def annotations(store: Store) -> Annotations:
    return Annotations(store, SETTINGS, lambda _: SCENE)


def recorded(store: Store, *, at_grasp: bool, reported: dict[int, ObjectPose] | None = None) -> list[Demonstration]:
    """Show a task at the places, one after the other; `reported` says where the object lies before a demonstration."""
    store.ensure_task("lift", scene="paper", calibration="identity", object_at_grasp=at_grasp)
    lies: list[ObjectPose | None] = [None]
    setup = RecordingSetup(
        "lift", "glove", Calibration("identity"), SCENE, reported_object=lambda: lies[-1], object_at_grasp=at_grasp
    )
    session = RecordingSession(store, SETTINGS, setup)
    finished = []
    for number, place in enumerate(PLACES):
        lies.append((reported or {}).get(number))
        finished += [made for s in demonstration(1 + 110 * number, at=place) if (made := session.add(s))]
    finished += session.finish()
    return [row for row, _ in finished]


def start(store: Store, row: Demonstration) -> np.ndarray:
    return annotations(store).trajectory(row).positions[0]


def test_a_hand_may_grasp_where_the_object_was_told_to_lie_and_nowhere_else(store: Store) -> None:
    centres = {1: ObjectPose((0.3, -0.3, 0.48), IDENTITY_ORIENTATION)}
    rows = recorded(store, at_grasp=False, reported=centres)
    assert [row.object_pose for row in rows] == [None, centres[1]]  # the third grasp is beside the object
    for row, centre in zip(rows, [(0.5, 0.0, 0.48), (0.3, -0.3, 0.48)], strict=True):
        np.testing.assert_allclose(start(store, row), centre, atol=1e-12)


def test_in_a_task_whose_object_lies_at_the_grasp_a_hand_may_grasp_anywhere(store: Store) -> None:
    rows = recorded(store, at_grasp=True)
    for row, place in zip(rows, PLACES, strict=True):
        assert row.object_pose == ObjectPose(place, SCENE.carried.orientation)  # type: ignore[union-attr]
        np.testing.assert_allclose(start(store, row), place, atol=1e-12)
    stored = store.demonstrations("lift")
    assert [row.object_pose for row in stored] == [row.object_pose for row in rows]


def test_an_object_that_moves_with_the_hand_stays_where_it_was_grasped(store: Store) -> None:
    store.ensure_task("lift", scene="paper", calibration="identity")
    hand = demonstration(1)
    seen = iter(s.position for s in hand)  # a camera that follows the object in the hand
    lies = {"at": None}
    setup = RecordingSetup("lift", "glove", Calibration("identity"), SCENE, reported_object=lambda: lies["at"])
    session = RecordingSession(store, SETTINGS, setup)
    finished = []
    for number, s in enumerate(hand):
        position = next(seen)
        if number > 20:
            lies["at"] = ObjectPose(position)
        finished += [made for made in [session.add(s)] if made]
    finished += session.finish()
    ((row, trajectory),) = finished
    assert row.object_pose is None
    np.testing.assert_allclose(trajectory.positions[0], SCENE.carried.position, atol=1e-12)  # type: ignore[union-attr]


def test_a_trim_moves_the_place_of_an_object_that_lies_at_the_grasp(store: Store) -> None:
    first = recorded(store, at_grasp=True)[0]
    begin = first.grasp + 10
    trimmed = annotations(store).amend(first.id, Amendment(trim=(begin, first.release)))
    hand = store.recordings.samples(first.recording)[begin].position
    assert trimmed.object_pose is not None
    assert trimmed.object_pose.position == pytest.approx(hand)
    np.testing.assert_allclose(start(store, trimmed), hand, atol=1e-12)


def test_an_import_and_its_export_keep_where_the_object_lay(store: Store, tmp_path) -> None:
    rows = [f"{0.02 * i},{0.3 + 0.004 * i},-0.2,0.5\n" for i in range(80)]
    content = ("t,x,y,z\n" + "".join(rows)).encode()
    known = {"scene": SCENE, "calibration": Calibration("identity"), "limits": ImportSettings()}
    ((row, trajectory),) = import_file(
        store, SETTINGS, Source("a.csv", content), task="lift", object_at_grasp=True, **known
    )
    assert row.object_pose == ObjectPose((0.3, -0.2, 0.5), SCENE.carried.orientation)  # type: ignore[union-attr]
    mcap = store.recordings.path(row.recording).read_bytes()
    other = Store(StoreSettings(data_dir=str(tmp_path / "other")))
    ((again, same),) = import_file(other, SETTINGS, Source("a.mcap", mcap, "mcap"), task="lift", **known)
    assert again.object_pose == row.object_pose
    np.testing.assert_array_equal(same.positions, trajectory.positions)
