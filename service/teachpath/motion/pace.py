"""Jerk-limited timing: how fast to run through a path whose parameter is already nearly proportional to time.

The unknown is x(sigma) = (d sigma / dt)^2, a quadratic spline. Speed and acceleration limits are linear in x and its
derivatives; the jerk limit q''' x + 3/2 q'' x' + 1/2 q' x'' <= J / sqrt(x) is replaced by its tangent, which is an
under-estimate, so that every linear program yields a feasible x (Debrouwere et al., Time-optimal path following for
robots with convex-concave constraints using sequential convex programming, IEEE Transactions on Robotics 29(6), 2013).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array

from teachpath.motion.joints import JointPath, Limits
from teachpath.motion.puma560 import Array

PLACES: Final = (0.02, 0.5, 0.98)  # within an interval, where the limits are imposed
FINE: Final = 8  # places per interval at which a solution is checked
PROGRAMS: Final = (3, 2, 2, 2)  # linear programs at most, before broken places are added and again after each time
ENOUGH: Final = 0.002  # relative gain below which it is not worth going on
BROKEN: Final = 1.003  # use of a limit that is added to the places
FACTOR: Final = 3.0  # by which a coefficient may change in one linear program
STILL: Final = 1e-6  # share of its limits that a joint uses when it stands still


Rows = tuple[NDArray[np.int64], Array, Array, Array]


def spline_rows(places: Array, intervals: int) -> Rows:
    """Evaluate the quadratic B-splines on even intervals of [0, 1].

    Returns:
        (n,) index of the first of three coefficients, and (n, 3) their shares in value, first and second derivative.
    """
    first = np.clip((places * intervals).astype(np.int64), 0, intervals - 1)
    t = places * intervals - first
    value = np.stack([(1 - t) ** 2 / 2, t * (1 - t) + 0.5, t**2 / 2], axis=1)
    slope = intervals * np.stack([t - 1, 1 - 2 * t, t], axis=1)
    curvature = intervals**2 * np.tile([1.0, -2.0, 1.0], (len(t), 1))
    return first, value, slope, curvature


def fastest_pace(path: JointPath, limits: Limits, intervals: int) -> Array:
    """Find x(sigma) that brings the arm from end to end soonest, as coefficients (intervals + 2,) [1/s^2].

    Args:
        path: whose parameter is nearly proportional to time, with the third power of time at both ends.
        limits: to keep, at samples; what lies between them is for the caller to measure.
        intervals: of the spline.
    """
    places = ((np.arange(intervals)[:, None] + np.array(PLACES)) / intervals).ravel()
    fine = (np.arange(FINE * intervals) + 0.5) / (FINE * intervals)
    watch = _Samples.at(path, limits, fine, intervals)
    best = np.ones(intervals + 2)
    best = best / watch.use(best) ** 2
    for programs in PROGRAMS:
        samples = _Samples.at(path, limits, places, intervals)
        best = best / max(samples.use(best), 1.0) ** 2
        for _ in range(programs):
            best, gain = _improved(best, samples)
            if gain < ENOUGH:
                break
        broken = watch.broken(best)
        best = best / max(watch.use(best), 1.0) ** 2
        if not len(broken):
            break
        places = np.union1d(places, fine[broken])
    return best


@dataclass(frozen=True, eq=False)
class _Samples:
    """The limits at some places: rows[k] are dq^k/dsigma^k over the limit that they count against."""

    rows: Rows
    weights: Array  # (n,) of the places in an integral over sigma
    ceiling: Array  # (n,) largest x for the speed limits
    acceleration: tuple[Array, Array]  # (n, 6) q'' / A, q' / A
    jerk: tuple[Array, Array, Array]  # (n, 6) q''' / J, q'' / J, q' / J

    @staticmethod
    def at(path: JointPath, limits: Limits, places: Array, intervals: int) -> _Samples:
        first, second, third = (path(places, k)[:, :6] for k in (1, 2, 3))
        edges = np.concatenate([[0.0], (places[1:] + places[:-1]) / 2, [1.0]])
        ceiling = np.min((limits.speed / np.maximum(np.abs(first), 1e-9)) ** 2, axis=1)
        a, j = limits.acceleration, limits.jerk
        return _Samples(
            spline_rows(places, intervals), np.diff(edges), ceiling, (second / a, first / a),
            (third / j, second / j, first / j),
        )  # fmt: skip

    def values(self, x: Array) -> tuple[Array, Array, Array]:
        first, *shares = self.rows
        near = x[first[:, None] + np.arange(3)]
        value, slope, curvature = (np.einsum("ij,ij->i", near, share) for share in shares)
        return value, slope, curvature

    def terms(self, x: Array) -> tuple[Array, Array, Array, Array]:
        """Return x at the places, and the use of speed (n,), acceleration and jerk (n, 6), signed."""
        value, slope, curvature = self.values(x)
        second, first = self.acceleration
        acceleration = second * value[:, None] + 0.5 * first * slope[:, None]
        third, second, first = self.jerk
        jerk = third * value[:, None] + 1.5 * second * slope[:, None] + 0.5 * first * curvature[:, None]
        return value, value / self.ceiling, acceleration, jerk * np.sqrt(np.maximum(value, 0.0))[:, None]

    def uses(self, x: Array) -> Array:
        """Return the factor (n,) by which time would have to be stretched at each place."""
        value, speed, acceleration, jerk = self.terms(x)
        uses = np.maximum(np.sqrt(np.abs(acceleration).max(axis=1)), np.cbrt(np.abs(jerk).max(axis=1)))
        return np.where(value > 0.0, np.maximum(uses, np.sqrt(np.maximum(speed, 0.0))), np.inf)

    def use(self, x: Array) -> float:
        return float(self.uses(x).max())

    def broken(self, x: Array) -> NDArray[np.int64]:
        """Return the places at which the use has a local maximum beyond its limit."""
        uses = self.uses(x)
        padded = np.concatenate([[-np.inf], uses, [-np.inf]])
        peak = (uses >= padded[:-2]) & (uses >= padded[2:]) & (uses > BROKEN)
        return np.asarray(np.nonzero(peak)[0])

    def duration(self, x: Array) -> float:
        value = self.values(x)[0]
        return float(np.sum(self.weights / np.sqrt(value))) if value.min() > 0.0 else np.inf


def _improved(x: Array, samples: _Samples) -> tuple[Array, float]:
    """Solve one linear program about x; return the better x and the relative gain in time."""
    aim = _linear_program(x, samples)
    before = samples.duration(x) * max(samples.use(x), 1.0)
    best, shortest = x, before
    if aim is None:
        return best, 0.0
    for share in (1.0, 0.75, 0.5, 0.25):
        trial = x + share * (aim - x)
        use = max(samples.use(trial), 1.0)
        if samples.duration(trial) * use < shortest:
            best, shortest = trial / use**2, samples.duration(trial) * use
            break
    return best, 1.0 - shortest / before


def _linear_program(x: Array, samples: _Samples) -> Array | None:
    first, value, slope, curvature = samples.rows
    now = samples.values(x)[0]
    weight = np.zeros_like(x)
    np.add.at(weight, first[:, None] + np.arange(3), (samples.weights / (2 * now**1.5))[:, None] * value)
    second, third = (share[:, :, None] for share in samples.acceleration)
    acceleration = second * value[:, None] + 0.5 * third * slope[:, None]  # (n, 6, 3)
    three, two, one = (share[:, :, None] for share in samples.jerk)
    jerk = three * value[:, None] + 1.5 * two * slope[:, None] + 0.5 * one * curvature[:, None]
    jerk *= np.sqrt(now)[:, None, None]
    tangent = (0.5 * value / now[:, None])[:, None]
    speed = (value / samples.ceiling[:, None])[:, None]
    moves = np.tile(np.abs(third[:, :, 0]).max(axis=0) > STILL, len(first))
    blocks, columns, bounds = [speed[:, 0]], [first], [np.ones(len(first))]
    for block, bound in ((acceleration, 1.0), (-acceleration, 1.0), (jerk + tangent, 1.5), (-jerk + tangent, 1.5)):
        blocks.append(block.reshape(-1, 3)[moves])
        columns.append(np.repeat(first, 6)[moves])
        bounds.append(np.full(len(columns[-1]), bound))
    start, data = np.concatenate(columns), np.concatenate(blocks)
    column = start[:, None] + np.arange(3)
    entries = ((data * x[column]).ravel(), column.ravel(), 3 * np.arange(len(start) + 1))
    matrix = csr_array(entries, shape=(len(start), len(x)))
    answer = linprog(  # type: ignore[call-overload]  # its stubs know no sparse arrays
        -weight * x, A_ub=matrix, b_ub=np.concatenate(bounds), bounds=(1 / FACTOR, FACTOR), method="highs-ds",
        options={"presolve": False},
    )  # fmt: skip
    return x * answer.x if answer.status == 0 else None
