"""Time that goes on while somebody sleeps, with what happens at certain times of it."""

from collections.abc import Callable


class ScriptedTime:
    """A clock of its own.

    Attributes:
        now: [s].
    """

    def __init__(self) -> None:
        self.now = 0.0
        self._script: list[tuple[float, Callable[[], None]]] = []

    def after(self, seconds: float, action: Callable[[], None]) -> None:
        """Let something happen in some seconds."""
        self._script = sorted([*self._script, (self.now + seconds, action)], key=lambda entry: entry[0])

    def clock(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += max(seconds, 1e-3)
        while self._script and self._script[0][0] <= self.now:
            self._script.pop(0)[1]()
