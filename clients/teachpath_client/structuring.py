"""JSON documents as records: the fields of a dataclass by their names and types."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

T = TypeVar("T")

_hints = cache(get_type_hints)


def structured(kind: Callable[..., T], document: Any) -> T:
    """Return a JSON document as a record of `kind`, or e.g. of `list[Plan]`.

    A field that the record does not have is left out: a newer station may say more.

    Raises:
        ValueError: a field is missing.
    """
    made: T = _structured(kind, document)
    return made


def _structured(kind: Any, value: Any) -> Any:
    if is_dataclass(kind):
        return _record(kind, value)
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        return None if value is None else _structured(next(a for a in arguments if a is not NoneType), value)
    if origin is list:
        return (
            [float(each) for each in value] if arguments == (float,) else [_structured(arguments[0], v) for v in value]
        )
    if origin is tuple:
        return tuple(_structured(each, v) for each, v in zip(arguments, value, strict=True))
    if origin is dict:
        return {key: _structured(arguments[1], each) for key, each in value.items()}
    return float(value) if kind is float else value


def _record(kind: Any, document: dict[str, Any]) -> Any:
    values = {}
    for field in fields(kind):
        if field.name in document:
            values[field.name] = _structured(_hints(kind)[field.name], document[field.name])
        elif field.default is MISSING and field.default_factory is MISSING:
            raise ValueError(f"a {kind.__name__} has no {field.name}")
    return kind(**values)
