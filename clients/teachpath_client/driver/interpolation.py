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
        self.one: Any = one
        self.two: Any = two
        self._span = (two.nominal_ns - one.nominal_ns) / 1e9
        self._powers = hermite(_state(one), _state(two), self._span)

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration `t` [s] behind the first."""
        return evaluate(self._powers, min(max(t, 0.0), self._span), self._span)


class WayToRest:
    """The motion from a setpoint through the states of its way to rest, joined as setpoints are.

    Positions alone would not do: where the jerk changes its sign within a period, what joins them swings.

    Args:
        setpoint: where it begins; without a way to rest, it is braked straight ahead.
        period: between two states [s].
    """

    def __init__(self, setpoint: Any, period: float) -> None:
        begin, way = _state(setpoint), setpoint.way_to_rest
        if not len(way):
            period = BRAKE_TIME
            way = np.zeros((1, *begin.shape))
            way[0, 0] = begin[0] + begin[1] * BRAKE_TIME / 2
        self._states, self._period = np.concatenate([begin[None], way]), period
        self.duration: float = len(way) * period

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration `t` [s] behind the setpoint."""
        if t >= self.duration:
            still = np.zeros(self._states.shape[2])
            return self._states[-1, 0], still, still
        row = min(int(t / self._period), len(self._states) - 2)
        one, two = self._states[row], self._states[row + 1]
        return evaluate(hermite(one, two, self._period), t - row * self._period, self._period)


def _state(setpoint: Any) -> Array:
    return np.array([setpoint.position, setpoint.velocity, setpoint.acceleration])


def hermite(one: Array, two: Array, span: float) -> Array:
    """Return the coefficients (6, joints) of the quintic by the share of the span that meets both states."""
    scale = np.array([[1.0], [span], [span**2]])
    (p0, v0, a0), (p1, v1, a1) = one * scale, two * scale
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
