"""Tokens in memory, for tests and for a station that asks nobody."""

from __future__ import annotations

from dataclasses import replace

from teachpath.records import AccessToken


class MemoryTokens:
    """A table of tokens that nothing survives."""

    def __init__(self) -> None:
        self.tokens: dict[str, AccessToken] = {}

    def all(self) -> list[AccessToken]:
        """Return every token."""
        return list(self.tokens.values())

    def put(self, token: AccessToken) -> None:
        """Keep a token, in the place of one of its digest."""
        self.tokens[token.digest] = token

    def note_use(self, used: dict[str, int]) -> None:
        """Note when tokens were used."""
        for digest, used_ns in used.items():
            self.tokens[digest] = replace(self.tokens[digest], used_ns=used_ns)
