"""A primal-dual interior-point method for a sum over samples, each of which reads three neighbouring coefficients.

The objective is convex; constraints may curve the wrong way: their own curvature is then left out, which is what
linearising them anew in every step comes to, and a line search on the barrier keeps every step feasible. Nocedal &
Wright, Numerical Optimization, 2nd ed., Springer 2006, chapter 19.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

from teachpath.motion.arm.puma560 import Array

MAX_ITERATIONS: Final = 60
CENTERING: Final = 0.15  # each step aims at this share of the present gap
RELATIVE_GAP: Final = 5e-4  # between the objective and its dual at which it is solved, relative
BOUNDARY_FRACTION: Final = 0.99  # of the way to the nearest constraint that a step goes at most
MAX_BACKTRACKS: Final = 14
ARMIJO_SLOPE: Final = 1e-4
MIN_CURVATURE_SHARE: Final = 0.02  # share of the objective's curvature that is kept when constraints take it away
MAX_DUAL_RATIO: Final = 1e6  # by which duals may be off the central path


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Derivatives at n samples.

    Attributes:
        objective: (n,) of the objective by the value at each sample, a weighted sum of its three coefficients.
        bend: (n,) second derivative by that value of what the objective sums with its weights.
        slack: (n, k, 3) of the constraints' slacks by the three coefficients.
    """

    objective_gradient: Array
    hessian_diagonal: Array
    constraint_jacobian: Array


class SampledProblem(Protocol):
    """What can be minimised."""

    @property
    def intervals(self) -> int:
        """Intervals in which the samples lie, as many in each; interval i reads coefficients i to i + 2."""

    @property
    def basis(self) -> Array:
        """Shares (n, 3) of the coefficients in the value at each sample."""

    @property
    def quadrature_weights(self) -> Array:
        """Weights (n,) of the samples in the objective."""

    @property
    def constraint_curvature(self) -> Array:
        """How much of what the objective sums each constraint (k,) has in its slack."""

    def initial_coefficients(self) -> Array:
        """Return feasible coefficients (intervals + 2,)."""

    def constraint_values(self, coefficients: Array) -> tuple[float, Array] | None:
        """Return the objective and the slacks (n, k) at coefficients near each sample (n, 3), None outside."""

    def derivatives(self, coefficients: Array) -> Derivatives:
        """Differentiate there."""


def minimize(problem: SampledProblem) -> Array:
    """Return coefficients (intervals + 2,) at which a problem's objective is least, nearly, and all slacks positive."""
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
    """Return the step (intervals + 2,) and the slope of the barrier along it."""
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
    """Add what the samples say: the gradient (intervals + 2,) and the matrix as its three upper bands."""
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
    """Return the coefficients, objective and slacks after a part of a step that lowers the barrier, or None."""
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
    """Return the share of changes, at most 1, after which positive values are still positive."""
    return min(1.0, BOUNDARY_FRACTION / max(float((-changes / values).max()), 1e-12))


def _coefficient_windows(coefficients: Array, problem: SampledProblem) -> Array:
    """Return the three coefficients (n, 3) that each sample reads."""
    windows = np.lib.stride_tricks.sliding_window_view(coefficients, 3)
    return np.repeat(windows, len(problem.quadrature_weights) // problem.intervals, axis=0)
