"""Records as JSON documents and back: the one form in which runs, paths and plans are stored and sent."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any, Literal, TypeVar, get_args, get_origin

import numpy as np
from cattrs import ClassValidationError, transform_error
from cattrs.preconf.json import make_converter
from cattrs.v import format_exception

from teachpath.errors import UnusableInput
from teachpath.records import Demonstration

T = TypeVar("T")

# What files that were recorded or exported earlier call the fields of a demonstration and of its statistics.
FORMER_NAMES = {"account": "statistics", "jumps": "outliers", "leaps": "level_shifts"}

LONG_EXPONENT = re.compile(rb"[eE]\+?[0-9]{3}")  # of which a number may be too large to be finite

_converter = make_converter(forbid_extra_keys=True)


def _is_array(kind: Any) -> bool:
    return kind is np.ndarray or get_origin(kind) is np.ndarray


_converter.register_structure_hook_func(lambda kind: kind is object, lambda value, _: value)
_converter.register_unstructure_hook_func(_is_array, lambda a: a.tolist())
_converter.register_structure_hook_func(_is_array, lambda v, _: np.asarray(v, dtype=np.float64))


def to_document(record: Any) -> dict[str, Any]:
    """Return the JSON object of a frozen record; arrays become nested lists."""
    document: dict[str, Any] = _converter.unstructure(record)
    return document


def from_document(kind: type[T], document: Mapping[str, Any]) -> T:
    """Return the record of a JSON object.

    Raises:
        UnusableInput: a field is missing, unknown or of the wrong kind; the sentence names it.
    """
    if not isinstance(document, Mapping):
        raise UnusableInput(f"not a {kind.__name__}: a JSON object is needed, got {type(document).__name__}")
    try:
        return _converter.structure(document, kind)
    except ClassValidationError as error:
        raise UnusableInput(
            f"not a {kind.__name__}: {'; '.join(transform_error(error, format_exception=_fault)[:3])}"
        ) from None


def _fault(error: BaseException, kind: type[Any] | None) -> str:
    """Return what is wrong with a field; of one that takes some words alone, which ones."""
    if get_origin(kind) is not Literal:
        return format_exception(error, kind)
    value = str(error).partition(" not in literal")[0]
    return f"{value!r} is none of {', '.join(repr(word) for word in get_args(kind))}"


def encode(record: Any) -> bytes:
    """Return a record as JSON text."""
    return json.dumps(to_document(record), allow_nan=False, separators=(",", ":")).encode()


def decode(kind: type[T], payload: bytes, *, former_names: Mapping[str, str] | None = None) -> T:
    """Return the record of JSON text; raises UnusableInput.

    Args:
        kind: of the record.
        payload: JSON.
        former_names: names of fields, at any depth, that are called otherwise now.
    """
    names = former_names or {}
    try:
        document = json.loads(
            payload,
            object_pairs_hook=lambda pairs: {names.get(key, key): value for key, value in pairs},
            parse_constant=_finite,
            parse_float=_finite if LONG_EXPONENT.search(payload) else None,
        )
    except (ValueError, RecursionError) as error:
        raise UnusableInput(f"{len(payload)} bytes are not a {kind.__name__} in JSON: {error}") from None
    return from_document(kind, document)


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no finite number")
    return value


def decode_demonstration(payload: bytes) -> Demonstration:
    """Return the demonstration that a file states, also under former names; raises UnusableInput."""
    return decode(Demonstration, payload, former_names=FORMER_NAMES)
