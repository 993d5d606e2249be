"""Counts messages by kind, so that a thousand bad samples of one kind are one message and hide no other kind."""

from __future__ import annotations

import re

MAX_KINDS = 20  # further kinds are counted as one
NUMBER_PATTERN = re.compile(r"[-+]?(\d[\w.+-]*|nan|inf)\b")


class MessageCounter:
    """Counts messages; those that differ in their numbers only are of one kind.

    Args:
        rest: the message for all kinds beyond the first `MAX_KINDS`.
    """

    def __init__(self, rest: str) -> None:
        self._rest = rest
        self._kinds: dict[str, tuple[str, int]] = {}  # the first message of each kind, and their number

    def add(self, sentence: str) -> None:
        """Count one message."""
        kind = NUMBER_PATTERN.sub("#", sentence)
        if kind not in self._kinds and len(self._kinds) >= MAX_KINDS:
            kind, sentence = "", self._rest
        first, count = self._kinds.get(kind, (sentence, 0))
        self._kinds[kind] = (first, count + 1)

    def messages(self) -> list[str]:
        """Return one message a kind."""
        return [
            first if count == 1 else f"{first} (and {count - 1} more like it)" for first, count in self._kinds.values()
        ]


class IntervalMessages:
    """Counts messages: all of them, and those of the current interval.

    Args:
        rest: as of `MessageCounter`.
    """

    def __init__(self, rest: str) -> None:
        self._rest = rest
        self.all: MessageCounter = MessageCounter(rest)
        self.interval: MessageCounter = MessageCounter(rest)

    def add(self, sentence: str, *, in_interval: bool = True) -> None:
        """Count one message; with `in_interval` it is of the current interval too."""
        self.all.add(sentence)
        if in_interval:
            self.interval.add(sentence)

    def begin_interval(self) -> None:
        """Begin another interval."""
        self.interval = MessageCounter(self._rest)
