"""A trajectory as a table of configurations at even instants, so fine that a Taylor step between them lies on the path.

A trajectory runs at full speed in plan time tau. The arm may run through it slower, forward or backward: at a constant
rate r = d tau / dt, the joints use r of their speed limits, r^2 of their acceleration limits and r^3 of their jerk
limits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import speed_bounds
from teachpath.motion.timing.jerk_limited_topp import quadratic_basis

MAX_TABLE_STEP: Final = 0.0005  # s, between two rows of a table
MAX_TABLE_ROWS: Final = 120_000  # of a longer trajectory, the rows are farther apart
SPEED_STRIDE: Final = 4  # rows from one to the next whose speed is computed
SUBINTERVALS: Final = 20  # of each interval of the squared rates, for the integration of time


@dataclass(frozen=True, eq=False)
class TimedTrajectory:
    """Joints and arc length as functions of plan time.

    Attributes:
        table: (n, 4, joints + 1) of the joints [rad] and the arc length [m]: value and three time derivatives.
        step: between two rows [s].
        limits: that the arm must keep on this trajectory.
    """

    table: Array
    step: float
    limits: MotionLimits

    @property
    def duration(self) -> float:
        """Time from end to end at full speed [s]."""
        return (len(self.table) - 1) * self.step

    def __call__(self, times: Array) -> Array:
        """Return joints and arc length (m, joints + 1) at plan times (m,) [s]; outside the plan, those of its ends."""
        ahead, value, first, second, third = self._rows_near(times)
        return np.asarray(value + ahead * (first + ahead / 2 * (second + ahead / 3 * third)), dtype=np.float64)

    def derivatives(self, times: Array) -> Array:
        """Return joints and arc length (m, 3, joints + 1) at plan times (m,) [s]: value and two derivatives."""
        ahead, _, first, second, third = self._rows_near(times)
        return np.stack([self(times), first + ahead * (second + ahead / 2 * third), second + ahead * third], axis=1)

    def _rows_near(self, times: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Return how far (m, 1) [s] times lie from the nearest rows, and what they hold (m, joints + 1)."""
        at = np.clip(times, 0.0, self.duration)
        row = np.rint(at / self.step).astype(np.int64)
        value, first, second, third = (self.table[row, k] for k in range(4))
        return (at - row * self.step)[:, None], value, first, second, third

    def setpoints(self, rate: float, *, phase: float = 0.0, override: float = 1.0) -> Array:
        """Return the setpoints (n, joints + 1) at a constant override, with some of the standstill before and after.

        Args:
            rate: setpoints a second [Hz].
            phase: of the first moving setpoint, as a share of a period.
            override: share of the full speed.
        """
        count = int(np.ceil(self.duration * rate / override))
        return self((np.arange(-3.0, count + 4) + phase) * (override / rate))

    def speed_bounds(self, arm: Arm) -> Array:
        """Return bounds (n, 4) [m/s] of the arm's speed at full speed of the trajectory (see `tool_speed`).

        They are of every `SPEED_STRIDE`-th row of the table and of the last one.
        """
        rows = np.concatenate([self.table[:-1:SPEED_STRIDE], self.table[-1:]])
        return speed_bounds(rows[:, :, :-1], SPEED_STRIDE * self.step, arm)


def time_joint_path(path: JointPath, squared_rates: Array, limits: MotionLimits) -> TimedTrajectory:
    """Return the trajectory along a path whose parameter sigma goes from 0 to 1 at (d sigma / dt)^2 = x(sigma).

    Args:
        path: of the joints, as a function of sigma.
        squared_rates: coefficients of x (see `jerk_limited_topp.quadratic_basis`) [1/s^2].
        limits: that the arm must keep.
    """
    intervals = len(squared_rates) - 2
    grid = np.linspace(0.0, 1.0, SUBINTERVALS * intervals + 1)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = 0.5 / (SUBINTERVALS * intervals)
    inner = ((grid[:-1] + half)[:, None] + half * nodes).ravel()
    pieces = half * ((1.0 / np.sqrt(_squared_rate_at(squared_rates, inner)[0])).reshape(-1, 4) @ weights)
    elapsed = np.concatenate([[0.0], np.cumsum(pieces)])
    clock = CubicHermiteSpline(grid, elapsed, 1.0 / np.sqrt(_squared_rate_at(squared_rates, grid)[0]))
    count = min(int(np.ceil(elapsed[-1] / MAX_TABLE_STEP)), MAX_TABLE_ROWS)
    instants = np.linspace(0.0, elapsed[-1], count + 1)
    sigma = np.interp(instants, elapsed, grid)
    for _ in range(3):
        sigma = np.clip(
            sigma - (clock(sigma) - instants) * np.sqrt(_squared_rate_at(squared_rates, sigma)[0]), 0.0, 1.0
        )
    x, slope, curvature = _squared_rate_at(squared_rates, sigma)
    one, two, three = np.sqrt(x), slope / 2, curvature * np.sqrt(x) / 2  # d sigma / dt and so on
    return TimedTrajectory(
        apply_chain_rule([path(sigma, k) for k in range(4)], one, two, three), float(elapsed[-1]) / count, limits
    )


def apply_chain_rule(values: list[Array], one: Array, two: Array, three: Array) -> Array:
    """Return a table (n, 4, joints + 1) of time derivatives by the chain rule.

    Args:
        values: (n, joints + 1) values and three derivatives with respect to a parameter.
        one: (n,) first time derivative of the parameter.
        two: (n,) second time derivative.
        three: (n,) third time derivative.
    """
    zeroth, first, second, third = values
    v, a, j = one[:, None], two[:, None], three[:, None]
    return np.stack(
        [zeroth, first * v, second * v**2 + first * a, third * v**3 + 3 * second * v * a + first * j], axis=1
    )


def _squared_rate_at(squared_rates: Array, sigma: Array) -> tuple[Array, Array, Array]:
    first, *shares = quadratic_basis(sigma, len(squared_rates) - 2)
    near = squared_rates[first[:, None] + np.arange(3)]
    x, slope, curvature = (np.einsum("ij,ij->i", near, share) for share in shares)
    return x, slope, curvature
