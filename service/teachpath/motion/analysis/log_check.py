"""Checks a log of setpoints against limits and path, from the numbers alone.

The check is independent of the code that makes motion: it uses the table of the arm, but neither trajectories nor the
governor nor our kinematics. It differences the setpoints, and computes the tool's position by a chain of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableRecording
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.nurbs import Curve
from teachpath.records import SerialArm, Vector

PATH_TOLERANCE: Final = 1e-4  # m, of the tool to the path
LIMIT_TOLERANCE: Final = 1e-6  # of a limit, for the rounding of differences
PERIOD_TOLERANCE: Final = 0.01  # of the period, between setpoints
PATH_CHORDS: Final = 20_000  # that stand for the path in the measurement of distances
UPPER_ARM_WIDTH: Final = 0.295  # m, to its outer face from the plane in which joint 2 turns
POINT_NAMES: Final = ("the elbow", "the elbow's outside", "the wrist", "the tool")
QUANTITIES: Final = ("speed", "acceleration", "jerk")


@dataclass(frozen=True, eq=False)
class SetpointLog:
    """A log of setpoints.

    Attributes:
        times: (n,) when each is due [s].
        positions: (n, joints) of the joints [rad].
        on_path: (n,) whether the log has the tool on the path; None when it does not say.
        missing: number of setpoints that the numbering of the log skips.
        restarts: rows before which the arm came to rest by itself, on a way to rest that the log does not hold.
    """

    times: Array
    positions: Array
    on_path: NDArray[np.bool_] | None = None
    missing: int = 0
    restarts: tuple[int, ...] = ()


@dataclass(frozen=True)
class LogCheck:
    """The result of a check.

    Attributes:
        faults: sentences, one for each limit or requirement that is broken.
        measured: sentences, one for each that is kept.
    """

    faults: tuple[str, ...]
    measured: tuple[str, ...]


def check_log(log: SetpointLog, path: Curve | None, arm: Arm) -> LogCheck:
    """Check a log of setpoints.

    Args:
        log: at least 4 setpoints.
        path: that the tool follows [m], world; None to check only the limits.
        arm: whose setpoints they are.

    Raises:
        UnusableRecording: they are of an arm with another number of joints.
    """
    if (count := log.positions.shape[1]) != arm.joint_count:
        raise UnusableRecording(f"setpoints of {count} joints; the arm, {arm.identity}, has {arm.joint_count}")
    faults, measured = [], []
    period = float(np.median(np.diff(log.times)))
    measured.append(f"{len(log.times)} setpoints over {log.times[-1] - log.times[0]:.2f} s at {1 / period:.0f} Hz")
    if log.missing:
        faults.append(f"{log.missing} setpoints are missing, so it cannot be judged whole")
    if log.restarts:
        when = log.times[log.restarts[0] - 1] - log.times[0]
        measured.append(
            f"{len(log.restarts)} times setpoints were late and the arm came to rest by itself, first after {when:.3f} "
            "s; how it did so is not in the log"
        )
    limits = arm.limits
    on_path = _path(log, path, arm) if path is not None else []
    speed = _tool_speed(log, period, arm)
    for judged in (_positions(log, limits), *_differences(log, period, limits), speed, *on_path):
        (measured if judged[0] else faults).append(judged[1])
    if path is None:
        measured.append("without a path: only the limits were judged")
    return LogCheck(tuple(faults), tuple(measured))


def _positions(log: SetpointLog, limits: JointLimits) -> tuple[bool, str]:
    outside = np.maximum(limits.lower - log.positions, log.positions - limits.upper)
    row, joint = np.unravel_index(int(np.argmax(outside)), outside.shape)
    least = float(outside[row, joint])
    where = f"{limits.names[joint]} at {log.times[row] - log.times[0]:.3f} s"
    if least > 0:
        between = f"{limits.lower[joint]:.3f} to {limits.upper[joint]:.3f}"
        return False, f"{where} is {least:.4f} rad beyond its limit ({between})"
    return True, f"every joint within its range, least {-least:.3f} rad to spare: {where}"


def _differences(log: SetpointLog, period: float, limits: JointLimits) -> list[tuple[bool, str]]:
    """Check speed, acceleration and jerk; the arm is taken to rest before the log and wherever nothing was sent."""
    steps, moves = np.diff(log.times), np.any(np.diff(log.positions, axis=0) != 0.0, axis=1)
    uneven = np.abs(steps - period) > PERIOD_TOLERANCE * period
    restarted = np.isin(np.arange(1, len(log.times)), log.restarts)  # with each step
    rested = np.concatenate([[True], (~moves | restarted)[:-1]]) | restarted  # before each step
    broken = np.flatnonzero(uneven & ~(rested & (steps > period)))
    found = []
    if len(broken):
        first = int(broken[0])
        when, gap = log.times[first] - log.times[0], 1e3 * steps[first]
        sentence = f"{len(broken)} setpoints of a moving arm are not one period apart, the first at {when:.3f} s"
        found.append((False, f"{sentence} ({gap:.1f} ms)"))
    runs = np.split(np.arange(len(log.times)), np.flatnonzero(uneven & rested & (steps > period) | restarted) + 1)
    each = (limits.speed, limits.acceleration, limits.jerk)
    for order, (name, limit) in enumerate(zip(QUANTITIES, each, strict=True), 1):
        uses = np.concatenate([_use(log.positions[run], order) / period**order / limit for run in runs])
        row, joint = np.unravel_index(int(np.argmax(uses)), uses.shape)
        where = f"{limits.names[joint]} at {log.times[row] - log.times[0]:.3f} s"
        largest = float(uses[row, joint])
        found.append((largest <= 1.0 + LIMIT_TOLERANCE, f"{name} limit used to {100 * largest:.2f} % by {where}"))
    return found


def _tool_speed(log: SetpointLog, period: float, arm: Arm) -> tuple[bool, str]:
    """Check the speed of elbow, wrist and tool; a setpoint that was sent late does not make the arm slower."""
    names, points = _points(arm)
    speeds = np.array([np.linalg.norm(np.diff(_point(log.positions, arm, *p), axis=0), axis=1) for p in points])
    speeds[:, np.array(log.restarts, dtype=int) - 1] = 0.0
    point, row = np.unravel_index(int(np.argmax(speeds)), speeds.shape)
    largest, name = float(speeds[point, row]) / period, names[point]
    limit = np.inf if arm.tool_speed is None else arm.tool_speed
    allowed = "no limit is set" if arm.tool_speed is None else f"allowed {limit:g} m/s (motion.tool_speed)"
    when = log.times[row] - log.times[0]
    return largest <= limit * (1.0 + LIMIT_TOLERANCE), f"{name} at up to {largest:.4f} m/s at {when:.3f} s, {allowed}"


def _points(arm: Arm) -> tuple[tuple[str, ...], list[tuple[int, Vector]]]:
    """Return the points whose speed is limited: their names, and of each the link and its place in the link's frame."""
    tool = (len(arm.limits.lower), _tool_in_flange(arm))
    if arm.model is not None:
        joints = list(enumerate(arm.model.joints, start=1))[1:]
        on_axes = [(number, joint.anchor) for number, joint in joints]
        return (*(joint.name for _, joint in joints), POINT_NAMES[-1]), [*on_axes, tool]
    return POINT_NAMES, [(2, (0.0, 0.0, 0.0)), (2, (0.0, 0.0, UPPER_ARM_WIDTH)), (4, (0.0, 0.0, 0.0)), tool]


