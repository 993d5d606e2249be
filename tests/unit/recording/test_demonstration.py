import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableRecording
from teachpath.recording.demonstration import object_trajectory, point_to_world, to_world
from teachpath.recording.phases import TransportSpan
from teachpath.records import Calibration
from tests.unit.recording.hands import demonstration

CUT = TransportSpan(20, 70)
IDENTITY = Calibration("identity")
CARRIED_FROM = (0.5, 0.0, 0.48)


def test_the_object_starts_where_it_stands_and_keeps_its_place_in_the_hand() -> None:
    samples = demonstration()
    trajectory = object_trajectory(samples, CUT, IDENTITY, CARRIED_FROM)
    hand = np.array([s.position for s in samples[20:70]])
    assert np.allclose(trajectory.positions[0], CARRIED_FROM, atol=1e-15)
    assert np.allclose(trajectory.positions - hand, trajectory.positions[0] - hand[0], atol=1e-12)
    assert np.all(np.diff(trajectory.times) > 0)


def test_turning_the_hand_swings_the_object_about_it() -> None:
    samples = demonstration()
    half = Rotation.from_rotvec([0, 0, np.pi / 2]).as_quat(scalar_first=True)
    turned = [*samples[:69], samples[69]._replace(orientation=tuple(half.tolist()))]
    at_rest = [s._replace(position=(0.5, 0.0, 0.5)) for s in turned]
    trajectory = object_trajectory(at_rest, CUT, IDENTITY, (0.6, 0.0, 0.5))
    assert np.allclose(trajectory.positions[-1], [0.5, 0.1, 0.5], atol=1e-12)
    assert trajectory.orientations is not None
    assert np.allclose(np.linalg.norm(trajectory.orientations, axis=1), 1.0)


def test_late_samples_are_put_back_and_duplicates_left_out() -> None:
    samples = demonstration()
    shuffled = [*samples[:30], samples[31], samples[30], samples[31], *samples[32:]]
    straight = object_trajectory(samples, CUT, IDENTITY, CARRIED_FROM)
    again = object_trajectory(shuffled, TransportSpan(20, 71), IDENTITY, CARRIED_FROM)
    assert np.array_equal(straight.positions, again.positions)
    assert np.array_equal(straight.times, again.times)


def test_a_calibration_is_applied_to_positions_and_turns() -> None:
    quarter = tuple(Rotation.from_rotvec([0, 0, np.pi / 2]).as_quat(scalar_first=True).tolist())
    calibration = Calibration("bench", 2.0, quarter, (1.0, 0.0, 0.0))
    assert np.allclose(to_world(calibration, np.array([1.0, 0.0, 0.5])), [1.0, 2.0, 1.0])
    assert np.allclose(to_world(calibration, np.ones((4, 3)))[2], [-1.0, 2.0, 2.0])
    assert np.allclose(point_to_world(calibration)((1.0, 1.0, 1.0)), [-1.0, 2.0, 2.0])


def test_untracked_samples_are_no_part_of_the_trajectory() -> None:
    samples = demonstration()
    ghosts = [s._replace(tracked=False, position=(9.0, 9.0, 9.0)) if 40 <= i < 45 else s for i, s in enumerate(samples)]
    assert np.abs(object_trajectory(ghosts, CUT, IDENTITY, None).positions).max() < 1.0
    with pytest.raises(UnusableRecording, match="in view"):
        object_trajectory([s._replace(tracked=False) for s in samples], CUT, IDENTITY, None)
