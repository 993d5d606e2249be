"""Notices an arm that moves although nothing is under way; nothing starts then until somebody acknowledges it."""

from __future__ import annotations

import threading
from typing import Final

import numpy as np

from teachpath.errors import Conflict
from teachpath.records import Array, JointState

SETTLING_TIME: Final = 1.0  # [s] that an arm has after an execution, and after a silence, to come to rest
REST_TIME: Final = 2.0  # [s] for which an arm that moved unasked must rest before that is acknowledged


class UnaskedMotionDetector:
    """Compares where the arm is with where it came to rest.

    An arm that was silent is taken to rest where it is found: a driver that was started again may know no better. What
    was noticed before stays noticed. `acknowledge` is called on another thread than the rest.

    Args:
        threshold: that a joint may move [rad].
        silence: without a joint state after which the arm counts as gone [s].

    Attributes:
        reason: that the arm moved unasked and why nothing starts, in words; empty where nothing has to be acknowledged.
    """

    def __init__(self, threshold: float, silence: float) -> None:
        self.reason: str = ""
        self._threshold = threshold
        self._silence = silence
        self._lock = threading.Lock()
        self._resting_since: int | None = None  # [ns of the clock] when it had to begin to come to rest
        self._rest_q: Array | None = None  # (joints,) where it came to rest
        self._still_q: Array | None = None  # (joints,) where an arm that moved unasked has been since `_still_since`
        self._still_since = 0
        self._largest = 0.0  # [rad] that a joint was away from where it rested

    def forget(self) -> None:
        """Take no note of motion, because an execution is under way or there is no arm."""
        with self._lock:
            self._resting_since = self._rest_q = self._still_q = None

    def acknowledge(self) -> None:
        """Let executions start again; where nothing has to be acknowledged, this does nothing.

        Raises:
            Conflict: the arm does not rest yet, or nobody knows whether it does.
        """
        with self._lock:
            if not self.reason:
                return
            if self._rest_q is None or self._still_q is not None:
                raise Conflict(
                    f"the arm has not rested for {REST_TIME:g} s since it moved unasked; wait, then acknowledge it"
                )
            self.reason, self._largest = "", 0.0

    def update(self, now: int, silence: float, arm: JointState) -> str:
        """Take the newest joint state, and how old it is [s], while nothing is under way.

        Args:
            now: [ns of the clock].

        Returns:
            A sentence for the journal when the arm is first seen moving, and when it rests again; else nothing.
        """
        if silence > self._silence:
            self.forget()
            return ""
        with self._lock:
            return self._compare(now, arm)

    def _compare(self, now: int, arm: JointState) -> str:
        if self._resting_since is None:
            self._resting_since = now
        if self._rest_q is None:
            self._rest_q = arm.position if now - self._resting_since > SETTLING_TIME * 1e9 else None
            return ""
        if self._still_q is not None:
            return self._wait_for_rest(now, arm.position, self._rest_q, self._still_q)
        away = float(np.abs(arm.position - self._rest_q).max())
        if away <= self._threshold:
            return ""
        self._still_q, self._still_since, self._largest = arm.position, now, max(self._largest, away)
        self._describe()
        return f"a joint is {away:.3f} rad from where the arm came to rest; nothing starts before it is acknowledged"

    def _wait_for_rest(self, now: int, position: Array, rest_q: Array, still_q: Array) -> str:
        self._largest = max(self._largest, float(np.abs(position - rest_q).max()))
        if np.abs(position - still_q).max() > self._threshold / 2:
            self._still_q, self._still_since = position, now
        if now - self._still_since < REST_TIME * 1e9:
            self._describe()
            return ""
        self._rest_q, self._still_q = position, None
        return f"the arm rests again; it moved by up to {self._largest:.3f} rad"

    def _describe(self) -> None:
        self.reason = (
            f"the arm moved by {self._largest:.2f} rad although no execution is under way: does somebody push it, or "
            "another program send setpoints? nothing starts before somebody has seen why and acknowledges it (page, or "
            "teachpath acknowledge)"
        )


def moved_since_order(off: float) -> str:
    """Say that the arm has moved by `off` [rad] since an execution was ordered, and that therefore nothing starts."""
    return (
        f"the arm moved by {off:.2f} rad while its motion was made ready: does somebody push it, or another program "
        "send setpoints? look why, then start again"
    )