def _use(positions: Array, order: int) -> Array:
    """Return the differences of an order (n, joints) that end in each of the positions (n, joints), after a rest."""
    return np.abs(np.diff(np.concatenate([np.repeat(positions[:1], order, axis=0), positions]), order, axis=0))


def _path(log: SetpointLog, path: Curve, arm: Arm) -> list[tuple[bool, str]]:
    points = path(np.linspace(0.0, 1.0, PATH_CHORDS + 1))
    tool = _tool(log.positions, arm)
    said = log.on_path if log.on_path is not None else _guessed(tool, points)
    if not said.any():
        return [(False, "the tool never comes to the start of the path")]
    off = _distance(tool[said], points)
    worst = int(np.argmax(off))
    when = log.times[said][worst] - log.times[0]
    nearest = cKDTree(points).query(tool[said])[1]
    share = float(nearest.max() - nearest.min()) / PATH_CHORDS
    return [
        (
            float(off[worst]) <= PATH_TOLERANCE,
            f"tool up to {1e3 * off[worst]:.4f} mm off the path at {when:.3f} s, allowed 0.1 mm",
        ),
        (True, f"{int(said.sum())} setpoints on the path, over {100 * share:.1f} % of its parameter"),
    ]


def _guessed(tool: Array, points: Array) -> NDArray[np.bool_]:
    """Return (n,) which setpoints should be on the path: from the first at its start to the last at its end.

    Where none is at its end, they go on to the last of all.
    """
    starts = np.flatnonzero(np.linalg.norm(tool - points[0], axis=1) <= PATH_TOLERANCE)
    ends = np.flatnonzero(np.linalg.norm(tool - points[-1], axis=1) <= PATH_TOLERANCE)
    said = np.zeros(len(tool), dtype=np.bool_)
    if len(starts):
        later = ends[ends > starts[0]]
        said[starts[0] : (later[-1] + 1 if len(later) else None)] = True
    return said


