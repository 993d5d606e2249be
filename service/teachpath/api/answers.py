"""Answers: the models that describe them, generated from the frozen records, and records sent as JSON."""

from __future__ import annotations

import inspect
import re
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from functools import cache, reduce
from operator import or_
from types import UnionType
from typing import Any, Final, Union, get_args, get_origin, get_type_hints

import numpy as np
from fastapi import Response
from pydantic import BaseModel, Field, create_model

from teachpath.io.documents import encode

MCAP: Final = "application/octet-stream"  # it has no registered media type
Responses = dict[int | str, dict[str, Any]]
FIELD = re.compile(r"^ {4}(\w+): (.+(?:\n {8}.+)*)", re.MULTILINE)  # of the section Attributes of a docstring


def files(*media_types: str) -> Responses:
    """Return what a route declares whose answer is a file of one of some media types."""
    content = {media: {"schema": {"type": "string", "format": "binary"}} for media in media_types}
    return {200: {"content": content, "description": "The file."}}


def located(status: int, what: str) -> Responses:
    """Return what a route declares whose answer has the header Location, with the address of `what`."""
    header = {"description": f"address of {what}", "required": True, "schema": {"type": "string"}}
    return {status: {"headers": {"Location": header}}}


def json_response(record: object, *, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    """Return a record, or a list of them, as an answer; its route has `response_model=model_of(...)`.

    The answer is not validated: tests check that every answer has the form of its model.
    """
    return Response(encode(record), status, headers, media_type="application/json")


@cache
def model_of(kind: Any) -> Any:
    """Return the model that describes records of a kind in JSON; `kind` may also be e.g. `list[Plan]`.

    Records without arrays describe themselves; in others, arrays become lists of numbers or of rows.
    """
    if get_origin(kind) is np.ndarray:
        return list[list[float]] if get_args(get_args(kind)[0]) == (int, int) else list[float]
    if is_dataclass(kind) and isinstance(kind, type):
        return _model(kind) if _holds_arrays(kind) else kind
    arguments = get_args(kind)
    if not arguments or not _holds_arrays(kind):
        return kind
    described = tuple(each if each is ... else model_of(each) for each in arguments)
    return reduce(or_, described) if get_origin(kind) in (Union, UnionType) else get_origin(kind)[described]


def _model(record: type) -> type[BaseModel]:
    kinds, texts = get_type_hints(record), meanings(record)
    described: dict[str, Any] = {
        field.name: (model_of(kinds[field.name]), Field(description=texts.get(field.name))) for field in fields(record)
    }
    return create_model(record.__name__, __doc__=opening(record), **described)


def meanings(record: type) -> dict[str, str]:
    """Return what the docstring of a record says of each of its fields."""
    section = inspect.cleandoc(record.__doc__ or "").partition("Attributes:")[2]
    return {name: " ".join(meaning.split()) for name, meaning in FIELD.findall(section)}


def opening(record: type) -> str:
    """Return what the docstring of a record says before its fields."""
    return inspect.cleandoc(record.__doc__ or "").partition("Attributes:")[0].strip()


def _holds_arrays(kind: Any) -> bool:
    if get_origin(kind) is np.ndarray:
        return True
    inner: Sequence[Any] = get_args(kind)
    if is_dataclass(kind) and isinstance(kind, type):
        inner = list(get_type_hints(kind).values())
    return any(_holds_arrays(each) for each in inner)
