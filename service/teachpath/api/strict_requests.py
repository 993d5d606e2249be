"""Strict requests: what an operation does not know is refused by name, never dropped without a word."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, ClassVar, Final, get_args

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ConfigDict, Strict

from teachpath.errors import NotFound, UnusableInput
from teachpath.records import Capability

EXTRA_FIELD: Final = "extra_forbidden"  # pydantic's name of this fault
EMPTY_BODIES: Final = (b"", b"{}", b"null")  # bodies that say nothing
MAX_SHOWN_LENGTH: Final = 80  # characters of an unknown name


class Body(BaseModel):
    """A request body; a field that it does not have is refused, and so is true or "1" where a number is wanted.

    What JSON writes otherwise than Python (a tuple as a list, an enumeration as a word) says `Strict(False)`; what is
    within it is strict all the same.
    """

    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", strict=True)


Roles = list[Annotated[Capability, Strict(False)]]


@contextmanager
def named_in_body(field: str) -> Iterator[None]:
    """Refuse a request as unusable whose body names in `field` what is not there: only the address answers 404.

    Raises:
        UnusableInput: instead of NotFound.
    """
    try:
        yield
    except NotFound as error:
        raise UnusableInput(f"body.{field}: {error}") from None


async def refuse_unknown(request: Request) -> None:
    """Refuse the query parameters that an operation does not have, and a body where it takes none.

    Raises:
        RequestValidationError: names every one of them.
    """
    route = request.scope["route"]
    known = _parameters(request)
    faults = [
        {"loc": ("query", name), "type": EXTRA_FIELD, "msg": ""} for name in request.query_params if name not in known
    ]
    takes_a_body = route.body_field is not None or "requestBody" in (route.openapi_extra or {})
    if not takes_a_body and (await request.body()).strip() not in EMPTY_BODIES:
        faults.append({"loc": ("body",), "type": EXTRA_FIELD, "msg": ""})
    if faults:
        raise RequestValidationError(faults)


def unknown_field(request: Request, place: Sequence[str | int]) -> str:
    """Say what a request holds at `place` that is not known there, and what is known, e.g. `("body", "overide")`."""
    if place == ("body",):
        return f"{request.method} {request.url.path} takes none; send it without"
    if place[0] == "query":
        return unknown_name("parameter", str(place[-1]), _parameters(request))
    return unknown_name("field", str(place[-1]), _fields(request, place[1:-1]))


def unknown_name(kind: str, name: str, known: Collection[str]) -> str:
    """Say that there is no `kind` of this name, which known name is nearest, and which names are known."""
    name = name[:MAX_SHOWN_LENGTH]
    near = difflib.get_close_matches(name, known, 1)
    meant = f"did you mean {near[0]}? " if near else ""
    return f"there is no {kind} {name!r}; {meant}known here: {', '.join(known) or 'none'}"


def _parameters(request: Request) -> list[str]:
    dependant = request.scope["route"].dependant
    return [field.alias for each in (dependant, *dependant.dependencies) for field in each.query_params]


def _fields(request: Request, place: Sequence[str | int]) -> list[str]:
    """Return the fields that the body has at a place within it, e.g. `("points", 0)`."""
    kind = request.scope["route"].body_field.field_info.annotation
    for piece in place:
        if isinstance(piece, str):
            kind = _model(kind).model_fields[piece].annotation
    return list(_model(kind).model_fields)


def _model(kind: Any) -> type[BaseModel]:
    """Return the model in a type such as `list[Model]` or `Model | None`; `Body` when there is none."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return kind
    return next((found for inner in get_args(kind) if (found := _model(inner)) is not Body), Body)
