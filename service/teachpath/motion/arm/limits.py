"""Limits of the joints: position, torque, and the limits of motion (speed, acceleration, jerk)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array, Link
from teachpath.records import SerialArm

# Nobody publishes a jerk limit: by our convention the full acceleration is built up in a tenth of a second.
JERK_PER_ACCELERATION: Final = 10.0  # 1/s


@dataclass(frozen=True, eq=False)
class MotionLimits:
    """Largest speed [rad/s], acceleration [rad/s^2] and jerk [rad/s^3] of the joints: (joints,) each; and of the tool.

    Attributes:
        tool_speed: of elbow, wrist and tool centre point (`tool_speed`) [m/s]; infinite where none is set.
    """

    speed: Array
    acceleration: Array
    jerk: Array
    tool_speed: float = inf

    def scaled(self, speed: float, acceleration: float, jerk: float) -> MotionLimits:
        """Return the limits of the joints times one factor each, and that of the tool as it is."""
        return replace(
            self, speed=speed * self.speed, acceleration=acceleration * self.acceleration, jerk=jerk * self.jerk
        )


@dataclass(frozen=True, eq=False)
class JointLimits:
    """What the joints of an arm may do: (joints,) each, read-only.

    Attributes:
        names: of the joints, as sentences call them.
        lower: least angle [rad], with the zero position of Paul.
        upper: largest angle [rad].
        speed: [rad/s].
        acceleration: [rad/s^2].
        jerk: [rad/s^3].
        torque: of the motor, at the joint [N m].
        tool_speed: of elbow, wrist and tool centre point [m/s]; infinite where none is set.
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    speed: Array
    acceleration: Array
    jerk: Array
    torque: Array
    tool_speed: float = inf

    @classmethod
    def of_links(cls, links: Sequence[Link], tool_speed: float | None = None) -> JointLimits:
        """Read the limits of the joints from the rows of a table."""

        def column(name: str, factor: float = 1.0) -> Array:
            values = factor * np.array([getattr(link, name) for link in links], dtype=np.float64)
            values.flags.writeable = False
            return values

        return cls(
            names=tuple(f"joint {number}" for number in range(1, len(links) + 1)),
            lower=column("lower"),
            upper=column("upper"),
            speed=column("speed"),
            acceleration=column("acceleration"),
            jerk=column("acceleration", JERK_PER_ACCELERATION),
            torque=column("torque"),
            tool_speed=inf if tool_speed is None else tool_speed,
        )

    @classmethod
    def of_model(cls, model: SerialArm, tool_speed: float | None = None) -> JointLimits:
        """Read the limits of the joints from a user's model."""

        def column(name: str) -> Array:
            values = np.array([getattr(joint, name).value for joint in model.joints])
            values.flags.writeable = False
            return values

        return cls(
            names=tuple(joint.name for joint in model.joints),
            lower=column("lower"),
            upper=column("upper"),
            speed=column("speed"),
            acceleration=column("acceleration"),
            jerk=column("jerk"),
            torque=column("torque"),
            tool_speed=inf if tool_speed is None else tool_speed,
        )

    @property
    def motion(self) -> MotionLimits:
        """The limits of speed, acceleration and jerk."""
        return MotionLimits(self.speed, self.acceleration, self.jerk, self.tool_speed)
