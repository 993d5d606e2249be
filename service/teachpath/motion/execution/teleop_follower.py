"""Follows a hand with the tool: scaled, within the joints' limits, on one IK branch, and clear of the scene.

The arm always follows one of Ruckig's motions, from its present state to rest, that was checked to its end against the
joints' ranges and the scene. The next motion is planned for an instant ahead and replaces the present one only if its
check is done by then. So an arm that loses the hand, or whose planning fails, comes to rest where it is safe. Planning
is cut into slices of a millisecond or two; the control loop does one after each setpoint.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import BRANCH_NAMES, inverse_kinematics, min_singular_value, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.execution.teleop_motion import Motion, MotionToRest, sampled, state_at
from teachpath.motion.settings import MotionSettings

LEAD_PERIODS: Final = 6  # control periods from the beginning of planning to the beginning of the motion
CHECKS_PER_SLICE: Final = 3  # configurations that are checked in one slice of planning
MAX_JOINT_LEAD: Final = 0.25  # [rad] of one motion: more could not be checked in time
POSES_PER_SOLVE: Final = 8  # poses on the way to the target for which inverse kinematics are solved at once
MAX_TOOL_LEAD: Final = 0.2  # [m] of one motion
MIN_SHARE: Final = 0.02  # of the way to the target that is tried at least
MAX_JOINT_JUMP: Final = 0.6  # [rad] between two neighbouring poses; a larger turn would be another motion of the arm
SAMPLING_CLEARANCE: Final = 0.015  # [m] besides `clearance_min`, for what lies between two checked configurations
BACKOFF_FACTOR: Final = 0.5  # on the share of the way that is tried, after something was too near
MIN_MOVE: Final = 1e-4  # [rad] below which there is nothing to move
REST_SPEED: Final = 1e-9  # [rad/s]


@dataclass(frozen=True, eq=False)
class _PlannedMotion:
    """A checked motion that begins in the control period `cycle`; `stamp` names the sample that it answers."""

    cycle: int
    trajectory: Motion
    stamp: int


class TeleopFollower:
    """Leads the tool where a hand leads it.

    Args:
        model: of the scene.
        start_q: (6,) where the arm rests [rad]; the tool keeps the orientation that it has there.
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
        self._motion_to_rest = MotionToRest(limits, model.arm, period)
        pose = tool_pose(start_q, model.arm)
        self._orientation = pose[:3, :3]
        self._branch = _branch(start_q, pose, model.arm)
        self._state: tuple[Array, Array, Array] = (np.array(start_q, dtype=np.float64), np.zeros(6), np.zeros(6))
        self._trajectory: Motion | None = None
        self._positions = np.empty((0, 6))  # of the trajectory, one period apart [rad]
        self._elapsed = 0.0  # [s] of the present motion
        self._cycle = 0
        self._planned: _PlannedMotion | None = None
        self._planning: Iterator[None] | None = None
        self._anchor: tuple[Array, Array] | None = None  # positions of hand and tool when following began [m]
        self._target: Array | None = None  # where the tool should be [m]
        self._target_stamp = 0
        self._share = 1.0  # of the way to the target that is tried
        self.load: Load | None = None
        self.reason = ""
        self.answered_stamp = 0
        if self._model.clearances(start_q[None])[0].distance < settings.clearance_min:
            raise PathRefused("the arm stands too near to something; bring it nearer to its home first")

    @property
    def state(self) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration (6,) of the newest setpoint."""
        return self._state

    @property
    def at_rest(self) -> bool:
        """Whether the arm's nominal motion is at rest."""
        return bool(np.all(np.abs(self._state[1]) < REST_SPEED)) and self._trajectory is None

    def engage(self, hand: Array) -> None:
        """Begin to follow: the tool moves from where it is as the hand moves from `hand` (3,) [m, world]."""
        goal = self._end()
        self._anchor = (np.array(hand), tool_pose(goal, self._model.arm)[:3, 3])

    def disengage(self) -> None:
        """Cease to follow: the arm finishes its present motion, and rests."""
        self._anchor = self._target = self._planning = self._planned = None
        self.reason = ""

    def set_hand(self, hand: Array, stamp: int) -> None:
        """Take where the hand is now (3,) [m, world], if it is followed; `stamp` names the sample."""
        if self._anchor is not None:
            began, tool = self._anchor
            self._target, self._target_stamp = tool + self._scale * (hand - began), stamp

    def step(self) -> tuple[Array, Array, Array]:
        """Advance by one control period and return the newest setpoint's position, velocity and acceleration."""
        self._cycle += 1
        following = self._planned
        if following is not None and following.cycle <= self._cycle:
            if following.cycle == self._cycle:
                self._trajectory, self._elapsed, self.answered_stamp = following.trajectory, 0.0, following.stamp
            self._planned = None
        self._elapsed += self._period
        if self._trajectory is not None and self._elapsed == self._period:
            count = int(np.ceil(self._trajectory.duration / self._period))
            self._positions = np.array([state_at(self._trajectory, (k + 1) * self._period)[0] for k in range(count)])
        if self._trajectory is not None:
            self._state = state_at(self._trajectory, self._elapsed)
            if self._elapsed >= self._trajectory.duration:
                self._state, self._trajectory = (self._state[0], np.zeros(6), np.zeros(6)), None
        return self._state

    def way_to_rest(self) -> Array:
        """Return the positions (n, 6) that are left of the motion that is followed; it ends at rest [rad]."""
        return self._positions[round(self._elapsed / self._period) :] if self._trajectory else np.empty((0, 6))

    def rest_at(self, position: Array) -> None:
        """Stand at a configuration (6,) at once; only for an arm that rests there already."""
        self._state = (position, np.zeros(6), np.zeros(6))
        self._trajectory = self._planned = self._planning = None

    def advance_planning(self) -> None:
        """Do one slice of the planning of the next motion; takes a millisecond or two."""
        if self._planning is None:
            if self._target is None or self._planned is not None:
                return
            self._planning = self._plan(self._target, self._target_stamp)
        if next(self._planning, self) is self:
            self._planning = None

    def _plan(self, target: Array, stamp: int) -> Iterator[None]:
        begins = self._cycle + LEAD_PERIODS
        state = self._after(LEAD_PERIODS - 1)
        goal, reason = self._reachable_goal(target, state[0])
        yield
        if self.at_rest and np.abs(goal - state[0]).max() < MIN_MOVE:
            self.reason = reason
            return
        run = self._motion_to_rest(state, goal)
        if run is None:
            return
        samples = sampled(run)
        for first in range(0, len(samples), CHECKS_PER_SLICE):
            near = self._find_obstruction(samples[first : first + CHECKS_PER_SLICE])
            if near:
                self.reason, self._share = near, max(BACKOFF_FACTOR * self._share, MIN_SHARE)
                return
            yield
        if self._cycle < begins and self._anchor is not None:
            self.reason, self._share = reason, min(1.5 * self._share, 1.0)
            self._planned = _PlannedMotion(begins, run, stamp)

    def _reachable_goal(self, target: Array, here: Array) -> tuple[Array, str]:
        """Return the configuration nearest to the target that is reached from `here` (6,), and what is in the way."""
        arm = self._model.arm
        begin = tool_pose(here, arm)[:3, 3]
        lead = min(1.0, MAX_TOOL_LEAD / max(float(np.linalg.norm(target - begin)), 1e-12))
        shares = lead * self._share * np.arange(1, POSES_PER_SOLVE + 1) / POSES_PER_SOLVE
        poses = np.tile(np.eye(4), (POSES_PER_SOLVE, 1, 1))
        poses[:, :3, :3] = self._orientation
        poses[:, :3, 3] = begin + shares[:, None] * (target - begin)
        solved = inverse_kinematics(poses, arm, previous_q4=float(here[3]))
        joints = np.unwrap(np.concatenate([here[None], solved.joints[:, self._branch]]), axis=0)
        turns = np.abs(np.diff(joints, axis=0)).max(axis=1)
        joints = joints[1:]
        low, high = joints - arm.limits.lower, arm.limits.upper - joints
        checks = (
            (solved.reach_excess[:, self._branch] > 0, "the arm does not reach that far"),
            (np.minimum(low, high).min(axis=1) < 0, "a joint is at its limit"),
            (
                min_singular_value(joints, arm) < self._settings.least_singular,
                "the arm is stretched out: a singular pose",
            ),
            (turns > MAX_JOINT_JUMP, "the arm would have to turn over"),
        )
        good, reason = POSES_PER_SOLVE, ""
        for bad, sentence in checks:
            if bad.any() and int(np.argmax(bad)) < good:
                good, reason = int(np.argmax(bad)), f"{sentence}; move the hand back"
        near = int(
            np.searchsorted(np.maximum.accumulate(np.abs(joints[:good] - here).max(axis=1)), MAX_JOINT_LEAD, "right")
        )
        if good == 0:
            self._share = max(BACKOFF_FACTOR * self._share, MIN_SHARE)
            return here, reason
        goal = joints[max(near, 1) - 1]
        turn = float(np.abs(goal - here).max())
        return here + (goal - here) * min(1.0, MAX_JOINT_LEAD / max(turn, 1e-12)), reason if near >= good else ""

    def _find_obstruction(self, samples: Array) -> str:
        limits = self._model.arm.limits
        if np.any(samples < limits.lower) or np.any(samples > limits.upper):
            return "a joint would pass its limit; move the hand back"
        rows = self._model.clearances(samples, load=self.load, gripper_open=True)  # the wider of both
        least = min(rows, key=lambda row: row.distance)
        if least.distance < self._settings.clearance_min + SAMPLING_CLEARANCE:
            near = f"{least.body} would come within {1000 * least.distance:.0f} mm of {least.other_body}"
            return f"{near}; move the hand back"
        if self.load is not None and self.load.grasp_pose is not None:
            deep = min(row.distance for row in self._model.support_distances(samples, self.load))
            if deep < -self._settings.contact_tolerance:
                return f"the object would be pressed {-1000 * deep:.0f} mm into what it stood on; move the hand back"
        return ""

    def _after(self, cycles: int) -> tuple[Array, Array, Array]:
        """Return the state `cycles` control periods ahead."""
        if self._trajectory is None:
            return self._state
        t = self._elapsed + cycles * self._period
        return (
            state_at(self._trajectory, t)
            if t < self._trajectory.duration
            else (state_at(self._trajectory, t)[0], np.zeros(6), np.zeros(6))
        )

    def _end(self) -> Array:
        """Return the configuration (6,) in which the present motion ends."""
        return self._state[0] if self._trajectory is None else state_at(self._trajectory, self._trajectory.duration)[0]


def _branch(here: Array, pose: Array, arm: Arm) -> int:
    solved = inverse_kinematics(pose[None], arm, previous_q4=float(here[3])).joints[0]
    off = np.abs(np.angle(np.exp(1j * (solved - here)))).max(axis=1)
    if off.min() > 1e-3:
        raise PathRefused(
            f"the arm stands on none of its {len(BRANCH_NAMES)} branches; bring it nearer to its home first"
        )
    return int(np.argmin(off))
