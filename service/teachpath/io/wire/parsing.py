"""Bytes to a protobuf message, or a sentence why not."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, TypeVar

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import DecodeError, Message

from teachpath.errors import UnusableInput

M = TypeVar("M", bound=Message)
FLOATS = (FieldDescriptor.CPPTYPE_DOUBLE, FieldDescriptor.CPPTYPE_FLOAT)


def parse(kind: type[M], payload: bytes) -> M:
    """Parse a protobuf message of `kind`.

    Args:
        kind: of the message.
        payload: its bytes.

    Raises:
        UnusableInput: the payload is not such a message, or a number in it is not finite.
    """
    try:
        message = kind.FromString(payload)
    except DecodeError as error:
        raise UnusableInput(f"{len(payload)} bytes are not a {kind.DESCRIPTOR.name}: {error}") from None
    _require_finite(message, kind.DESCRIPTOR.name)
    return message


def _require_finite(message: Message, place: str) -> None:
    for field, value in message.ListFields():
        where = f"{place}: {field.name}"
        values: Iterable[Any] = [value] if isinstance(value, float | Message) else value
        if field.cpp_type in FLOATS:
            for number in values:
                if not math.isfinite(number):
                    raise UnusableInput(f"{where} should be finite, got {number}")
        elif field.cpp_type == FieldDescriptor.CPPTYPE_MESSAGE:
            for each in values:
                _require_finite(each, where)
