"""The motion across a gap of lost setpoints: of all that join its ends, the one whose largest jerk is the least.

What was lost kept the limit of the jerk. So does the motion with the least jerk, wherever in the gap the jerk of what
was lost had changed its sign; a polynomial through both ends swings beyond it. Its jerk has one size and changes its
sign at two moments at most. (The moments of a function of size w with the sign s on [0, a] and [b, 1] and -s between
are given; a and b eliminated, a polynomial of degree 4 in 1 / w is left.)
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from teachpath_client.driver.interpolation import Array, Quintic

MAX_IMAGINARY: Final = 1e-6  # part of a root that counts as real
MAX_OUTSIDE: Final = 1e-6  # of the gap, by which a change of sign may lie outside of it: for rounding
MAX_ERROR: Final = 1e-6  # of a moment, as a share of the largest one
MIN_JERK: Final = 1e-12  # [rad] by which a jerk moves a joint in the gap; below it there is none


class LeastJerk:
    """The motion between two setpoints that have others between them."""

    def __init__(self, one: Any, two: Any) -> None:
        """Join two setpoints."""
        self.one: Any = one
        self.two: Any = two
        self._span = (two.nominal_ns - one.nominal_ns) / 1e9
        h = self._span
        missing = np.array(
            [
                (two.acceleration - one.acceleration) * h**2,
                (two.velocity - one.velocity - one.acceleration * h) * h,
                two.position - one.position - one.velocity * h - one.acceleration * h**2 / 2,
            ]
        )
        self._pieces = [_pieces(moments) for moments in missing.T]  # of each joint; None: joined by the polynomial
        self._polynomial = Quintic(one, two)

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration `t` [s] behind the first."""
        h, (p, v, a) = self._span, self._polynomial(t)
        x = min(max(t / h, 0.0), 1.0)
        for joint, pieces in enumerate(self._pieces):
            if pieces is not None:
                begin = self.one.position[joint], self.one.velocity[joint] * h, self.one.acceleration[joint] * h**2
                place, speed, acceleration = _after(begin, pieces, x)
                p[joint], v[joint], a[joint] = place, speed / h, acceleration / h**2
        return p, v, a


def _after(
    begin: tuple[float, float, float], pieces: list[tuple[float, float]], x: float
) -> tuple[float, float, float]:
    """Return place, speed and acceleration after a share of the gap, in whose duration times are counted."""
    p, v, a = begin
    since = 0.0
    for until, jerk in pieces:
        t = max(min(until, x) - since, 0.0)
        p, v, a = p + t * (v + t * (a / 2 + t * jerk / 6)), v + t * (a + t * jerk / 2), a + t * jerk
        since += t
    return p, v, a


def _pieces(missing: Array) -> list[tuple[float, float]] | None:
    """Return until when [share of the gap] which jerk holds, or None where rounding leaves no answer.

    Args:
        missing: (3,) what the jerk adds to acceleration, speed and place, in units of the gap's duration [rad].
    """
    moments = missing * np.array([1.0, 2.0, 6.0])
    size = float(np.abs(moments).max())
    if size < MIN_JERK:
        return [(1.0, 0.0)]
    m0, m1, m2 = moments / size * np.array([1.0, 1 / 2, 1 / 6])
    roots = np.roots([-(m0**4), 4 * m0**3, 96 * m0 * m2 - 48 * m1**2 - 6 * m0**2, 48 * m1 - 96 * m2 - 12 * m0, 3.0])
    for z in sorted(roots.real[np.abs(roots.imag) < MAX_IMAGINARY], key=abs, reverse=True):
        pieces = _signed(float(z), m0, m1, m2) if abs(z) <= 1.0 + MAX_ERROR else None
        if pieces is not None:
            return [(until, size * jerk) for until, jerk in pieces]
    return None


def _signed(z: float, m0: float, m1: float, m2: float) -> list[tuple[float, float]] | None:
    """Return the pieces of a jerk of size 1 / z that has these moments, counted from the end of the gap; else None."""
    between, squares = (1 - m0 * z) / 2, (1 - 2 * m1 * z) / 2  # b - a and b^2 - a^2
    middle = squares / between / 2 if abs(between) > MAX_ERROR else 0.5
    a, b = middle - between / 2, middle + between / 2
    if not -MAX_OUTSIDE <= a <= b + MAX_OUTSIDE <= 1.0 + 2 * MAX_OUTSIDE:
        return None
    jerk = 1.0 / z
    errors = [jerk * (1 - 2 * (b**k - a**k)) / f - m for k, f, m in ((1, 1.0, m0), (2, 2.0, m1), (3, 6.0, m2))]
    if max(map(abs, errors)) > MAX_ERROR:
        return None
    return [(1.0 - b, jerk), (1.0 - a, -jerk), (1.0, jerk)]
