"""The object's trajectory in the world, which is what a demonstration teaches."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableRecording
from teachpath.recording.phases import TransportSpan
from teachpath.records import Array, Calibration, Pose, Quaternion, Sample, SampleColumns, Trajectory, Vector

NO_END = 2**64  # over every number


def to_world(calibration: Calibration, positions: Array) -> Array:
    """Map tracker positions (..., 3) to the world [m]: p_world = scale * R p + offset."""
    rotation = Rotation.from_quat(calibration.rotation, scalar_first=True)
    flat = rotation.apply(np.atleast_2d(positions)) * calibration.scale + np.array(calibration.offset)
    return np.asarray(flat.reshape(np.shape(positions)), dtype=np.float64)


def turn_to_world(calibration: Calibration, orientation: Quaternion) -> Array:
    """Return an orientation of the tracker's frame as a rotation matrix (3, 3) to the world."""
    turns = Rotation.from_quat([calibration.rotation, orientation], scalar_first=True).as_matrix()
    return np.asarray(turns[0] @ turns[1], dtype=np.float64)


def point_to_world(calibration: Calibration) -> Callable[[Vector], Vector]:
    """Return the map of `to_world` for one position at a time, without the cost of arrays."""
    turn = Rotation.from_quat(calibration.rotation, scalar_first=True).as_matrix() * calibration.scale
    (a, b, c), (d, e, f), (g, h, i) = turn.tolist()
    u, v, w = calibration.offset

    def mapped(position: Vector) -> Vector:
        x, y, z = position
        return a * x + b * y + c * z + u, d * x + e * y + f * z + v, g * x + h * y + i * z + w

    return mapped


def usable_samples(samples: Sequence[Sample]) -> SampleColumns:
    """Return the tracked samples in the order of their numbers, each once."""
    columns = SampleColumns.of(samples)
    tracked = columns.select(columns.tracked)
    return tracked if columns.is_in_order else tracked.select(np.unique(tracked.sequence, return_index=True)[1])


def place_of(columns: SampleColumns, number: int) -> int:
    """Return the index of the first sample, of those in the order of their numbers, that has at least this number."""
    return len(columns) if number >= NO_END else int(np.searchsorted(columns.sequence, np.uint64(number)))


def carried_numbers(samples: Sequence[Sample], cut: TransportSpan) -> tuple[int, int]:
    """Return the number of the first sample of the transport phase, and that of the first sample after it.

    A sample belongs to the phase by its number, whenever it came.
    """
    after = samples[cut.release].sequence if cut.release < len(samples) else NO_END
    return samples[cut.grasp].sequence, after


def transport_samples(samples: Sequence[Sample], cut: TransportSpan) -> SampleColumns:
    """Return the tracked samples of the transport phase in the order of their numbers, each once."""
    grasp, after = carried_numbers(samples, cut)
    usable = usable_samples(samples)
    return usable[place_of(usable, grasp) : place_of(usable, after)]


def object_trajectory(
    samples: Sequence[Sample],
    cut: TransportSpan,
    calibration: Calibration,
    carried: Vector | None,
    *,
    left_out: Collection[int] = (),
) -> Trajectory:
    """Return the object's motion from grasp to release.

    The object keeps its pose in the hand: with T_hand the pose of the hand, that of the object is
    T_hand(t) T_hand(grasp)^-1 T_object(start). Without measured orientations the object keeps its offset from the hand
    in the world; without an object the trajectory is that of the hand.

    Args:
        samples: of the demonstration, in the order received. Duplicates and untracked samples are left out, late ones
            are sorted in.
        cut: its transport phase.
        carried: start of the object's centre [m, world], or None.
        left_out: numbers of samples whose position is an outlier, repeats the one before or is another source's.

    Raises:
        UnusableRecording: fewer than 2 usable samples.
    """
    carrying = transport_samples(samples, cut)
    passed_over = np.isin(carrying.sequence, np.fromiter(left_out, np.uint64, len(left_out)))
    ordered = _forward_in_time(carrying.select(~passed_over))
    if len(ordered) < 2:
        raise UnusableRecording(
            f"only {len(ordered)} usable samples between grasp and release; is the tracker in view of its source?"
        )
    times = (ordered.device_ns - ordered.device_ns[0]) * 1e-9
    hand = to_world(calibration, ordered.position)
    if not ordered.orientation.any(axis=1).all():
        offset = np.zeros(3) if carried is None else np.array(carried) - hand[0]
        return Trajectory(times, hand + offset, None)
    world = Rotation.from_quat(calibration.rotation, scalar_first=True)
    turned = world * Rotation.from_quat(ordered.orientation, scalar_first=True)
    if carried is None:
        return Trajectory(times, hand, _continuous(turned.as_quat(scalar_first=True)))
    since_grasp = turned * turned[0].inv()
    positions = hand + since_grasp.apply(np.array(carried) - hand[0])
    return Trajectory(times, positions, _continuous(since_grasp.as_quat(scalar_first=True)))


def object_pose(grasped: Sample, now: Sample, calibration: Calibration, carried: Vector) -> Pose | None:
    """Return the pose of the object in the hand, to world from object; None while the hand is not tracked.

    Args:
        grasped: the sample with which the hand grasped the object.
        now: the newest sample.
        carried: start of the object's centre [m, world]. The rotation is counted from the start.
    """
    if not (grasped.tracked and now.tracked):
        return None
    if now.device_ns <= grasped.device_ns:
        return carried, (1.0, 0.0, 0.0, 0.0)
    trajectory = object_trajectory((grasped, now), TransportSpan(0, 2), calibration, carried)
    x, y, z = trajectory.positions[-1].tolist()
    w, i, j, k = (1.0, 0.0, 0.0, 0.0) if trajectory.orientations is None else trajectory.orientations[-1].tolist()
    return (x, y, z), (w, i, j, k)


def _forward_in_time(samples: SampleColumns) -> SampleColumns:
    """Return the samples that are later than all before, by the device's clock."""
    newest = np.maximum.accumulate(samples.device_ns)
    later = np.concatenate([[True], samples.device_ns[1:] > newest[:-1]])[: len(samples)]
    return samples.select(later)


def _continuous(quaternions: Array) -> Array:
    """Choose the signs so that neighbours lie on one half of the sphere."""
    flips = np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0
    signs = np.concatenate([[1.0], np.where(flips, -1.0, 1.0).cumprod()])
    return np.asarray(quaternions * signs[:, None])
