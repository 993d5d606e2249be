"""deploy/teachpath.toml as it follows from the settings' source: `python -m tests.contract.settings_file` writes it."""

import ast
import inspect
import json
import sys
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, get_args, get_type_hints

from annotated_types import Ge, Gt, Le, Len, Lt

from teachpath.api.answers import meanings
from teachpath.config import Settings
from teachpath.records import Calibration, Scene, Shape

FILE = Path(__file__).parents[2] / "deploy" / "teachpath.toml"
HEADER = """\
# The settings of a teachpath station, every one at its default: a file with only the changed ones does as well.
#
# Read from --config FILE, else from the file that TEACHPATH_CONFIG names, else from ./teachpath.toml. A variable
# named after room and setting wins over the file, TEACHPATH_WEB__PORT=9000, and the command line over both.
# Lengths are in metres, angles in radians, times in seconds. A setting that begins with `#` has no value by default.
"""
SECTION_NOTES = {
    "calibrations": "# rotation: unit quaternion w, x, y, z; offset [m]; scale 0.0254 is for a device in inches",
    "scenes": """\
# Positions are of centres [m], sizes of a box x, y, z, of a cylinder radius, height, of a sphere its radius; a shape
# is turned by its `orientation` (quaternion w, x, y, z). A `mesh` has a `file` beside this one (.obj, .stl, with
# teachpath[meshes] .ply and .glb, too), and as size the factor from its units to metres. Its convex hull takes its
# place, or up to `max_pieces` convex pieces, which leave the inside of a bin free. The object may have a `mass` [kg];
# left out, it is that of its volume at 300 kg/m^3.
# `floor`: its height. Arm, gripper and carried object stay above it, inside every box of [[scenes.keep_in]] and out of
# every shape of [[scenes.keep_out]]""",
}
RARE_FIELDS = ("orientation", "file", "vertices", "mass", "max_pieces", "pieces")  # of a shape, not shown
# A setting without a default shows one that it could have.
EXAMPLES = {
    "motion.arm": "light",
    "motion.gripper": "suction",
    "motion.tool_position": (0.05, 0.0, 0.18),
    "motion.tool_orientation": (0.9659258, 0.0, 0.258819, 0.0),
    "motion.tool_speed": 0.25,
    "learning.threshold": 0.06,
    "learning.clusters": 3,
    "learning.degree": 3,
}
WORDS = {Ge: ("ge", "at least"), Gt: ("gt", "over"), Le: ("le", "at most"), Lt: ("lt", "under")}


def text() -> str:
    """Return the whole file."""
    default = Settings()
    pieces = [HEADER]
    for room in Settings.model_fields:
        value = getattr(default, room)
        pieces.append("\n".join(_room(room, value) if is_dataclass(value) else _tables(room, value)))
    return "\n".join(pieces)


def _room(room: str, value: Any) -> Iterator[str]:
    yield f"# {summary(type(value))}"
    yield f"[{room}]"
    hints = get_type_hints(type(value), include_extras=True)
    for name, comment in comments(type(value)).items():
        default, limits = getattr(value, name), ", ".join(_limits(hints[name]))
        yield f"# {comment.replace('None', 'left out')}" + (f"; {limits}" if limits else "")
        shown = EXAMPLES[f"{room}.{name}"] if default is None else default
        yield f"{'# ' if default is None else ''}{name} = {_toml(shown)}"
    yield ""


def _tables(room: str, values: tuple[Calibration | Scene, ...]) -> Iterator[str]:
    yield f"# {summary(type(values[0]))}".replace("or None", "or left out")
    yield SECTION_NOTES[room]
    for value in values:
        yield f"[[{room}]]"
        tables = {}
        for field in fields(value):
            inner = getattr(value, field.name)
            shapes = [s for s in (inner if isinstance(inner, tuple) else (inner,)) if isinstance(s, Shape)]
            if shapes:
                tables[field.name] = shapes
            elif inner not in (None, ()):
                yield f"{field.name} = {_toml(inner)}"
        for name, shapes in tables.items():
            mark = f"[[{room}.{name}]]" if isinstance(getattr(value, name), tuple) else f"[{room}.{name}]"
            for shape in shapes:
                yield mark
                shown = [f.name for f in fields(shape) if f.name not in RARE_FIELDS]
                yield from (f"{name} = {_toml(getattr(shape, name), name)}" for name in shown)
        yield ""


def summary(kind: type) -> str:
    """Return the first sentence of a class's docstring."""
    return " ".join((inspect.getdoc(kind) or "").split("\n\n")[0].split())


def comments(kind: type) -> dict[str, str]:
    """Return what the docstring of a settings class, or the comment above each field, says of it."""
    if described := meanings(kind):
        return {name: text.removesuffix(".") for name, text in described.items()}
    source = inspect.getsource(kind).splitlines()
    (body,) = ast.parse(inspect.cleandoc("\n".join(source))).body
    assert isinstance(body, ast.ClassDef)
    found = {}
    for node in body.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            above: list[str] = []
            for line in reversed(source[: node.lineno - 1]):
                if not line.strip().startswith("#"):
                    break
                above.insert(0, line.strip().lstrip("# "))
            found[node.target.id] = " ".join(above)
    return found


def _limits(hint: Any) -> Iterator[str]:
    for option in (hint, *get_args(hint)):
        for limit in getattr(option, "__metadata__", ()):
            if isinstance(limit, Len):
                yield f"{limit.min_length} of them" + ("" if limit.min_length == limit.max_length else " or more")
            else:
                field, words = WORDS[type(limit)]
                yield f"{words} {getattr(limit, field):g}"


def _toml(value: Any, name: str = "") -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_toml(v) for v in value)}]"
    return f"0x{value:06X}" if name == "color" else json.dumps(value)


if __name__ == "__main__":
    FILE.write_text(text())
    sys.stdout.write(f"{FILE} written\n")
