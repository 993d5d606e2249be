"""What was refused, kind by kind: a thousand bad samples of one kind are one sentence, and hide no other kind."""

from __future__ import annotations

import re

KINDS = 20  # that are told apart; the rest are only counted
NUMBER = re.compile(r"[-+]?(\d[\w.+-]*|nan|inf)\b")


class Refusals:
    """Counts reasons that differ in their numbers only as one kind."""

    def __init__(self) -> None:
        self._kinds: dict[str, tuple[str, int]] = {}  # the first reason of each kind, and how many

    def add(self, reason: str) -> None:
        """Count one refusal."""
        kind = NUMBER.sub("#", reason)
        if kind not in self._kinds and len(self._kinds) >= KINDS:
            kind, reason = "", "samples were refused for other reasons"
        first, count = self._kinds.get(kind, (reason, 0))
        self._kinds[kind] = (first, count + 1)

    def sentences(self) -> list[str]:
        """Return one sentence a kind."""
        return [
            first if count == 1 else f"{first} (and {count - 1} more like it)" for first, count in self._kinds.values()
        ]