def _distance(places: Array, points: Array) -> Array:
    """Return the distance (n,) [m] of positions (n, 3) to a chain of chords through points (m, 3)."""
    nearest = cKDTree(points).query(places)[1]
    best = np.full(len(places), np.inf)
    for shift in (-1, 0):
        a = points[np.clip(nearest + shift, 0, len(points) - 2)]
        chord = points[np.clip(nearest + shift, 0, len(points) - 2) + 1] - a
        along = np.einsum("ij,ij->i", places - a, chord) / np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-30)
        best = np.minimum(best, np.linalg.norm(places - a - np.clip(along, 0.0, 1.0)[:, None] * chord, axis=1))
    return best


def _tool(q: Array, arm: Arm) -> Array:
    """Return the grasp point (n, 3) [m, world] at configurations (n, joints)."""
    return _point(q, arm, len(arm.limits.lower), _tool_in_flange(arm))


def _tool_in_flange(arm: Arm) -> Vector:
    if arm.model is not None:
        return arm.model.tool[0]
    return (0.0, 0.0, arm.tool_length) if arm.tool is None else arm.tool.position


def _point(q: Array, arm: Arm, number: int, place: Vector) -> Array:
    """Return a point (n, 3) [m, world] of a link's frame at configurations (n, joints), link by link to the base."""
    point = np.tile(place, (len(q), 1))
    if arm.model is not None:
        return _model_point(q, arm.model, number, point)
    for joint in reversed(range(number)):
        link = arm.links[joint]
        x, y, z = point.T
        ca, sa = np.cos(link.alpha), np.sin(link.alpha)
        x, y, z = x + link.a, ca * y - sa * z, sa * y + ca * z + link.d
        c, s = np.cos(q[:, joint]), np.sin(q[:, joint])
        point = np.column_stack([c * x - s * y, s * x + c * y, z])
    return point


def _model_point(q: Array, model: SerialArm, number: int, point: Array) -> Array:
    """Return points (n, 3) [m, world] of a link's frame of a user's model, link by link to the base."""
    for link, angle in reversed(list(zip(model.links[:number], q.T, strict=False))):
        axis, anchor = np.array(link.joint.axis), np.array(link.joint.anchor)
        point = anchor + Rotation.from_rotvec(angle[:, None] * axis).apply(point - anchor)
        point = Rotation.from_quat(link.pose[1], scalar_first=True).apply(point) + link.pose[0]
    return np.asarray(Rotation.from_quat(model.base[1], scalar_first=True).apply(point) + model.base[0])
