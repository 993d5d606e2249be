"""Removal of the knots that an error bound does not need, compiled.

Piegl & Tiller, The NURBS Book (2nd ed., Springer 1997), section 5.4 and algorithms A2.4, A5.8, A9.8 and A9.9.
"""

from __future__ import annotations

import numpy as np

from teachpath.compiled import compiled
from teachpath.records import Array


def remove_knots(
    degree: int, knots: Array, points: Array, at: Array, errors: Array, bound: float
) -> tuple[Array, Array]:
    """Remove as many interior knots as the bound allows, the one that moves the curve least first (A9.9).

    Args:
        degree: p of the B-spline, at least 1.
        knots: (n + p + 1,) clamped, not decreasing; interior ones at most p times.
        points: (n, d) control points [m].
        at: (m,) parameters in ascending order, at which the errors are watched.
        errors: (m,) what the curve is off there already, at most [m].
        bound: what no error may exceed by the removal [m].

    Returns:
        knots and control points of the same degree. Nowhere in `at` is the curve farther from where it was than the
        bound less the error there.
    """
    return _reduced(degree, knots.copy(), points.copy(), at, errors.copy(), bound)


@compiled()
def _reduced(degree: int, knots: Array, points: Array, at: Array, errors: Array, bound: float) -> tuple[Array, Array]:
    count = len(knots)
    costs = np.empty(count)
    for r in range(count):
        costs[r] = _cost(degree, knots[:count], points, r)
    added = np.empty(len(at))
    while True:
        # Of knots whose costs differ by rounding the first is taken: moved points lose the same knots.
        least, r = np.min(costs[:count]) * (1 + 1e-9), 0
        if not np.isfinite(least):
            break
        while costs[r] > least:
            r += 1
        begin, end = _added_errors(degree, knots[:count], r, at, costs[r], added)
        if np.any(errors[begin:end] + added[begin:end] > bound):
            costs[r] = np.inf
            continue
        errors[begin:end] += added[begin:end]
        _remove(degree, knots[:count], points, r)
        for k in range(r, count - 1):
            knots[k], costs[k] = knots[k + 1], costs[k + 1]
        count -= 1
        for near in range(max(r - degree - 1, 0), min(r + degree + 1, count)):
            costs[near] = _cost(degree, knots[:count], points, near)
    return knots[:count], points[: count - degree - 1]


@compiled()
def _multiplicity(knots: Array, r: int) -> int:
    first = r
    while knots[first - 1] == knots[r]:
        first -= 1
    return r - first + 1


@compiled()
def _share(degree: int, knots: Array, r: int, i: int) -> float:
    return float((knots[r] - knots[i]) / (knots[i + degree + 1] - knots[i]))


@compiled()
def _sides(degree: int, knots: Array, points: Array, r: int, s: int) -> tuple[Array, int, int]:
    """Solve for the control points without knot r of multiplicity s from both sides (eq. 5.28).

    Returns:
        those from r - p - 1 on, and the range of old ones that is left between; empty where the sides overlap.
    """
    begin, i, j = r - degree - 1, r - degree, r - s
    solved = points[begin : r - s + 2].copy()
    while j > i:
        left, right = _share(degree, knots, r, i), _share(degree, knots, r, j)
        solved[i - begin] = (points[i] - (1 - left) * solved[i - 1 - begin]) / left
        solved[j - begin] = (points[j] - right * solved[j + 1 - begin]) / (1 - right)
        i, j = i + 1, j - 1
    return solved, i, j


@compiled()
def _cost(degree: int, knots: Array, points: Array, r: int) -> float:
    """Return how far apart the two sides are without knot r [m], infinite where it cannot be removed (A9.8).

    Of equal knots only the last can be removed.
    """
    if not degree < r < len(knots) - degree - 1 or knots[r] == knots[r + 1]:
        return np.inf
    solved, i, j = _sides(degree, knots, points, r, _multiplicity(knots, r))
    begin = r - degree - 1
    if j < i:
        apart = solved[i - 1 - begin] - solved[j + 1 - begin]
    else:
        share = _share(degree, knots, r, i)
        apart = points[i] - share * solved[i + 1 - begin] - (1 - share) * solved[i - 1 - begin]
    return float(np.sqrt(np.sum(apart * apart)))


@compiled()
def _remove(degree: int, knots: Array, points: Array, r: int) -> None:
    """Take knot r from the control points, however far that moves the curve (A5.8).

    Where the sides leave two candidates for one control point, the left one stays: A5.8 keeps the right one, for which
    the error of eq. (9.82) does not hold.
    """
    s = _multiplicity(knots, r)
    solved, _, _ = _sides(degree, knots, points, r, s)
    points[r - degree - 1 : r - s + 2] = solved
    for k in range((2 * r - s - degree + 1) // 2, len(knots) - degree - 2):
        points[k] = points[k + 1]


@compiled()
def _added_errors(degree: int, knots: Array, r: int, at: Array, cost: float, added: Array) -> tuple[int, int]:
    """Write how far removing knot r moves the curve (eq. 9.81, 9.82); return the range of the touched parameters."""
    s = _multiplicity(knots, r)
    index, factor = r - (degree + s) // 2, cost
    if (degree + s) % 2:
        factor *= 1 - _share(degree, knots, r, index)
    begin = np.searchsorted(at, knots[index])
    end = np.searchsorted(at, knots[index + degree + 1])
    values = np.empty(degree + 1)
    for k in range(begin, end):
        added[k] = factor * _basis(degree, knots, index, at[k], values)
    return begin, end


@compiled()
def _basis(degree: int, knots: Array, index: int, u: float, values: Array) -> float:
    """Evaluate one basis function (A2.4), 0/0 being 0."""
    for k in range(degree + 1):
        values[k] = 1.0 if knots[index + k] <= u < knots[index + k + 1] else 0.0
    for order in range(1, degree + 1):
        for k in range(degree + 1 - order):
            low, high = index + k, index + k + order + 1
            rising, falling = knots[high - 1] - knots[low], knots[high] - knots[low + 1]
            value = 0.0
            if rising > 0:
                value += (u - knots[low]) / rising * values[k]
            if falling > 0:
                value += (knots[high] - u) / falling * values[k + 1]
            values[k] = value
    return float(values[0])
