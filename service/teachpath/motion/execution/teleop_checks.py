"""What stands in the way of a motion that a live hand asks for: the joints' ranges, the motors, and what is near."""

from __future__ import annotations

from collections import deque
from typing import Final

import numpy as np

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, Load
from teachpath.motion.execution.teleop_goal import describe_limit
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.constant_jerk import ConstantJerkMotion

ROUNDING: Final = 1e-9  # [rad]
TORQUE_STRIDES: Final = (5, 1)  # control periods between two torques; the first bound is quick, the second close
FIRST_STEP: Final = 0.06  # [m] that any point may move before the second configuration that is measured
SAMPLING_CLEARANCE: Final = 0.015  # [m] besides `clearance_min`, so that few configurations prove what lies between


def limit_passed(positions: Array, arm: Arm) -> str:
    """Say which joint would pass its range in configurations (n, 6), or nothing."""
    beyond = np.maximum(positions - arm.limits.upper, arm.limits.lower - positions)
    if beyond.max() <= ROUNDING:
        return ""
    row, joint = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
    return describe_limit(int(joint), float(positions[row, joint]), arm)


class TorqueCheck:
    """Proves that the motors move the arm at every moment of a motion, whether or not it holds the scene's object.

    Torques are linear in the mass that is held. So what keeps the limits with the object and without it keeps them when
    it is taken or let go on the way, too.
    """

    def __init__(self, model: CollisionModel) -> None:
        held = (None, model.scene.carried) if model.scene.carried else (None,)
        self._dynamics = [Dynamics(model.arm, each) for each in held]
        self._torque = model.arm.limits.torque
        self._names = model.arm.limits.names

    def __call__(self, motion: ConstantJerkMotion, stride: int) -> str:
        """Say which motor may be too weak at some moment of a motion, by one of `TORQUE_STRIDES`, or nothing."""
        for dynamics in self._dynamics:
            bounds = dynamics.motion_bounds(motion.states, motion.turns(), motion.period, stride)
            uses = (bounds / self._torque).max(axis=0)
            if uses.max() > 1.0:
                joint = self._names[int(np.argmax(uses))]
                return f"the motor of {joint} is too weak there for the arm and what it carries"
        return ""


class MotionCheck:
    """Proves a motion for the motors and clear of the scene, in slices of about a millisecond.

    Args:
        motion: to be proved.
        torque_check: of the scene.
        swept_check: of the motion.
    """

    def __init__(self, motion: ConstantJerkMotion, torque_check: TorqueCheck, swept_check: SweptCheck) -> None:
        self._motion, self._torque_check, self._swept_check = motion, torque_check, swept_check
        self._strides = deque(TORQUE_STRIDES)  # by which the motors are still to be proved

    @property
    def is_done(self) -> bool:
        """Whether the whole motion is proved."""
        return self._swept_check.is_done and not self._strides

    @property
    def nearest(self) -> str:
        """What is nearest where the motion was measured last, in words; empty where nothing is near."""
        return self._swept_check.nearest

    def advance(self, count: int) -> str:
        """Do a slice, in which at most `count` configurations are measured; say what stands in the way, or nothing."""
        if self._strides:
            weak = self._torque_check(self._motion, self._strides.popleft())
            if not self._strides:  # the close bound takes a slice of its own
                return weak
            if not weak:
                self._strides.clear()
        return "" if self._swept_check.is_done else self._swept_check.advance(count)


class SweptCheck:
    """Proves that arm, gripper and load keep clear of the scene on a whole motion, some configurations at a time.

    No point moves farther than the joints turn times their lever arms (`collision/continuous.py`). So from a
    configuration whose distance is known, the motion is proved as far as distance and guard reach, where the distance
    is measured anew. So is how deep a held object dips into what it stood on, which it may touch.

    Attributes:
        is_done: whether the whole motion is proved.
    """

    def __init__(
        self, motion: ConstantJerkMotion, model: CollisionModel, load: Load | None, settings: MotionSettings
    ) -> None:
        self._positions = motion.states[:, 0]
        self._moved = np.concatenate([[0.0], np.cumsum(motion.turns() @ model.lever_arms(load))])  # [m] of any point
        self._model, self._load, self._settings = model, load, settings
        self._required = settings.clearance_min + SAMPLING_CLEARANCE  # [m] where it is measured
        self._reached = -1  # setpoint up to which the motion is proved
        self._step = FIRST_STEP  # [m] that any point may move before it is measured again
        self._distance = 0.0  # [m] at the setpoint that was reached
        self._height = np.inf  # [m] of a held object over what it stood on, there
        self._nearest: Clearance | None = None
        self.is_done: bool = False

    @property
    def nearest(self) -> str:
        """What is nearest where the motion was measured last, in words; empty where nothing is near."""
        near = self._nearest
        if near is None or self._height < near.distance:
            return "the object is near to what it stood on" if near else ""
        return f"{near.body} is near to {near.other_body}" if near.body else ""

    def advance(self, count: int) -> str:
        """Measure `count` configurations; say what the arm would come too near to, or nothing."""
        rows = self._rows(count)
        clear = self._model.clearances(self._positions[rows], load=self._load, gripper_open=True)  # the wider of both
        supports = self._support_distances(rows)
        if self._reached < 0:  # an arm that is nearer than the guard may move, but no nearer
            self._reached, self._distance, self._height = 0, clear[0].distance, supports[0]
            self._required = min(self._required, self._distance)
        for row, near, height in zip(rows, clear, supports, strict=True):
            self._nearest = near
            way = float(self._moved[row] - self._moved[self._reached])
            between, lowest = (self._distance + near.distance - way) / 2, (self._height + height - way) / 2
            is_clear = between >= self._settings.clearance_min
            is_above = lowest >= -self._settings.contact_tolerance
            is_next = row <= self._reached + 1  # no setpoint lies between, where more could be measured
            if near.distance < self._required or (is_next and not is_clear):
                mm = 1000 * min(near.distance, between)
                return f"{near.body} would come within {mm:.0f} mm of {near.other_body}"
            if min(height, lowest if is_next else height) < -self._settings.contact_tolerance:
                return f"the object would be pressed {-1000 * min(height, lowest):.0f} mm into what it stood on"
            if not (is_clear and is_above):  # it comes nearer here: what follows is measured at shorter steps
                return ""
            self._reached, self._distance, self._height = row, near.distance, height
            free = self._distance + self._required - 2 * self._settings.clearance_min
            self._step = min(free, height + self._settings.contact_tolerance)
        self.is_done = self._reached == len(self._positions) - 1
        return ""

    def _rows(self, count: int) -> list[int]:
        """Return the setpoints (at most `count`) at which to measure next, if the distance stays as it is."""
        last = max(self._reached, 0)
        rows = [0] if self._reached < 0 else []
        while len(rows) < count and last < len(self._positions) - 1:
            ahead = int(np.searchsorted(self._moved, self._moved[last] + self._step, side="right")) - 1
            last = max(ahead, last + 1)
            rows.append(last)
        return rows

    def _support_distances(self, rows: list[int]) -> list[float]:
        if self._load is None or self._load.grasp_pose is None:
            return [np.inf] * len(rows)
        found = self._model.support_distances(self._positions[rows], self._load)
        return [row.distance for row in found]
