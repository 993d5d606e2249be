"""Between setpoints, and along the way to rest: polynomials that meet position, velocity and acceleration."""

from __future__ import annotations

from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

BLEND_TIME: Final = 0.12  # s, over which an offset of position is taken up
BRAKE_TIME: Final = 0.1  # s, to brake without a way to rest: only a sender that breaks the contract needs it


class Quintic:
    """The quintic Hermite polynomial between two setpoints."""

    def __init__(self, one: Any, two: Any) -> None:
        """Join two setpoints."""
        self.one, self.two = one, two
        self._span = (two.nominal_ns - one.nominal_ns) / 1e9
        ends = [(s.position, s.velocity, s.acceleration) for s in (one, two)]
        self._powers = hermite(*ends[0], *ends[1], self._span)

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration `t` [s] behind the first."""
        return evaluate(self._powers, min(max(t, 0.0), self._span), self._span)


class WayToRest:
    """The cubic spline through positions one period apart, from the setpoint's velocity to rest.

    The executor changes the jerk from period to period only: so this is the motion that it has checked, between the
    positions too. Velocities by differences would add up to a quarter to its jerk.

    Args:
        setpoint: where it begins.
        period: between two positions [s].
    """

    def __init__(self, setpoint: Any, period: float) -> None:
        ways = setpoint.way_to_rest
        if not len(ways):
            ways = _braked(setpoint, period)
        self._rows, self._period = np.vstack([setpoint.position, ways]), period
        self._velocities = _spline_velocities(self._rows, setpoint.velocity, period)
        ahead = np.diff(self._rows, axis=0) / period
        bends = (6 * ahead - 4 * self._velocities[:-1] - 2 * self._velocities[1:]) / period
        self._accelerations = np.vstack([setpoint.acceleration, bends[1:], np.zeros(6)])
        self.duration = len(ways) * period

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration `t` [s] behind the setpoint."""
        if t >= self.duration:
            return self._rows[-1], np.zeros(6), np.zeros(6)
        row = min(int(t / self._period), len(self._rows) - 2)
        one, two = ((self._rows[k], self._velocities[k], self._accelerations[k]) for k in (row, row + 1))
        return evaluate(hermite(*one, *two, self._period), t - row * self._period, self._period)


def _spline_velocities(rows: Array, begin: Array, period: float) -> Array:
    """Return velocities (n, 6) of the cubic spline through rows (n, 6), from velocity `begin` (6,) to rest.

    Its second derivative is continuous where a + 4 b + c = 3 (next - previous) / period for velocities a, b, c in a
    row; elimination from the first row to the last solves that (C. de Boor, A Practical Guide to Splines, chapter IV).
    """
    velocities = np.vstack([begin, 3.0 * (rows[2:] - rows[:-2]) / period, np.zeros(6)])
    shares = np.zeros(len(rows))
    for k in range(1, len(rows) - 1):
        shares[k] = 1.0 / (4.0 - shares[k - 1])
        velocities[k] = shares[k] * (velocities[k] - velocities[k - 1])
    for k in range(len(rows) - 2, 0, -1):
        velocities[k] -= shares[k] * velocities[k + 1]
    return velocities


def _braked(setpoint: Any, period: float) -> Array:
    """Return positions (n, 6) of a straight stop, for a setpoint that has no way to rest."""
    if not setpoint.velocity.any():
        return np.array([setpoint.position])
    count = max(round(BRAKE_TIME / period), 2)
    x = np.arange(1, count + 1)[:, None] / count
    return np.asarray(setpoint.position + setpoint.velocity * count * period * (x - x**2 / 2))


def hermite(p0: Array, v0: Array, a0: Array, p1: Array, v1: Array, a1: Array, span: float) -> Array:
    """Return the coefficients (6, 6) of the quintic by the share of the span that meets both ends."""
    v0, a0, v1, a1 = v0 * span, a0 * span**2, v1 * span, a1 * span**2
    d, e, f = p1 - p0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    return np.array([p0, v0, a0 / 2, 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2])


def evaluate(powers: Array, t: float, span: float) -> tuple[Array, Array, Array]:
    """Return position, velocity and acceleration at `t` [s] of a polynomial over `span` [s]."""
    x, h = t / span, span
    shares = (
        (1.0, x, x**2, x**3, x**4, x**5),
        (0.0, 1.0 / h, 2 * x / h, 3 * x**2 / h, 4 * x**3 / h, 5 * x**4 / h),
        (0.0, 0.0, 2.0 / h**2, 6 * x / h**2, 12 * x**2 / h**2, 20 * x**3 / h**2),
    )
    p, v, a = np.array(shares) @ powers
    return p, v, a


def blended(off: Array, since: float) -> tuple[Array, Array, Array]:
    """Let an offset of position die away to rest, as a quintic over `BLEND_TIME`."""
    h = BLEND_TIME
    x = since / h
    p = off * (1 - 10 * x**3 + 15 * x**4 - 6 * x**5)
    v = off * (-30 * x**2 + 60 * x**3 - 30 * x**4) / h
    a = off * (-60 * x + 180 * x**2 - 120 * x**3) / h**2
    return p, v, a
