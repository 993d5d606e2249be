"""Follows a hand with the tool: scaled, within the joints' limits, on one IK branch, and clear of the scene.

The arm always follows a motion of `tool_motion`, from its present state to rest, that was checked to its end against
the joints' limits and the scene. The next motion is planned for an instant ahead and replaces the present one only if
its check is done by then. So an arm that loses the hand, or whose planning fails, comes to rest where it is safe.
Planning is cut into slices of a millisecond or two; the control loop does one after each setpoint.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.execution.hand_kinematics import WRIST, HandKinematics
from teachpath.motion.execution.teleop_checks import MotionCheck, SweptCheck, TorqueCheck, limit_passed
from teachpath.motion.execution.teleop_goal import (
    MIN_TURN,
    ReachableGoal,
    nearest_reachable,
)
from teachpath.motion.execution.teleop_pace import Pace
from teachpath.motion.execution.tool_motion import ToolMotion, ToolState, plan_tool_motion
from teachpath.motion.execution.tried_shares import TriedShares
from teachpath.motion.settings import MotionSettings

LEAD_PERIODS: Final = 5  # control periods from the beginning of planning to the beginning of the motion
CHECKS_PER_SLICE: Final = 10  # configurations that are checked in one slice of planning
MAX_TOOL_LEAD: Final = 0.2  # [m] of one motion
MAX_TURN_LEAD: Final = 0.3  # [rad] of the tool in one motion
TRIALS_PER_PLAN: Final = 3  # of a motion, each slower than the one before
STEPS_ARE_CHECKED: Final = "every step is checked first and the tool is slow"
MIN_MOVE: Final = 1e-4  # [rad] below which there is nothing to move
REST_SPEED: Final = 1e-9  # [rad/s]


@dataclass(frozen=True, eq=False)
class _PlannedMotion:
    """A checked motion that begins in the control period `cycle`; `stamp` names the sample that it answers."""

    cycle: int
    motion: ToolMotion
    stamp: int


@dataclass(frozen=True, eq=False)
class _Pose:
    """Position (3,) [m] and orientation (3, 3) of hand or tool, in the world."""

    position: Array
    orientation: Array


class TeleopFollower:
    """Leads the tool where a hand leads it.

    Args:
        model: of the scene.
        start_q: (joints,) where the arm rests [rad].
        settings: home, clearances and singularities.
        scale: of the tool's way over the hand's.
        share: of the joints' speed, acceleration and jerk limits.
        period: between two setpoints [s].

    Raises:
        PathRefused: the arm cannot follow from where it stands: it is on no branch, or too near to something.

    Attributes:
        load: what is carried or stands in the way; None when there is no object.
        reason: why the tool is not where the hand leads it, in words.
        answered_stamp: stamp of the newest sample that the setpoints answer.
    """

    def __init__(
        self,
        model: CollisionModel,
        start_q: Array,
        settings: MotionSettings,
        *,
        scale: float = 1.0,
        share: float = 0.5,
        period: float = 0.004,
    ) -> None:
        self._model = model
        self._settings = settings
        self._scale = scale
        self._period = period
        limits = model.arm.limits.motion.scaled(share, share, share)
        self._pace = Pace(limits, model.arm, period)
        self._torque_check = TorqueCheck(model)
        pose = tool_pose(start_q, model.arm)
        self._kinematics = HandKinematics.at(start_q, model.arm, settings.least_singular)
        self._orientation = pose[:3, :3]  # (3, 3) of the tool where it rests, or where the present motion ends
        self._state: tuple[Array, Array, Array] = (np.array(start_q, dtype=np.float64), *np.zeros((2, len(start_q))))
        self._motion: ToolMotion | None = None
        self._sample = -1  # of the present motion; -1 before its first
        self._cycle = 0
        self._planned: _PlannedMotion | None = None
        self._planning: Iterator[None] | None = None
        self._anchor: tuple[Array, _Pose] | None = None  # the hand's position [m], and the tool, when following began
        self._hand_orientation: Array | None = None  # (3, 3) when its turns began to be followed
        self._target: _Pose | None = None  # where the tool should be
        self._target_stamp = 0
        self._shares = TriedShares()
        self.load: Load | None = None
        self.reason: str = ""
        self.answered_stamp: int = 0
        if self._model.clearances(start_q[None])[0].distance < settings.clearance_min:
            raise PathRefused("the arm stands too near to something; bring it nearer to its home first")

    @property
    def state(self) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (joints,) of the newest setpoint."""
        return self._state

    @property
    def at_rest(self) -> bool:
        """Whether the arm's nominal motion is at rest."""
        return bool(np.all(np.abs(self._state[1]) < REST_SPEED)) and self._motion is None

    def engage(self, hand: Array, orientation: Array | None = None) -> None:
        """Begin to follow: the tool moves from where it is as the hand moves from where it is now.

        Args:
            hand: (3,) position [m, world].
            orientation: (3, 3) of the hand; None when the tool is not to turn.
        """
        place = self._state[0] if self._motion is None else self._motion.positions[-1]
        tool = _Pose(tool_pose(place, self._model.arm)[:3, 3], self._orientation)
        self._anchor, self._hand_orientation = (np.array(hand), tool), orientation

    def disengage(self) -> None:
        """Cease to follow: the arm finishes its present motion, and rests."""
        self._anchor = None
        self.pause()

    def pause(self) -> None:
        """Finish the present motion and rest, until the hand is set again: the tool then goes on as it followed."""
        self._target = self._planning = self._planned = None
        self.reason = ""

    def set_hand(self, hand: Array, stamp: int, orientation: Array | None = None) -> None:
        """Take where the hand is now, if it is followed.

        Args:
            hand: (3,) position [m, world].
            stamp: names the sample.
            orientation: (3, 3) of the hand, by which the tool turns; None when it is not to turn.
        """
        if self._anchor is None:
            return
        began, tool = self._anchor
        turned = tool.orientation if self._target is None else self._target.orientation
        if self._hand_orientation is None:
            self._hand_orientation = orientation
        elif orientation is not None:
            turned = orientation @ self._hand_orientation.T @ tool.orientation
        self._target = _Pose(tool.position + self._scale * (hand - began), turned)
        self._target_stamp = stamp

    def step(self) -> tuple[Array, Array, Array]:
        """Advance by one control period and return the newest setpoint's position, velocity and acceleration."""
        self._cycle += 1
        following = self._planned
        if following is not None and following.cycle <= self._cycle:
            if following.cycle == self._cycle:
                self._motion, self._sample, self.answered_stamp = following.motion, -1, following.stamp
                self._orientation = following.motion.final_orientation
            self._planned = None
        if self._motion is not None:
            self._sample += 1
            run, k = self._motion, self._sample
            position, velocity, acceleration = run.states[k]
            self._state = (position, velocity, acceleration)
            if k == len(run) - 1:
                self._motion = None
        return self._state

    def way_to_rest(self) -> Array:
        """Return the states (n, 3, joints) that are left of the motion that is followed; it ends at rest."""
        return self._motion.states[self._sample + 1 :] if self._motion else np.empty((0, 3, len(self._state[0])))

    def rest_at(self, position: Array) -> None:
        """Stand at a configuration (joints,) at once; only for an arm that rests there already."""
        self._state = (position, *np.zeros((2, len(position))))
        self._orientation = tool_pose(position, self._model.arm)[:3, :3]
        self._motion = self._planned = self._planning = None

    def advance_planning(self) -> None:
        """Do one slice of the planning of the next motion; takes a millisecond or two."""
        if self._planning is None:
            if self._target is None or self._planned is not None:
                return
            self._planning = self._plan(self._target, self._target_stamp)
        if next(self._planning, self) is self:
            self._planning = None

    def _plan(self, target: _Pose, stamp: int) -> Iterator[None]:
        begins, begin = self._cycle + LEAD_PERIODS, self._state_after(LEAD_PERIODS - 1)
        arm, here = self._model.arm, begin.joints[0]
        pose = tool_pose(here, arm)
        pose[:3, :3] = begin.orientation
        wanted = _turn(begin.orientation, target.orientation)
        goal = nearest_reachable(
            here,
            pose,
            self._shares.way * _capped(target.position - pose[:3, 3], MAX_TOOL_LEAD),
            self._shares.turn * _capped(wanted, MAX_TURN_LEAD),
            self._kinematics,
            self._settings.least_singular,
        )
        yield
        if not goal.moves:
            self._shares.shorten("")
        if self.at_rest and np.abs(goal.joints - here).max() < MIN_MOVE:
            self.reason = goal.reason or self._shares.reason
            self._shares.grow()  # what is too small to move may be a small share of what is not
            return
        for _ in range(TRIALS_PER_PLAN):
            motion = self._motion_to(begin, goal)
            if motion is None:
                return
            if self._pace.keeps(motion):
                break
            yield
        else:
            return
        swept_check = SweptCheck(motion.joints, self._model, self.load, self._settings)
        check = MotionCheck(motion.joints, self._torque_check, swept_check)
        near = limit_passed(motion.joints.hull(), arm)
        while not (near or check.is_done) and self._cycle < begins - 1:
            yield
            near = check.advance(CHECKS_PER_SLICE)
        if near:
            self._shares.back_off(near, turns=bool(np.any(goal.turn)))
            self.reason = self._shares.reason
        elif not check.is_done:  # near to something much has to be measured: a shorter motion takes less
            self._shares.shorten(", so ".join(filter(None, (check.nearest, STEPS_ARE_CHECKED))))
            self.reason = self._shares.reason
        elif self._anchor is not None:
            self._take_up(_PlannedMotion(begins, motion, stamp), self._hindrance(goal, wanted))

    def _motion_to(self, begin: ToolState, goal: ReachableGoal) -> ToolMotion | None:
        limits, reach, here = self._pace.limits, self._pace.reach, begin.joints[0, :-WRIST]
        joints = here + reach * (goal.joints[:-WRIST] - here)
        return plan_tool_motion(begin, joints, reach * goal.turn, limits, self._kinematics, period=self._period)

    def _hindrance(self, goal: ReachableGoal, wanted: Array) -> str:
        """Say why the tool will not be where the hand is although a motion passed its checks; else nothing."""
        if goal.reason:
            return goal.reason
        if self._shares.reason and (self._shares.way < 1.0 or np.linalg.norm(wanted) > MIN_TURN):
            return self._shares.reason
        return self._pace.reason

    def _take_up(self, planned: _PlannedMotion, reason: str) -> None:
        self._planned, self.reason = planned, reason
        self._shares.grow()
        self._pace.recover()

    def _state_after(self, cycles: int) -> ToolState:
        """Return the state `cycles` control periods ahead."""
        if self._motion is None:
            return ToolState.resting(self._state[0], self._orientation)
        return self._motion.tool_state(self._sample + cycles)


def _turn(orientation: Array, target: Array) -> Array:
    """Return the rotation vector (3,) between two orientations (3, 3), in axes of the world [rad]."""
    return np.asarray(Rotation.from_matrix(target @ orientation.T).as_rotvec(), dtype=np.float64)


def _capped(vector: Array, limit: float) -> Array:
    return np.asarray(vector * min(1.0, limit / max(float(np.linalg.norm(vector)), 1e-12)), dtype=np.float64)
