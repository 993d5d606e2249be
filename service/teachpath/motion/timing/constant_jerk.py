"""Motions of the joints to rest whose jerk is constant in every control period.

Between two setpoints such a motion is one cubic, and it is the only one that meets their positions, velocities and
accelerations. So a player does what was checked here, between the setpoints, too, and on the way to rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import cubic_speed_bound

MIN_PERIODS: Final = 3  # of a motion: position, velocity and acceleration at its end take three jerks


@dataclass(frozen=True, eq=False)
class ConstantJerkMotion:
    """A motion to rest in n control periods.

    Attributes:
        states: (n + 1, 3, joints) position [rad], velocity and acceleration of the joints at the ends of the periods.
        jerks: (n, joints) in the periods [rad/s^3].
        period: [s].
    """

    states: Array
    jerks: Array
    period: float

    @classmethod
    def near(cls, begin: Array, accelerations: Array, goal: Array, period: float) -> ConstantJerkMotion:
        """Return the motion to rest whose jerks are nearest to the mean ones of a reference.

        Args:
            begin: (3, joints) position, velocity and acceleration.
            accelerations: (n + 1, joints) of the reference at the ends of the periods, n at least `MIN_PERIODS`.
            goal: (joints,) where it rests [rad].
        """
        count = len(accelerations) - 1
        scale = period ** np.arange(3.0)[:, None]
        place, speed, acceleration = begin * scale  # in units of the period
        left = np.arange(count - 1, -1, -1.0)  # periods after the one of a jerk
        effects = np.stack([left * (left + 1) / 2 + 1 / 6, left + 0.5, np.ones(count)], axis=1)  # (n, 3) at the end
        jerks = np.diff(accelerations, axis=0) * period**2
        free = np.array(
            [place + count * (speed + count / 2 * acceleration), speed + count * acceleration, acceleration]
        )
        missing = np.array([goal, *np.zeros((2, len(goal)))]) - free - effects.T @ jerks
        basis, triangle = np.linalg.qr(effects)
        jerks += basis @ np.linalg.solve(triangle.T, missing)  # the least change that ends at rest at the goal
        states = np.empty((count + 1, 3, len(goal)))
        states[:, 2] = _summed(acceleration, jerks)
        states[:, 1] = _summed(speed, states[:-1, 2] + jerks / 2)
        states[:, 0] = _summed(place, states[:-1, 1] + states[:-1, 2] / 2 + jerks / 6)
        states /= scale
        states[-1] = goal, *np.zeros((2, len(goal)))  # but for rounding, it is there
        return cls(states, jerks / period**3, period)

    def __len__(self) -> int:
        return len(self.jerks)

    def largest_speeds(self) -> Array:
        """Return the largest speed (joints,) of each joint at any moment [rad/s]."""
        speed, acceleration = self.states[:-1, 1], self.states[:-1, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            turning = -acceleration / self.jerks  # [s] in a period, when a speed has its extreme
            extreme = speed + acceleration * turning / 2
        inside = (turning > 0.0) & (turning < self.period)
        most = np.abs(self.states[:, 1]).max(axis=0)
        return np.asarray(np.maximum(most, np.abs(np.where(inside, extreme, 0.0)).max(axis=0)))

    def limit_uses(self, limits: MotionLimits) -> Array:
        """Return the largest share (joints,) of its limits of speed, acceleration and jerk that each joint uses."""
        speeds = self.largest_speeds() / limits.speed
        accelerations = np.abs(self.states[:, 2]).max(axis=0) / limits.acceleration  # linear in a period
        jerks = np.abs(self.jerks).max(axis=0) / limits.jerk
        return np.asarray(np.maximum.reduce([speeds, accelerations, jerks]))

    def turns(self) -> Array:
        """Return bounds (n, joints) of how far each joint turns in a period, to and fro [rad]."""
        # The coefficients of a speed in the Bernstein basis, whose functions have the same integral.
        speed, acceleration = self.states[:-1, 1], self.states[:-1, 2]
        middle = speed + self.period / 2 * acceleration
        return self.period / 3 * (np.abs(speed) + np.abs(middle) + np.abs(self.states[1:, 1]))

    def hull(self) -> Array:
        """Return configurations (m, joints) in whose range the joints stay: coefficients of the cubics by Bernstein."""
        third = self.period / 3
        ahead = self.states[:-1, 0] + third * self.states[:-1, 1]
        behind = self.states[1:, 0] - third * self.states[1:, 1]
        return np.concatenate([self.states[:, 0], ahead, behind])

    def tool_speed_bound(self, arm: Arm) -> float:
        """Return an upper bound of the speed in space of elbow, wrist and tool centre point, ever [m/s]."""
        return cubic_speed_bound(self.states, np.abs(self.jerks), self.period, arm)


def _summed(first: Array, steps: Array) -> Array:
    return np.concatenate([first[None], first + np.cumsum(steps, axis=0)])
