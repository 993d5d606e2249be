"""Slows a live hand's motions down until the joints keep their limits, and the arm the limit of its speed in space."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.execution.hand_kinematics import WRIST
from teachpath.motion.execution.tool_motion import ToolMotion

MIN_SHARE: Final = 0.05  # of the limits that is tried at least
MIN_SPEED: Final = 1e-3  # [rad/s] that is tried at least
MARGIN: Final = 0.97  # on what would just keep the limits
LEADING_SHARE: Final = 0.995  # of the limits that Ruckig may use, whose jerk changes within a period, too
TOOL_SPEED_SHARE: Final = 0.99  # of the limit of the speed in space that a motion may use
MAX_DURATION: Final = 0.5  # [s] of a motion: the arm finishes it when the clutch is let go
USUAL_DURATION: Final = 0.45  # [s] of the next trial after one that lasts longer
MIN_REACH: Final = 0.05  # of the way to the goal that is tried at least
RECOVERY: Final = 1.5  # factor on what is allowed, after a motion that kept all limits
REACH_RECOVERY: Final = 1.1  # the same for the reach
SLOW_SHARE: Final = 0.25  # below which it is said that the wrist slows the tool down


class Pace:
    """The limits of the joints before the wrist and of the tool's turn, so that what follows from them keeps its own.

    Args:
        limits: of the joints and of the speed in space.
        period: between two setpoints [s].

    Attributes:
        reach: share of the way to the goal that a motion goes, so that it is soon at rest.
    """

    def __init__(self, limits: MotionLimits, arm: Arm, period: float) -> None:
        self._limits = limits
        self._arm = arm
        self._period = period
        # The tool turns within the limits of the slowest joint of the wrist.
        self._widest = LEADING_SHARE * np.array(
            [[*row[:-WRIST], *[row[-WRIST:].min()] * WRIST] for row in (limits.speed, limits.acceleration, limits.jerk)]
        )
        self._speeds = self._widest[0]
        self._share = 1.0  # of speed, acceleration and jerk, for the wrist's sake
        self.reach: float = 1.0
        self._joint = ""  # that slows the tool

    @property
    def limits(self) -> Array:
        """Speed, acceleration and jerk (3, joints) that may be used now."""
        limits = self._share * self._widest
        limits[0] = np.minimum(limits[0], self._speeds)
        return limits

    @property
    def reason(self) -> str:
        """That the wrist slows the tool down, in words, while it slows it much; else empty."""
        return f"{self._joint} turns as fast as it may, so the tool is slow" if self._share < SLOW_SHARE else ""

    def keeps(self, motion: ToolMotion) -> bool:
        """Tell whether a motion keeps all limits at every moment, and is soon over; else adapt."""
        uses = motion.joints.limit_uses(self._limits)
        speeding = motion.joints.tool_speed_bound(self._arm) / (TOOL_SPEED_SHARE * self._limits.tool_speed)
        duration = len(motion) * self._period
        if uses.max() > 1.0:
            self._joint = self._arm.limits.names[int(np.argmax(uses))]
            self._share = max(MARGIN * self._share / float(uses.max()), MIN_SHARE)
        if speeding > 1.0:
            self._speeds = np.maximum(motion.leading_speeds * MARGIN / speeding, MIN_SPEED)
        if duration > MAX_DURATION:
            self.reach = max(self.reach * USUAL_DURATION / duration, MIN_REACH)
        return bool(uses.max() <= 1.0 and speeding <= 1.0 and duration <= MAX_DURATION)

    def recover(self) -> None:
        """Allow more again, after a motion that is followed."""
        self._share = min(RECOVERY * self._share, 1.0)
        self._speeds = np.minimum(RECOVERY * self._speeds, self._widest[0])
        self.reach = min(REACH_RECOVERY * self.reach, 1.0)
