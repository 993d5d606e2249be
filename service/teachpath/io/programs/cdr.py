"""Writes messages in CDR, the little-endian binary form in which ROS 2 sends and stores them.

OMG: Common Data Representation (XCDR 1), in DDS-XTypes: every number lies at a multiple of its own size, counted
from behind the four bytes that name the encoding.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Final

from teachpath.records import Array

LITTLE_ENDIAN: Final = b"\x00\x01\x00\x00"  # the encoding, and no options


class CdrWriter:
    """Appends values to a message; `content` is the whole of it."""

    def __init__(self) -> None:
        self._body = bytearray()

    @property
    def content(self) -> bytes:
        """The message so far."""
        return LITTLE_ENDIAN + bytes(self._body)

    def int32(self, value: int) -> None:
        """Append a signed number of 4 bytes."""
        self._append("<i", 4, value)

    def uint32(self, value: int) -> None:
        """Append a number of 4 bytes."""
        self._append("<I", 4, value)

    def string(self, text: str) -> None:
        """Append a text."""
        encoded = text.encode() + b"\x00"
        self.uint32(len(encoded))
        self._body += encoded

    def strings(self, texts: Sequence[str]) -> None:
        """Append a sequence of texts."""
        self.uint32(len(texts))
        for text in texts:
            self.string(text)

    def doubles(self, values: Array | Sequence[float]) -> None:
        """Append a sequence of numbers of 8 bytes."""
        self.uint32(len(values))
        if len(values):
            self._align(8)
            self._body += struct.pack(f"<{len(values)}d", *values)

    def _append(self, form: str, size: int, value: int) -> None:
        self._align(size)
        self._body += struct.pack(form, value)

    def _align(self, size: int) -> None:
        self._body += bytes(-len(self._body) % size)
