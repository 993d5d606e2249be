"""How much of the joint limits a motion uses, and how much of them a plan may use.

A plan leaves a reserve, so that its rate can be changed at once. Slowing down adds acceleration and jerk against the
way a joint turns, so the reserve is on that side alone, and it is the larger the faster the arm is, because a stop
takes the longer. Run backwards, a plan has its reserve on the other side: it runs slower that way (`governor`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.puma560 import Array
from teachpath.records import Extreme

# Of moves that have a reserve on both sides: shares of speed, acceleration and jerk.
SYMMETRIC_MARGINS: Final = (0.99, 0.93, 0.87)
SLOW_SPEED_SHARE: Final = 0.02  # share of its speed limit below which the way that a joint turns does not count


@dataclass(frozen=True)
class Margins:
    """Shares of the limits that a plan uses.

    Attributes:
        speed: of the speed limits; slowing down needs none of it.
        along: of the acceleration and jerk limits the way a joint turns.
        against: of the acceleration and jerk limits against it, at standstill.
        fast: the same where a joint turns at its speed limit; between, it falls with the square of the speed.
    """

    speed: float = 0.99
    along: tuple[float, float] = (0.99, 0.99)
    against: tuple[float, float] = (0.97, 0.95)
    against_at_speed: tuple[float, float] = (0.93, 0.86)

    @property
    def against_decrease(self) -> tuple[float, float]:
        """By how much `against` falls up to the speed limit."""
        return self.against[0] - self.against_at_speed[0], self.against[1] - self.against_at_speed[1]

    def time_stretch(self, setpoints: Array, limits: MotionLimits, rate: float) -> float:
        """Return the factor by which time must be stretched so that setpoints (n, 6) use these shares at most."""
        v, a, j = (change / limit for change, limit in zip(_changes(setpoints, rate), _each(limits), strict=True))
        fast = np.minimum((np.abs(v).max(axis=1) / self.speed) ** 2, 1.0)
        factors = [np.abs(v).max() / self.speed]
        for k, (use, root) in enumerate(((a, np.sqrt), (j, np.cbrt))):
            turning = v[1 : 1 + len(use)] * (np.abs(v[1 : 1 + len(use)]) > SLOW_SPEED_SHARE)
            against = (self.against[k] - self.against_decrease[k] * fast[1 : 1 + len(use)])[:, None]
            share = np.where(use * turning < 0.0, against, self.along[k])
            factors.append(root((np.abs(use) / share).max()))
        return float(max(factors))


NO_MARGINS: Final = Margins(1.0, (1.0, 1.0), (1.0, 1.0), (1.0, 1.0))


def limit_uses(setpoints: Array, limits: MotionLimits, rate: float) -> tuple[Array, Array, Array]:
    """Measure the use of speed (n - 1, 6), acceleration (n - 2, 6) and jerk limits (n - 3, 6) by differences."""
    first, second, third = (
        np.abs(change) / limit for change, limit in zip(_changes(setpoints, rate), _each(limits), strict=True)
    )
    return first, second, third


def largest_use(values: Array, lengths: Array, limits: Array | float = 1.0) -> Extreme:
    """Return the largest share of the limits (6,) in values (n, 6), with its joint and arc length.

    Args:
        values: (n, 6) of the joints.
        lengths: (n,) arc lengths where they occur [m].
        limits: (6,), or 1 for values that are shares already.
    """
    share = values / limits
    row, joint = np.unravel_index(int(np.argmax(share)), share.shape)
    s = float(lengths[row])
    return Extreme(float(share[row, joint]), f"joint {joint + 1} at s = {s:.3f} m", s)


def _changes(setpoints: Array, rate: float) -> list[Array]:
    return [np.diff(setpoints[:, :6], order, axis=0) * rate**order for order in (1, 2, 3)]


def _each(limits: MotionLimits) -> tuple[Array, Array, Array]:
    return limits.speed, limits.acceleration, limits.jerk
