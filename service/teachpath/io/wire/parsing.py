"""Bytes to a protobuf message, or a sentence why not."""

from __future__ import annotations

from typing import TypeVar

from google.protobuf.message import DecodeError, Message

from teachpath.errors import UnusableInput

M = TypeVar("M", bound=Message)


def parse(kind: type[M], payload: bytes) -> M:
    """Parse a protobuf message of `kind`.

    Raises:
        UnusableInput: the payload is not such a message.
    """
    try:
        return kind.FromString(payload)
    except DecodeError as error:
        raise UnusableInput(f"{len(payload)} bytes are not a {kind.DESCRIPTOR.name}: {error}") from None
