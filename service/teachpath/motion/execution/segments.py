"""The segments of an execution, from where the arm rests to its end: moves and rests, checked against the scene."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

import numpy as np

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, Load, grasped_load
from teachpath.motion.execution.governor import Governor
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.torque_limited import move_within_torques
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.jog import jog_trajectory, time_at_length
from teachpath.motion.timing.joint_moves import joint_waypoints, placed_load, waypoints_home
from teachpath.motion.timing.timed_trajectory import TimedTrajectory
from teachpath.records import Plan

MIN_MOVE: Final = 1e-9  # [rad] below which there is nothing to move


@dataclass(frozen=True, eq=False)
class MotionState:
    """The arm's nominal motion at one instant: (joints,) in rad, rad/s, rad/s^2.

    `output` names the output that is on; empty: none is.
    """

    position: Array
    velocity: Array
    acceleration: Array
    gripper_closed: bool
    on_path: bool = False
    output: str = ""


@dataclass(frozen=True, eq=False)
class Detour:
    """Motion that is no segment: a step along the path, or the way back to it.

    Attributes:
        name: in words, for the operator; empty on the path.
        trajectories: to be followed in order.
        end_time: plan time [s] at which a step ends; None for a way back, after which the program goes on.
    """

    name: str
    trajectories: tuple[TimedTrajectory, ...]
    end_time: float | None = None

    @classmethod
    def of_step(cls, trajectory: TimedTrajectory, begin: float, length: float, rate: float) -> Detour:
        """Plan a step along a trajectory, from rest to rest.

        Args:
            begin: plan time at which it begins [s].
            length: arc length at which it ends [m].
            rate: setpoints a second [Hz].

        Raises:
            Conflict: the trajectory ends where it begins.
        """
        end_time = time_at_length(trajectory, length)
        return cls("", (jog_trajectory(trajectory, begin, end_time, rate),), end_time)

    @property
    def is_step(self) -> bool:
        """Whether it is a step along the path, at whose end the arm is held."""
        return self.end_time is not None


@dataclass(frozen=True, eq=False)
class RestPoint:
    """Where an arm rests that has followed the way to rest of one setpoint.

    Attributes:
        position: (joints,) [rad].
        segment: index of the segment of that setpoint.
        detour: that was followed, if any.
        governors: of the detour and of the segment in order, with their plan times [s]; that of the one which moves is
            where the way to rest ends.
        elapsed: of the segment's rest [s].
        on_path: whether that setpoint was on the learned path.
    """

    position: Array
    segment: int = 0
    detour: Detour | None = None
    governors: tuple[tuple[Governor, float], ...] = ()
    elapsed: float = 0.0
    on_path: bool = False


@dataclass(frozen=True, eq=False)
class Segment:
    """A part of an execution: motion along a trajectory, or a rest when there is none.

    Attributes:
        name: in words, for the operator.
        before_path: whether it comes before the path.
        is_path: whether it follows the learned path.
        gripper_closed: whether the gripper is closed while it lasts.
        rest_time: duration of a rest [s].
        output: name of the output that is on while it goes forward; empty: none.
    """

    name: str
    before_path: bool
    gripper_closed: bool
    trajectory: TimedTrajectory | None = None
    rest_time: float = 0.0
    is_path: bool = False
    output: str = ""

    def begin(self, before: MotionState) -> MotionState:
        """Return the state at rest where the segment before has ended.

        An output that is on in both goes on without a gap; another one is switched on by the segment's first period.
        """
        q, output = before.position, before.output if before.output == self.output else ""
        return MotionState(q, 0.0 * q, 0.0 * q, self.gripper_closed, output=output)


def plan_segments(plan: Plan, start_q: Array, settings: MotionSettings, arm: Arm, dwell: float) -> list[Segment]:
    """Return the segments of an execution that begins in the configuration `start_q` (joints,).

    Raises:
        PathRefused: the way from there to the start of the path, or home from its goal, is not free, or the motors are
            too weak for it.
    """
    carries = plan.scene.carried is not None
    load = Load(position=plan.scene.carried.position) if plan.scene.carried else None
    model = CollisionModel(plan.scene, arm)
    limits = arm.limits.motion.scaled(*[settings.move_share] * 3)
    stops = joint_waypoints(model, start_q, plan.above_start, settings, load=load, gripper_open=carries)
    start, goal = plan.joints[0], plan.joints[-1]
    leave = waypoints_home(model, start, goal, plan.above_goal, settings)
    closed, dynamics = not carries, Dynamics(arm)

    def move(name: str, a: Array, b: Array, *, before: bool) -> list[Segment]:
        if np.abs(b - a).max() < MIN_MOVE:
            return []
        return [Segment(name, before, closed, move_within_torques(a, b, limits, dynamics, arm, name))]

    on = plan.output.name if plan.output else ""

    def waits(end: Literal["start", "end"], *, before: bool) -> list[Segment]:
        seconds = getattr(plan.output, end) if plan.output else 0.0
        return [Segment(f"resting with {on} on", before, True, rest_time=seconds, output=on)] if seconds else []

    return [
        *[piece for a, b in pairwise(stops) for piece in move("on the approach", a, b, before=True)],
        *move("on the way down", plan.above_start, start, before=True),
        Segment("closing the gripper", True, True, rest_time=dwell if carries else 0.0),
        *waits("start", before=True),
        Segment("on the path", False, True, plan_trajectory(plan), is_path=True, output=on),
        *waits("end", before=False),
        Segment("opening the gripper", False, closed, rest_time=dwell if carries else 0.0),
        *move("on the way up", goal, plan.above_goal, before=False),
        *move("on the way home", *leave, before=False),
    ]


def plan_return_path(
    plan: Plan, segment: Segment, start_q: Array, goal_q: Array, settings: MotionSettings, arm: Arm
) -> list[TimedTrajectory]:
    """Plan a slow way from `start_q` (joints,) back to `goal_q` (joints,), where the arm was held in a segment.

    Raises:
        PathRefused: the way is not free, or the motors are too weak for it.
    """
    carried, model = plan.scene.carried, CollisionModel(plan.scene, arm)
    load = None
    if carried is not None and segment.gripper_closed:
        load = grasped_load(model, plan.joints[0])
    elif carried is not None and segment.before_path:
        load = Load(position=carried.position)
    elif carried is not None:
        load = placed_load(model, plan.joints[0], plan.joints[-1])
    opened = carried is not None and not segment.gripper_closed
    what = "on the way back to the path"
    stops = joint_waypoints(model, start_q, goal_q, settings, load=load, gripper_open=opened, move_name=what)
    limits = arm.limits.motion.scaled(*[settings.move_share] * 3)
    legs = [(a, b) for a, b in pairwise(stops) if np.abs(b - a).max() >= MIN_MOVE]
    grasp_pose = None if load is None else load.grasp_pose
    dynamics = Dynamics(arm, None if grasp_pose is None else carried, grasp_pose)
    return [move_within_torques(a, b, limits, dynamics, arm, what) for a, b in legs]
