"""Moves of the joints to a path and away from it: straight lines of the joints, checked against the scene."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Final

import numpy as np
from ruckig import InputParameter, Ruckig, Trajectory

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import line_speed_bound
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, Load, shape_pose
from teachpath.motion.collision.continuous import ContinuousCheck, prove_distance
from teachpath.motion.collision.suction import CUP_REACH
from teachpath.motion.refusals import first_accepted
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.timed_trajectory import MAX_TABLE_STEP, TimedTrajectory, apply_chain_rule

MIN_FINGER_DISTANCE: Final = 0.001  # m, of open fingers to the object between them


def straight_move(
    start: Array, goal: Array, limits: MotionLimits, *, arm: Arm, margins: tuple[float, float, float]
) -> TimedTrajectory:
    """Return the fastest motion from rest to rest on the straight line between two configurations (Ruckig).

    Args:
        start: configuration (joints,) [rad].
        goal: configuration (joints,) [rad].
        limits: to keep.
        arm: that moves.
        margins: shares of speed, acceleration and jerk limits that the motion itself uses.
    """
    turn = float(np.abs(goal - start).max())
    direction = (goal - start) / turn
    slowest = np.maximum(np.abs(direction), 1e-12)
    shared = limits.scaled(*margins)
    speed = float(np.min(shared.speed / slowest))
    if np.isfinite(limits.tool_speed):
        speed = min(speed, margins[0] * limits.tool_speed / line_speed_bound(start, direction, turn, arm))
    run = rest_to_rest(
        turn,
        speed,
        float(np.min(shared.acceleration / slowest)),
        float(np.min(shared.jerk / slowest)),
        MAX_TABLE_STEP,
    )
    place, rate, acceleration, jerk, step = run
    count = len(place) - 1
    ahead, still = np.append(direction, 1.0), np.zeros((count + 1, len(direction) + 1))
    line = [np.append(start, 0.0) + place[:, None] * ahead, np.tile(ahead, (count + 1, 1)), still, still]
    return TimedTrajectory(apply_chain_rule(line, rate, acceleration, jerk), step, limits)


def rest_to_rest(
    distance: float, speed: float, acceleration: float, jerk: float, step: float
) -> tuple[Array, Array, Array, Array, float]:
    """Return the fastest motion in one dimension from rest to rest (one call of Ruckig).

    Args:
        distance: to go, positive.
        speed: limit [distance/s].
        acceleration: limit [distance/s^2].
        jerk: limit [distance/s^3].
        step: largest time between two instants [s].

    Returns:
        (n,) place, speed, acceleration and jerk at even instants, and the time between two of them [s].
    """
    inputs = InputParameter(1)
    inputs.target_position = [distance]
    inputs.max_velocity, inputs.max_acceleration, inputs.max_jerk = [speed], [acceleration], [jerk]
    run = Trajectory(1)
    Ruckig(1).calculate(inputs, run)
    count = max(1, int(np.ceil(run.duration / step)))
    place, rate, slope, third = _phases(run, np.linspace(0.0, run.duration, count + 1))
    place[-1], rate[-1], slope[-1] = distance, 0.0, 0.0
    return place, rate, slope, third, float(run.duration) / count


def _phases(run: Trajectory, instants: Array) -> tuple[Array, Array, Array, Array]:
    """Return place, speed, acceleration and jerk (n,) of a one-dimensional trajectory at instants (n,) [s]."""
    profile = run.profiles[0][0]
    begins = np.concatenate([[0.0], np.cumsum(profile.t)])[:-1]
    phase = np.clip(np.searchsorted(begins, instants, side="right") - 1, 0, len(begins) - 1)
    p, v, a, j = (np.array(values)[phase] for values in (profile.p, profile.v, profile.a, profile.j))
    t = instants - begins[phase]
    return p + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j, j


def prove_move_clear(
    model: CollisionModel,
    waypoints: Array,
    settings: MotionSettings,
    *,
    load: Load | None,
    gripper_open: bool,
    move_name: str,
) -> float:
    """Prove the clearance [m] of straight lines of the joints between configurations (n, joints), and return it.

    Open fingers must stay away from an object that stands in the scene, or keep it between them.

    Raises:
        PathRefused: something comes too near; the sentence begins with `move_name`.
    """

    def measure(q: Array) -> list[Clearance]:
        return model.clearances(q, load=load, gripper_open=gripper_open)

    proved = prove_distance(
        ContinuousCheck.along_lines(waypoints, model.lever_arms(load)), measure, settings.clearance_min
    )
    if proved.distance < settings.clearance_min:
        near = proved.nearest
        raise PathRefused(f"{move_name}: {near.describe_violation(proved.distance, settings.clearance_min)}")
    if load is not None and load.position is not None and gripper_open:
        is_cup = model.arm.gripper == "suction"  # whose lip touches the object, and gives way
        least = -CUP_REACH if is_cup else MIN_FINGER_DISTANCE
        fingers = prove_distance(
            ContinuousCheck.along_lines(waypoints, model.lever_arms()),
            partial(model.finger_distances, load=load),
            least,
        )
        if fingers.distance < least:
            what = "suction cup" if is_cup else "open fingers"
            raise PathRefused(f"{move_name}: the {what} would hit the object; is the path centred on it?")
    return proved.distance


def joint_waypoints(
    model: CollisionModel,
    here: Array,
    goal: Array,
    settings: MotionSettings,
    *,
    load: Load | None = None,
    gripper_open: bool = False,
    move_name: str = "on the way to the path's start",
) -> Sequence[Array]:
    """Find the waypoints from one configuration to another: on a straight line of the joints, or over the arm's home.

    Returns:
        Two or three configurations (joints,), from `here` to `goal`.

    Raises:
        PathRefused: neither is free; the sentence says what comes too near on the straight line.
    """

    def checked(waypoints: Sequence[Array]) -> Sequence[Array]:
        stacked = np.array(waypoints)
        prove_move_clear(model, stacked, settings, load=load, gripper_open=gripper_open, move_name=move_name)
        return waypoints

    try:
        return first_accepted([(here, goal), (here, np.array(settings.home), goal)], checked)
    except PathRefused as refusal:
        raise PathRefused(f"{refusal}; bring the arm nearer to its home first") from None


def waypoints_home(
    model: CollisionModel, start: Array, goal: Array, above_goal: Array, settings: MotionSettings
) -> tuple[Array, Array]:
    """Find the waypoints from a path to the arm's home, with the carried object left at the goal.

    Args:
        model: of arm and scene.
        start: configuration (joints,) at the path's start.
        goal: configuration (joints,) at its end.
        above_goal: configuration (joints,) above its end.
        settings: home and clearances.

    Raises:
        PathRefused: the move home is not free.
    """
    home = np.array(settings.home)
    load = placed_load(model, start, goal)
    what = "on the way home from the goal"
    prove_move_clear(
        model, np.stack([above_goal, home]), settings, load=load, gripper_open=load is not None, move_name=what
    )
    return above_goal, home


def placed_load(model: CollisionModel, start: Array, goal: Array) -> Load | None:
    """Return the load that stands at the goal, after it was carried from configuration `start` to `goal` (joints,)."""
    carried = model.scene.carried
    if carried is None:
        return None
    pose = tool_pose(goal, model.arm) @ np.linalg.inv(tool_pose(start, model.arm)) @ shape_pose(carried)
    x, y, z = (float(value) for value in pose[:3, 3])
    return Load(position=(x, y, z), rotation=pose[:3, :3])
