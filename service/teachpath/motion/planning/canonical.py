"""The canonical encoding of records, over which digests and signatures are computed."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import fields, is_dataclass

import numpy as np

from teachpath.records.later_fields import enters_digest


def canonical(value: object) -> bytes:
    """Encode a value so that different values never have the same bytes.

    Every part states its kind and its length. A tuple and a list are the same, so are a number and the same number as
    a float: a record that was sent as JSON has the bytes it had before. A field that a record was given later is left
    out at its default (`later_fields`).

    Args:
        value: a frozen record, array, mapping, sequence, text, number, truth value or None.

    Raises:
        TypeError: it is nothing of these.
    """
    if value is None:
        return b"n"
    if isinstance(value, bool):
        return b"t" if value else b"f"
    if isinstance(value, str):
        return _tagged(b"s", value.encode())
    if isinstance(value, int | float):
        return _number(value)
    if isinstance(value, np.ndarray):
        rows = np.ascontiguousarray(value, dtype="<f8")
        return _tagged(b"a", repr(rows.shape).encode()) + rows.tobytes()
    if isinstance(value, Mapping):
        items = [canonical(key) + canonical(value[key]) for key in sorted(value)]
    elif isinstance(value, list | tuple):
        items = [canonical(item) for item in value]
    elif is_dataclass(value):
        items = [
            canonical(field.name) + canonical(entry)
            for field in fields(value)
            if enters_digest(field, entry := getattr(value, field.name))
        ]
    else:
        raise TypeError(f"{type(value).__name__} has no canonical encoding")
    kind = b"l" if isinstance(value, list | tuple) else b"d"
    return _tagged(kind, b"".join(items), len(items))


def _number(value: float) -> bytes:
    """Encode a number by its eight bytes as a float, an integer that no float equals by its digits."""
    if isinstance(value, float) or abs(value) <= 2**53:
        return b"r" + struct.pack("<d", value)
    return _tagged(b"i", str(value).encode())


def _tagged(kind: bytes, content: bytes, count: int | None = None) -> bytes:
    return kind + struct.pack("<q", len(content) if count is None else count) + content
