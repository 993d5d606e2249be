"""Tells when the arm itself rests, after the nominal motion has come to rest."""

from __future__ import annotations

import numpy as np

from teachpath.records import JointState


class ArmRest:
    """Judges joint states; after a time limit it says what keeps it from seeing that the arm rests.

    Args:
        max_speed: of a joint that counts as resting [rad/s].
        timeout: from the rest of the nominal motion, within which the arm comes to rest [s].

    Attributes:
        is_reached: whether the arm has taken up the standstill and its measured speed is at most `max_speed`.
        problem: why that was not seen within `timeout`, in words; empty before.
    """

    def __init__(self, max_speed: float, timeout: float) -> None:
        self._max_speed = max_speed
        self._timeout_ns = round(timeout * 1e9)
        self._since: int | None = None  # when the nominal motion was first seen at rest [ns]
        self.is_reached: bool = False
        self.problem: str = ""

    def begin_again(self) -> None:
        """Take note that the nominal motion is not at rest."""
        self._since, self.is_reached, self.problem = None, False, ""

    def update(self, arm: JointState | None, *, has_taken_standstill: bool, now: int) -> None:
        """Judge the arm while the nominal motion is at rest.

        Args:
            arm: its newest joint state; None when it is silent.
            has_taken_standstill: whether it has taken up a setpoint of the present standstill, or can follow none.
            now: for how long the loop has listened to the arm in all [ns].
        """
        if self._since is None:
            self._since = now
        problem = self._find_problem(arm, has_taken_standstill)
        self.is_reached = not problem
        is_late = arm is None or now - self._since > self._timeout_ns
        self.problem = problem if is_late else ""

    def _find_problem(self, arm: JointState | None, has_taken_standstill: bool) -> str:
        if arm is None:
            return "no joint state says whether the arm rests: is its driver running? look at the arm, then start again"
        speed = float(np.abs(arm.velocity).max())
        if speed > self._max_speed:
            return f"the arm still moves at {speed:.2f} rad/s: what moves it? look at the arm, then start again"
        if not has_taken_standstill:
            return "the arm has not taken up the end of its motion: does its driver hear the setpoints?"
        return ""
