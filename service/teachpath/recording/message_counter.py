"""What happened, kind by kind: a thousand bad samples of one kind are one sentence, and hide no other kind."""

from __future__ import annotations

import re

MAX_KINDS = 20  # that are told apart; the rest are only counted
NUMBER_PATTERN = re.compile(r"[-+]?(\d[\w.+-]*|nan|inf)\b")


class MessageCounter:
    """Counts sentences that differ in their numbers only as one kind.

    Args:
        rest: what is said of kinds beyond the first `KINDS`.
    """

    def __init__(self, rest: str) -> None:
        self._rest = rest
        self._kinds: dict[str, tuple[str, int]] = {}  # the first sentence of each kind, and how many

    def add(self, sentence: str) -> None:
        """Count one."""
        kind = NUMBER_PATTERN.sub("#", sentence)
        if kind not in self._kinds and len(self._kinds) >= MAX_KINDS:
            kind, sentence = "", self._rest
        first, count = self._kinds.get(kind, (sentence, 0))
        self._kinds[kind] = (first, count + 1)

    def messages(self) -> list[str]:
        """Return one sentence a kind."""
        return [
            first if count == 1 else f"{first} (and {count - 1} more like it)" for first, count in self._kinds.values()
        ]
