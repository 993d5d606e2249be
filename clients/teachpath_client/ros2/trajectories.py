"""Motions of joints as trajectory_msgs/JointTrajectory, and whether one is the motion of a plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from teachpath_client.ros2.messages import SECOND, Malformed, make

Floats = NDArray[np.float64]

MAX_POINTS: Final = 100_000  # of a trajectory
MAX_GAP: Final = 0.1  # [s] between two points: what is told more coarsely could be another motion
POSITION_TOLERANCE: Final = 1e-4  # [rad]; what four decimals leave
SPEED_TOLERANCE: Final = 1e-2  # [rad/s]
TIME_TOLERANCE: Final = 1e-3  # [s] of begin and end


@dataclass(frozen=True, eq=False)
class JointMotion:
    """A motion of joints, in the order of the arm.

    Attributes:
        times: (n,) [s], from 0, strictly increasing.
        positions: (n, joints) [rad].
        velocities: (n, joints) [rad/s]; None: it does not say.
    """

    times: Floats
    positions: Floats
    velocities: Floats | None

    def at(self, times: Floats) -> tuple[Floats, Floats]:
        """Return positions and speeds at times (m,); behind the end the joints rest there.

        Between the points it is the cubic that meets position and speed of both, so that it needs velocities.
        """
        assert self.velocities is not None
        inside = np.minimum(times, self.times[-1])
        left = np.clip(np.searchsorted(self.times, inside, side="right") - 1, 0, len(self.times) - 2)
        span = np.diff(self.times)[left][:, None]
        u = (inside - self.times[left])[:, None] / span
        p, q = self.positions[left], self.positions[left + 1]
        v, w = self.velocities[left] * span, self.velocities[left + 1] * span
        cubic, square = 2.0 * (p - q) + v + w, 3.0 * (q - p) - 2.0 * v - w
        speeds = (v + u * (2.0 * square + u * 3.0 * cubic)) / span
        speeds[times > self.times[-1]] = 0.0
        return p + u * (v + u * (square + u * cubic)), speeds


def read_trajectory(message: Any, names: Sequence[str]) -> JointMotion:
    """Return the motion of a JointTrajectory.

    Args:
        message: with at least one point.
        names: of the arm's joints, in its order; the message may have another one.

    Raises:
        Malformed: it is of other joints, not whole, not finite, or does not run from 0 on.
    """
    if sorted(message.joint_names) != sorted(names):
        raise Malformed(f"it moves {', '.join(message.joint_names) or 'no joint'}; the arm has {', '.join(names)}")
    if len(message.points) > MAX_POINTS:
        raise Malformed(f"{len(message.points)} points are over the limit of {MAX_POINTS}")
    order = [message.joint_names.index(name) for name in names]
    positions = _rows([point.positions for point in message.points], order, "positions")
    given = [len(point.velocities) > 0 for point in message.points]
    if any(given) and not all(given):
        raise Malformed(f"point {given.index(not given[0])} differs from the first in whether it has velocities")
    velocities = _rows([point.velocities for point in message.points], order, "velocities") if given[0] else None
    elapsed = [point.time_from_start for point in message.points]
    times = np.array([each.sec + each.nanosec / SECOND for each in elapsed])
    if abs(times[0]) > TIME_TOLERANCE:
        raise Malformed(f"its first point is at {times[0]:g} s instead of 0")
    steps = np.diff(times)
    if not np.all(steps > 0.0):
        raise Malformed(f"point {int(np.argmin(steps > 0.0)) + 1} is not later than the one before")
    return JointMotion(times, positions, velocities)


def difference(asked: JointMotion, planned: JointMotion, duration: float) -> str:
    """Return where a motion is not a plan's own, in words; empty: nowhere.

    Args:
        asked: the motion that is compared.
        planned: the plan's own, with velocities, at so many instants that the cubic between them is its motion.
        duration: of the plan [s].
    """
    steps, end = np.diff(asked.times), asked.times[-1]
    if len(steps) == 0 or steps.max() > MAX_GAP + TIME_TOLERANCE:
        return f"its points are over {MAX_GAP:g} s apart"
    if not duration - TIME_TOLERANCE <= end <= duration + MAX_GAP:
        return f"it lasts {end:.3f} s, the plan {duration:.3f} s"
    positions, speeds = planned.at(asked.times)
    found = _farthest(asked.positions - positions, asked.times, POSITION_TOLERANCE, "rad")
    if not found and asked.velocities is not None:
        found = _farthest(asked.velocities - speeds, asked.times, SPEED_TOLERANCE, "rad/s")
    return found


def trajectory_fields(motion: JointMotion, efforts: Floats, names: Sequence[str]) -> dict[str, Any]:
    """Return `joint_names` and `points` of a JointTrajectory; efforts (n, joints) [N m]."""
    none = np.empty(0)
    speeds = np.empty((len(motion.times), 0)) if motion.velocities is None else motion.velocities
    points = []
    for time, position, speed, effort in zip(motion.times.tolist(), motion.positions, speeds, efforts, strict=True):
        seconds, nanoseconds = divmod(round(time * SECOND), SECOND)
        elapsed = make("builtin_interfaces/msg/Duration", sec=seconds, nanosec=nanoseconds)
        of = {"positions": position, "velocities": speed, "accelerations": none, "effort": effort}
        points.append(make("trajectory_msgs/msg/JointTrajectoryPoint", **of, time_from_start=elapsed))
    return {"joint_names": list(names), "points": points}


def _rows(values: Sequence[Any], order: Sequence[int], what: str) -> Floats:
    wrong = next((number for number, row in enumerate(values) if len(row) != len(order)), None)
    if wrong is not None:
        raise Malformed(f"point {wrong} has {len(values[wrong])} {what} instead of {len(order)}")
    rows = np.array(values, np.float64)[:, order]
    if not np.isfinite(rows).all():
        raise Malformed(f"the {what} of point {int(np.argmin(np.isfinite(rows).all(axis=1)))} are not finite")
    return rows


def _farthest(off: Floats, times: Floats, tolerance: float, unit: str) -> str:
    row, joint = np.unravel_index(int(np.argmax(np.abs(off))), off.shape)
    worst = abs(float(off[row, joint]))
    if worst <= tolerance:
        return ""
    return f"joint {joint + 1} is {worst:.3g} {unit} off at {times[row]:.3f} s, tolerance {tolerance:g}"
