"""What was declared on a bus, to be taken back."""

from __future__ import annotations

from collections.abc import Callable


class Declaration:
    """A handle that calls a function once, when it is closed."""

    def __init__(self, undeclare: Callable[[], object]) -> None:
        self._undeclare: Callable[[], object] | None = undeclare

    def close(self) -> None:
        """Call the function, at the first call only."""
        undeclare, self._undeclare = self._undeclare, None
        if undeclare is not None:
            undeclare()
