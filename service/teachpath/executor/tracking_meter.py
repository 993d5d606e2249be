"""How far the arm is off its setpoints, by its place: not by what its driver says that it wanted."""

from __future__ import annotations

from collections import deque
from itertools import islice
from typing import Final

import numpy as np

from teachpath.records import Array, JointState, Setpoint

MAX_AGE: Final = 1.0  # [s] for which a setpoint is known; an arm that is later is waited for, or held


class TrackingMeter:
    """Measures one arm against the newest setpoints that were sent to it.

    Args:
        rate: setpoints a second [Hz].

    Attributes:
        largest: tracking error until now [rad].
    """

    def __init__(self, rate: float) -> None:
        self.largest: float = 0.0
        self._sent: deque[Setpoint] = deque(maxlen=round(MAX_AGE * rate))

    def add(self, setpoint: Setpoint) -> None:
        """Keep a setpoint, which follows the newest one."""
        self._sent.append(setpoint)

    def measure(self, arm: JointState) -> float:
        """Return the tracking error now [rad]: by the arm's place, or by its own account where that is larger."""
        error = max(arm.tracking_error, self.distance(arm))
        self.largest = max(self.largest, error)
        return error

    def distance(self, arm: JointState) -> float:
        """Return how far off the arm is: the largest over its joints [rad]; 0 where that is not known any more.

        It may be anywhere between the setpoint that it has reached and the newest one, or on the way to rest: setpoints
        may be lost, and an arm that has gone to rest is taken up again there.
        """
        first = self._sent[0].cycle if self._sent else arm.cycle + 1
        if not 0 <= arm.cycle - first < len(self._sent):
            return 0.0
        ahead = list(islice(self._sent, arm.cycle - first, None))
        reached = ahead[0].position[None]
        ways = (np.array([each.position for each in ahead]), np.concatenate([reached, ahead[0].way_to_rest[:, 0]]))
        return min(_distance(way, arm.position) for way in ways)


def _distance(way: Array, position: Array) -> float:
    """Return the distance (largest over the joints) of a position (joints,) from lines between points (n, joints)."""
    begins, steps = way[:-1], np.diff(way, axis=0)
    if not len(steps):
        return float(np.abs(way[0] - position).max())
    lengths = np.maximum((steps**2).sum(axis=1), 1e-30)
    shares = np.clip(((position - begins) * steps).sum(axis=1) / lengths, 0.0, 1.0)
    return float(np.abs(begins + shares[:, None] * steps - position).max(axis=1).min())
