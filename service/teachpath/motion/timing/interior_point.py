"""A primal-dual interior-point method for sums over samples, each a function of three neighbouring coefficients.

The objective is convex. Where the curvature of a constraint would make the Hessian indefinite, it is left out, as if
the constraint were linearised in every step. A line search on the barrier function keeps every step feasible. Nocedal &
Wright, Numerical Optimization, 2nd ed., Springer 2006, chapter 19.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from teachpath.motion.arm.puma560 import Array

MAX_ITERATIONS: Final = 60
CENTERING: Final = 0.15  # share of the present duality gap that each step aims at
RELATIVE_GAP: Final = 5e-4  # duality gap over the objective at which a problem counts as solved
BOUNDARY_FRACTION: Final = 0.99  # of the step to the nearest constraint that is taken at most
MAX_BACKTRACKS: Final = 14  # halvings of a step
ARMIJO_SLOPE: Final = 1e-4  # share of the predicted decrease of the barrier function that a step must reach
MIN_CURVATURE_SHARE: Final = 0.02  # of the objective's curvature that remains after that of the constraints
MAX_DUAL_RATIO: Final = 1e6  # of a dual variable to its value on the central path, or the inverse


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Derivatives at n samples.

    Attributes:
        objective_gradient: (n,) derivative of the objective by the value at each sample, which is a weighted sum of its
            three coefficients.
        hessian_diagonal: (n,) second derivative of the objective's integrand by that value.
        constraint_jacobian: (n, k, 3) derivatives of the constraint values by the three coefficients.
    """

    objective_gradient: Array
    hessian_diagonal: Array
    constraint_jacobian: Array


class SampledProblem(Protocol):
    """A problem that can be minimized: its constraints hold where all constraint values are positive."""

    @property
    def intervals(self) -> int:
        """Number of intervals, with as many samples each; interval i depends on coefficients i to i + 2."""

    @property
    def basis(self) -> Array:
        """Weights (n, 3) of the three coefficients in the value at each sample."""

    @property
    def quadrature_weights(self) -> Array:
        """Weights (n,) of the samples in the objective, which is an integral."""

    @property
    def constraint_curvature(self) -> Array:
        """(k,) coefficient with which the objective's integrand enters each constraint."""

    def initial_coefficients(self) -> Array:
        """Return feasible coefficients (intervals + 2,)."""

    def constraint_values(self, coefficients: Array) -> tuple[float, Array] | None:
        """Return objective and constraint values (n, k) at each sample's coefficients (n, 3); None where undefined."""

    def derivatives(self, coefficients: Array) -> Derivatives:
        """Return the derivatives at each sample's coefficients (n, 3)."""


def minimize(problem: SampledProblem) -> Array:
    """Return coefficients (intervals + 2,) that nearly minimize the objective; all constraint values are positive."""
    found = problem.initial_coefficients()
    near = _coefficient_windows(found, problem)
    here = problem.constraint_values(near)
    assert here is not None
    assert here[1].min() > 0.0
    objective, slack = here
    duals = objective / (slack.size * slack)
    for _ in range(MAX_ITERATIONS):
        gap = float((slack * duals).sum())
        if gap < RELATIVE_GAP * objective:
            break
        aim = CENTERING * gap / slack.size
        slopes = problem.derivatives(near)
        step, gradient = _newton(problem, slopes, slack, duals, aim)
        change = np.matmul(slopes.constraint_jacobian, _coefficient_windows(step, problem)[:, :, None])[:, :, 0]
        turn = aim / slack - duals - duals / slack * change
        trial = _line_search(problem, found, step, (objective, slack), aim, _longest(slack, change), gradient)
        if trial is None:
            break
        found, objective, slack = trial
        near = _coefficient_windows(found, problem)
        central = aim / slack
        duals = np.clip(duals + _longest(duals, turn) * turn, central / MAX_DUAL_RATIO, central * MAX_DUAL_RATIO)
    return found


def _newton(
    problem: SampledProblem, derivatives: Derivatives, slack: Array, duals: Array, aim: float
) -> tuple[Array, float]:
    """Return the Newton step (intervals + 2,) and the slope of the barrier function along it."""
    value, weights, bands = problem.basis, problem.quadrature_weights, duals / slack
    pull = (
        derivatives.objective_gradient[:, None] * value
        - aim * np.matmul((1.0 / slack)[:, None], derivatives.constraint_jacobian)[:, 0]
    )
    curvature = derivatives.hessian_diagonal * np.maximum(
        weights - duals @ problem.constraint_curvature, MIN_CURVATURE_SHARE * weights
    )
    local = curvature[:, None, None] * value[:, :, None] * value[:, None]
    local += np.matmul(
        (derivatives.constraint_jacobian * bands[:, :, None]).transpose(0, 2, 1), derivatives.constraint_jacobian
    )
    gradient, band = _assembled(pull, local, problem.intervals)
    try:
        factor = cholesky_banded(band, check_finite=False)
    except LinAlgError:  # rounding has eaten the smallest curvature
        band[2] *= 1.0 + 1e-9
        factor = cholesky_banded(band, check_finite=False)
    step = -cho_solve_banded((factor, False), gradient, check_finite=False)
    return step, float(gradient @ step)


def _assembled(pull: Array, local: Array, intervals: int) -> tuple[Array, Array]:
    """Sum over the samples: return the gradient (intervals + 2,) and the Hessian as its three upper bands."""
    pull = pull.reshape(intervals, -1, 3).sum(axis=1)
    local = local.reshape(intervals, -1, 3, 3).sum(axis=1)
    gradient, band = np.zeros(intervals + 2), np.zeros((3, intervals + 2))
    for row in range(3):
        gradient[row : row + intervals] += pull[:, row]
        for column in range(row, 3):
            band[2 - column + row, column : column + intervals] += local[:, row, column]
    return gradient, band


def _line_search(
    problem: SampledProblem,
    begin: Array,
    step: Array,
    here: tuple[float, Array],
    aim: float,
    longest: float,
    slope: float,
) -> tuple[Array, float, Array] | None:
    """Return coefficients, objective and constraint values after a part of the step that lowers the barrier function.

    Returns None when no part of the step does.
    """
    before = here[0] - aim * float(np.log(here[1]).sum())
    for halving in range(MAX_BACKTRACKS):
        length = longest / 2**halving
        found = begin + length * step
        there = problem.constraint_values(_coefficient_windows(found, problem))
        if there is None or there[1].min() <= 0.0:
            continue
        if there[0] - aim * float(np.log(there[1]).sum()) <= before + ARMIJO_SLOPE * length * slope:
            return found, *there
    return None


def _longest(values: Array, changes: Array) -> float:
    """Return the largest share of the changes, at most 1, that leaves positive values positive."""
    return min(1.0, BOUNDARY_FRACTION / max(float((-changes / values).max()), 1e-12))


def _coefficient_windows(coefficients: Array, problem: SampledProblem) -> Array:
    """Return the three coefficients (n, 3) on which each sample depends."""
    windows = np.lib.stride_tricks.sliding_window_view(coefficients, 3)
    return np.repeat(windows, len(problem.quadrature_weights) // problem.intervals, axis=0)
