"""Names in the body of a request, checked by the one rule (`teachpath_proto.keys`)."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, WithJsonSchema
from pydantic_core import PydanticCustomError

from teachpath_proto.display_names import MAX_LENGTH, checked_display_name
from teachpath_proto.keys import NAME, is_name, name_refusal


def _checked(tracker: str) -> str:
    return _checked_name("tracker", tracker)


def _checked_output(output: str) -> str:
    return _checked_name("tool output", output)


def _checked_name(what: str, name: str) -> str:
    if not is_name(name):
        raise PydanticCustomError("name", "{sentence}", {"sentence": name_refusal(what, name)})
    return name


def _checked_if_given(tracker: str) -> str:
    return tracker and _checked(tracker)


def _checked_display_name(text: str) -> str:
    try:
        return checked_display_name(text)
    except ValueError as error:
        raise PydanticCustomError("name", "{sentence}", {"sentence": str(error)}) from None


TrackerName = Annotated[
    str, AfterValidator(_checked), WithJsonSchema({"type": "string", "pattern": f"^{NAME.pattern}$"})
]
OutputName = Annotated[
    str, AfterValidator(_checked_output), WithJsonSchema({"type": "string", "pattern": f"^{NAME.pattern}$"})
]
TrackerNameOrEmpty = Annotated[
    str, AfterValidator(_checked_if_given), WithJsonSchema({"type": "string", "pattern": f"^({NAME.pattern})?$"})
]
DisplayName = Annotated[
    str, AfterValidator(_checked_display_name), WithJsonSchema({"type": "string", "maxLength": MAX_LENGTH})
]
