"""Measures how much of the joint limits a motion uses, and sets the margins that a plan leaves.

The margins allow the rate of a plan to change at any time. Slowing down adds acceleration and jerk against a joint's
direction of turning, so the margins lie on that side; they grow with the speed, because a stop from a higher speed
takes longer. A plan that runs backwards has its margins on the other side, so it runs slower then (`governor`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.puma560 import Array
from teachpath.records import Extreme

# Shares of speed, acceleration and jerk limits that moves with equal margins on both sides use.
SYMMETRIC_MARGINS: Final = (0.99, 0.93, 0.87)
SLOW_SPEED_SHARE: Final = 0.02  # of its speed limit, below which a joint's direction of turning does not count


@dataclass(frozen=True)
class Margins:
    """Shares of the limits that a plan may use; what remains is the margin.

    Attributes:
        speed: of the speed limits; slowing down needs no margin of them.
        along: of the acceleration and jerk limits, along a joint's direction of turning.
        against: of the acceleration and jerk limits against it, at standstill.
        against_at_speed: the same at a joint's speed limit; in between, it falls with the square of the speed.
    """

    speed: float = 0.99
    along: tuple[float, float] = (0.99, 0.99)
    against: tuple[float, float] = (0.97, 0.95)
    against_at_speed: tuple[float, float] = (0.93, 0.86)

    @property
    def against_decrease(self) -> tuple[float, float]:
        """By how much `against` falls between standstill and speed limit."""
        return self.against[0] - self.against_at_speed[0], self.against[1] - self.against_at_speed[1]

    def time_stretch(self, setpoints: Array, limits: MotionLimits, rate: float) -> float:
        """Return the factor by which time must be stretched for setpoints (n, joints) to use only these shares."""
        v, a, j = (
            change / limit for change, limit in zip(_changes(setpoints, limits, rate), _each(limits), strict=True)
        )
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
    """Return the used shares of speed (n - 1, joints), acceleration and jerk limits, by differences."""
    first, second, third = (
        np.abs(change) / limit for change, limit in zip(_changes(setpoints, limits, rate), _each(limits), strict=True)
    )
    return first, second, third


def largest_use(values: Array, lengths: Array, names: Sequence[str], limits: Array | float = 1.0) -> Extreme:
    """Return the largest share of the limits (joints,) in values (n, joints), with its joint and arc length.

    Args:
        values: (n, joints) of the joints.
        lengths: (n,) arc lengths where they occur [m].
        names: of the joints.
        limits: (joints,), or 1 for values that are shares already.
    """
    share = values / limits
    row, joint = np.unravel_index(int(np.argmax(share)), share.shape)
    s = float(lengths[row])
    return Extreme(float(share[row, joint]), f"{names[int(joint)]} at s = {s:.3f} m", s)


def _changes(setpoints: Array, limits: MotionLimits, rate: float) -> list[Array]:
    joints = setpoints[:, : len(limits.speed)]  # what may stand behind them is a length
    return [np.diff(joints, order, axis=0) * rate**order for order in (1, 2, 3)]


def _each(limits: MotionLimits) -> tuple[Array, Array, Array]:
    return limits.speed, limits.acceleration, limits.jerk
