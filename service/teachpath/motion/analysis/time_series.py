"""Reduces a recorded motion to time series of as many points as a plot shows, without losing peaks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.records import JointState, Matrix, Setpoint


@dataclass(frozen=True, eq=False)
class TimeSeries:
    """A recorded motion over time.

    Attributes:
        times: (n,) since the first setpoint [s].
        positions: (n, joints) of the joints [rad].
        velocities: (n, joints), each the one of largest magnitude since the time before [rad/s].
        torques: (n, joints), likewise [N m].
        tool: (n, 3) grasp point [m], world.
        object: (n, 3) carried object [m], world; empty when there is none.
        gripper_closed: (n,).
        tracking_error: (n,) largest since the time before [rad].
        lateness: (n,) of the setpoints sent since the time before, the largest [s]; 0 where none was sent.
    """

    times: Array
    positions: Matrix
    velocities: Matrix
    torques: Matrix
    tool: Matrix
    object: Matrix
    gripper_closed: tuple[bool, ...]
    tracking_error: Array
    lateness: Array


def time_series(setpoints: Sequence[Setpoint], states: Sequence[JointState], points: int, arm: Arm) -> TimeSeries:
    """Reduce a recorded motion to at most `points` points.

    Args:
        setpoints: in the order in which they were sent.
        states: of the arm, with increasing stamps.
        points: at least 2.
        arm: that moved.
    """
    states = [state for state in states if len(state.position) == arm.joint_count]  # what others sent is none of its
    count = len(states)
    if count == 0:
        return _nothing(arm.joint_count)
    groups = np.unique(np.linspace(0, count, min(points, count) + 1).astype(np.int64))[:-1]
    begin = setpoints[0].nominal_ns if setpoints else states[0].stamp_ns
    stamps = np.array([s.stamp_ns - begin for s in states], dtype=np.float64) / 1e9
    ends = np.append(groups[1:], count) - 1  # the newest state of each group represents it
    positions = np.array([states[k].position for k in ends])
    seen = states[-1].object_orientation != (0.0, 0.0, 0.0, 0.0)
    late = np.zeros(len(groups))
    if setpoints:
        sent = np.array([s.sent_ns - begin for s in setpoints], dtype=np.float64) / 1e9
        behind = np.array([s.sent_ns - s.nominal_ns for s in setpoints], dtype=np.float64) / 1e9
        np.maximum.at(late, np.minimum(np.searchsorted(stamps[ends], sent), len(groups) - 1), behind)
    return TimeSeries(
        times=stamps[ends],
        positions=positions,
        velocities=_largest(np.array([s.velocity for s in states]), groups),
        torques=_largest(np.array([s.torque for s in states]), groups),
        tool=tool_pose(positions, arm)[:, :3, 3],
        object=np.array([states[k].object_position for k in ends]) if seen else np.empty((0, 3)),
        gripper_closed=tuple(states[k].gripper_closed for k in ends),
        tracking_error=np.maximum.reduceat(np.array([s.tracking_error for s in states]), groups),
        lateness=late,
    )


def _largest(values: Array, groups: NDArray[np.int64]) -> Array:
    """Return the value of largest magnitude in each group of rows (n, joints), with its sign."""
    high, low = np.maximum.reduceat(values, groups), np.minimum.reduceat(values, groups)
    return np.where(high > -low, high, low)


def _nothing(joint_count: int) -> TimeSeries:
    joints, place, value = np.empty((0, joint_count)), np.empty((0, 3)), np.empty(0)
    return TimeSeries(value, joints, joints, joints, place, place, (), value, value)
