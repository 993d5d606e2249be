"""Schemas of records in JSON, with what their docstrings say of each field."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from typing import Any, Final, get_args, get_type_hints

from pydantic import BaseModel, TypeAdapter

from teachpath.api.answers import meanings, opening

REFERENCE: Final = "#/components/schemas/{model}"
NEEDS_64_BITS: Final = re.compile(r"(_ns|^size)$")
Schema = dict[str, Any]


def records_in(kinds: Iterable[Any]) -> dict[str, type]:
    """Return the records in some types by their names, those within others too."""
    found = set[type]()
    for kind in kinds:
        _collect(kind, found)
    return {record.__name__: record for record in found}


def schemas_of(kinds: Iterable[Any]) -> dict[str, Schema]:
    """Return the schemas of records by their names, described."""
    known = list(kinds)
    inputs = [(kind.__name__, "serialization", TypeAdapter(kind)) for kind in known]
    _, document = TypeAdapter.json_schemas(inputs, ref_template=REFERENCE)  # type: ignore[arg-type]
    schemas: dict[str, Schema] = document["$defs"]
    describe(schemas, records_in(known))
    return schemas


def describe(schemas: dict[str, Schema], records: dict[str, type]) -> None:
    """Add to schemas what the docstrings of their records say, and the size of large numbers."""
    for name, schema in schemas.items():
        record = records.get(name)
        texts = meanings(record) if record else {}
        if record:
            schema["description"] = opening(record)
        for field, kind in schema.get("properties", {}).items():
            if field in texts:
                kind.setdefault("description", texts[field])
            for each in _integers(kind):
                if NEEDS_64_BITS.search(field):
                    each["format"] = "int64"


def _collect(kind: Any, found: set[type]) -> None:
    if kind in found or kind is None:
        return
    inner: Iterable[Any] = get_args(kind)
    if isinstance(kind, type) and is_dataclass(kind):
        found.add(kind)
        hints = get_type_hints(kind)
        inner = [hints[field.name] for field in fields(kind)]
    elif isinstance(kind, type) and issubclass(kind, BaseModel):
        inner = [field.annotation for field in kind.model_fields.values()]
    for each in inner:
        _collect(each, found)


def _integers(kind: Schema) -> Iterator[Schema]:
    if kind.get("type") == "integer":
        yield kind
    for each in kind.get("anyOf", []):
        yield from _integers(each)
