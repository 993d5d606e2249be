"""Time-optimal path parameterization with a jerk limit, for a path whose parameter is nearly proportional to time.

The unknown is x(sigma) = (d sigma / dt)^2, a quadratic spline. Speed and acceleration limits are linear in x and its
derivatives, the jerk limit is q''' x + 3/2 q'' x' + 1/2 q' x'' <= J / sqrt(x) (Debrouwere et al., Time-optimal path
following for robots with convex-concave constraints using sequential convex programming, IEEE Transactions on Robotics
29(6), 2013). Each limit reads three neighbouring coefficients only, so the whole is solved by an interior-point method
with banded matrices (`interior_point`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import squared_rate_ceiling
from teachpath.motion.timing.interior_point import Derivatives, minimize
from teachpath.motion.timing.limit_margins import Margins

SAMPLE_POINTS: Final = np.array([0.02, 0.34, 0.66, 0.98])  # of an interval, at which the limits are imposed
STILL_SPEED_SHARE: Final = 1e-6  # of its speed limit; a joint that never uses more stands still
INITIAL_RATE_SHARE: Final = 0.5  # of the largest constant x, with which the search begins

Rows = tuple[NDArray[np.int64], Array, Array, Array]


def quadratic_basis(parameters: Array, intervals: int) -> Rows:
    """Evaluate the quadratic B-splines on even intervals of [0, 1] at parameters (n,).

    Returns:
        (n,) index of the first of three coefficients, and (n, 3) their weights in value, first and second derivative.
    """
    first = np.clip((parameters * intervals).astype(np.int64), 0, intervals - 1)
    t = parameters * intervals - first
    value = np.stack([(1 - t) ** 2 / 2, t * (1 - t) + 0.5, t**2 / 2], axis=1)
    slope = intervals * np.stack([t - 1, 1 - 2 * t, t], axis=1)
    curvature = intervals**2 * np.tile([1.0, -2.0, 1.0], (len(t), 1))
    return first, value, slope, curvature


def minimize_duration(path: JointPath, limits: MotionLimits, intervals: int, margins: Margins, *, arm: Arm) -> Array:
    """Return x(sigma) of the fastest motion from end to end, as coefficients (intervals + 2,) [1/s^2].

    Args:
        path: whose parameter is nearly proportional to time, with the third power of time at both ends.
        limits: of joints and tool, which are kept at samples; the caller measures what happens between them.
        intervals: of the spline.
        margins: shares of the limits that may be used.
        arm: that moves.
    """
    return minimize(_DurationProblem.of(path, limits, intervals, margins, arm))


@dataclass(frozen=True, eq=False)
class _DurationProblem:
    """Duration and limits at n samples, for the m joints that move (see `interior_point.SampledProblem`).

    The constraints of a sample are, in this order: speed; acceleration along and against each joint's direction of
    turning; jerk along and against it. Signs are chosen so that every joint turns forward.
    """

    intervals: int
    basis: Array  # (n, 3) weights of three coefficients in x
    quadrature_weights: Array  # (n,) of the samples in an integral over sigma
    ceiling: Array  # (n,) largest x within the speed limits
    accelerations: Array  # (n, m, 3) weights of the coefficients in acceleration over its limit
    jerks: Array  # (n, m, 3) the same in jerk over its limit and over sqrt(x)
    margins: Margins

    @staticmethod
    def of(path: JointPath, limits: MotionLimits, intervals: int, margins: Margins, arm: Arm) -> _DurationProblem:
        """Set up the problem of a joint path, for the joints that move on it."""
        places = ((np.arange(intervals)[:, None] + SAMPLE_POINTS) / intervals).ravel()
        one, two, three = (path(places, k)[:, :-1] for k in (1, 2, 3))
        tool_ceiling = squared_rate_ceiling(path(places)[:, :-1], one, margins.speed * limits.tool_speed, arm)
        moves = np.abs(one).max(axis=0) > STILL_SPEED_SHARE * limits.speed
        forward = np.where(one >= 0.0, 1.0, -1.0)
        one, two, three = ((forward * part)[:, moves] for part in (one, two, three))
        _, *rows = quadratic_basis(places, intervals)
        value, slope, curvature = (row[:, None] for row in rows)
        edges = np.concatenate([[0.0], (places[1:] + places[:-1]) / 2, [1.0]])
        speed, acceleration, jerk = limits.speed[moves], limits.acceleration[moves], limits.jerk[moves]
        a, b = ((part / acceleration)[:, :, None] for part in (one, two))
        i, j, k = ((part / jerk)[:, :, None] for part in (one, two, three))
        return _DurationProblem(
            intervals,
            rows[0],
            np.diff(edges),
            np.minimum(np.min((margins.speed * speed / np.maximum(one, 1e-12)) ** 2, axis=1), tool_ceiling),
            b * value + 0.5 * a * slope,
            k * value + 1.5 * j * slope + 0.5 * i * curvature,
            margins,
        )

    def initial_coefficients(self) -> Array:
        """Return the coefficients (intervals + 2,) of a constant x that keeps all limits."""
        ones = np.ones(3)
        a, j = np.abs(self.accelerations @ ones).max(), np.abs(self.jerks @ ones).max()
        least = min(*self.margins.against, *self.margins.against_at_speed)
        slowest = min(self.ceiling.min(), least / a, (least / j) ** (2 / 3))
        return np.full(self.intervals + 2, INITIAL_RATE_SHARE * slowest)

    @property
    def constraint_curvature(self) -> Array:
        """(1 + 4 m,) coefficient with which x^-1/2, the objective's integrand, enters each constraint."""
        m = self.jerks.shape[1]
        return np.repeat([0.0, self.margins.along[1], self.margins.against[1]], [1 + 2 * m, m, m])

    def constraint_values(self, coefficients: Array) -> tuple[float, Array] | None:
        """Return the duration [s] and the values (n, 1 + 4 m) of all constraints; None where x is not positive."""
        x = self._value(coefficients)
        if x.min() <= 0.0:
            return None
        a, j = ((part @ coefficients[:, :, None])[:, :, 0] for part in (self.accelerations, self.jerks))
        root, fast = x**-0.5, x / self.ceiling
        (along_a, along_j), (against_a, against_j) = self.margins.along, self.margins.against
        fall_a, fall_j = self.margins.against_decrease
        parts = [
            1.0 - fast[:, None],
            along_a - a,
            (against_a - fall_a * fast)[:, None] + a,
            along_j * root[:, None] - j,
            (root * (against_j - fall_j * fast))[:, None] + j,
        ]
        return float(self.quadrature_weights @ root), np.concatenate(parts, axis=1)

    def derivatives(self, coefficients: Array) -> Derivatives:
        """Return the derivatives of the objective by x, and of the constraint values by the coefficients."""
        x = self._value(coefficients)
        steep = 0.5 * x**-1.5
        (_, along_j), (_, against_j), (fall_a, fall_j) = (
            self.margins.along,
            self.margins.against,
            self.margins.against_decrease,
        )
        level, along, against = (
            share[:, None, None] * self.basis[:, None]
            for share in (1.0 / self.ceiling, along_j * steep, against_j * steep + fall_j * x * steep / self.ceiling)
        )
        a, j = self.accelerations, self.jerks
        slack = np.concatenate([-level, -a, a - fall_a * level, -along - j, j - against], axis=1)
        return Derivatives(-self.quadrature_weights * steep, 1.5 * steep / x, slack)

    def _value(self, near: Array) -> Array:
        return np.asarray(np.einsum("ij,ij->i", near, self.basis))
