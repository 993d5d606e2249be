"""Which output of the arm is on: that of the setpoint played last, as long as setpoints come."""

from __future__ import annotations

from typing import Final

SILENCE: Final = 0.1  # [s] without a setpoint, at rest, after which an output is off: whoever sent it may have died


def output_of(setpoint: object) -> str:
    """Return the name of a setpoint's output; empty where none is on, as in setpoints of a driver's own."""
    return str(getattr(setpoint, "output", ""))


class OutputSwitch:
    """Switches an output by the setpoints that are played.

    Attributes:
        name: of the output that is on; empty: none is.
    """

    def __init__(self) -> None:
        self.name: str = ""
        self._silence = 0.0

    def update(self, played: object, dt: float, *, is_fed: bool) -> None:
        """Go on by `dt` [s].

        Args:
            played: the setpoint that was played last; None: none was.
            dt: since the last call [s].
            is_fed: whether it was played just now, or others wait.
        """
        self._silence = 0.0 if is_fed else self._silence + dt
        self.name = output_of(played) if self._silence <= SILENCE else ""
