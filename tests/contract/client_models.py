"""The client's models, generated from the description of the REST API (`python -m tests.contract.openapi`)."""

import re
import textwrap
from pathlib import Path
from typing import Any

FILE = Path(__file__).parents[2] / "clients" / "teachpath_client" / "models.py"
WIDTH = 112  # of the text in a docstring
MAX_LINE = 120  # characters of a line, its end not counted
HEAD = '''"""What a station answers: frozen records with the names and types of the REST API.

Generated from its description by `python -m tests.contract.openapi`; do not edit. Metres, radians, seconds; quaternions
w, x, y, z; times that end in `_ns` are nanoseconds since the Unix epoch.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal
'''
SCALARS = {"string": "str", "integer": "int", "number": "float", "boolean": "bool", "null": "None"}


def text(description: dict[str, Any]) -> str:
    """Return the module with the models of everything that is answered."""
    schemas = description["components"]["schemas"]
    answered = sorted(_answered(description))
    aliases = [_alias(name, schemas[name]) for name in answered if "enum" in schemas[name]]
    classes = [_class(name, schemas[name]) for name in answered if "enum" not in schemas[name]]
    return "\n".join([HEAD, *aliases]) + "".join(f"\n\n{each}" for each in classes)


def _answered(description: dict[str, Any]) -> set[str]:
    """Return the names of the schemas that an answer may hold."""
    operations = [operation for methods in description["paths"].values() for operation in methods.values()]
    found, waiting = set[str](), _references([operation["responses"] for operation in operations])
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting |= _references(description["components"]["schemas"][name])
    return found


def _references(value: Any) -> set[str]:
    return set(re.findall(r"'#/components/schemas/(\w+)'", repr(value)))


def _alias(name: str, schema: dict[str, Any]) -> str:
    words = [f'"{word}"' for word in schema["enum"]]
    line = f"{name} = Literal[{', '.join(words)}]"
    if len(line) > MAX_LINE:
        line = "\n".join([f"{name} = Literal[", *(f"    {word}," for word in words), "]"])
    return f"{line}\n"


def _class(name: str, schema: dict[str, Any]) -> str:
    required = schema.get("required", [])
    lines = [
        f"    {field}: {_type(kind)}" + ("" if field in required else f" = {_default(kind)}")
        for field, kind in schema["properties"].items()
    ]
    return "\n".join(["@dataclass(frozen=True)", f"class {name}:", _docstring(schema), "", *lines, ""])


def _default(kind: dict[str, Any]) -> str:
    default = kind.get("default")
    if isinstance(default, list):
        return "field(default_factory=list)" if not default else f"({', '.join(map(repr, default))})"
    return f'"{default}"' if isinstance(default, str) else repr(default)


def _docstring(schema: dict[str, Any]) -> str:
    described = {field: kind["description"] for field, kind in schema["properties"].items() if "description" in kind}
    first, _, rest = schema["description"].partition("\n")
    parts = [textwrap.indent("\n".join([first, rest.rstrip()]).rstrip(), "    ", lambda line: bool(line.strip()))]
    if described:
        parts.append("\n    Attributes:")
        parts += [_wrapped(f"{field}: {meaning}") for field, meaning in described.items()]
    inner = "\n".join(parts).lstrip()
    return f'    """{inner}\n    """' if "\n" in inner else f'    """{inner}"""'


def _wrapped(line: str) -> str:
    return textwrap.fill(line, WIDTH, initial_indent=" " * 8, subsequent_indent=" " * 12)


def _type(kind: dict[str, Any]) -> str:
    if "$ref" in kind:
        return str(kind["$ref"].rsplit("/", 1)[1])
    if "anyOf" in kind:
        return " | ".join(_type(each) for each in kind["anyOf"])
    if "prefixItems" in kind:
        return f"tuple[{', '.join(_type(each) for each in kind['prefixItems'])}]"
    if kind.get("type") == "array":
        return f"list[{_type(kind['items'])}]"
    if kind.get("type") == "object":
        values = kind.get("additionalProperties", True)
        return f"dict[str, {_type(values) if isinstance(values, dict) else 'Any'}]"
    return SCALARS[kind["type"]] if "type" in kind else "Any"
