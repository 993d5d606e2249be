"""Which column of a table holds what: by the names that programs use, or as the user says."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.readers.contract import OptionNeeded

POSITION, ROTATION = ("x", "y", "z"), ("qw", "qx", "qy", "qz")
FLEXION = re.compile(r"f([1-9]\d?)")
FLEXION_COUNTS = (18, 22)
OPTIONAL_ROLES = ("number", "tracked", "grasp", "flexion")
ROLES = ("t", *POSITION, *ROTATION, *OPTIONAL_ROLES)
UNIT_NAMES = {
    "s": "s", "sec": "s", "seconds": "s", "ms": "ms", "milliseconds": "ms", "us": "us", "µs": "us",
    "microseconds": "us", "ns": "ns", "nanoseconds": "ns",
    "m": "m", "meters": "m", "metres": "m", "cm": "cm", "mm": "mm", "millimeters": "mm", "in": "in", "inches": "in",
}  # fmt: skip
TIME_NAMES = {"t", "time", "times", "timestamp", "stamp", "time_stamp", "elapsed", "seconds", "rostime"}
POSITION_PREFIXES = (
    "",
    "p",
    "t",
    "p_",
    "pos",
    "pos_",
    "position_",
    "position",
    "translation_",
    "p_rs_r_",
    "pose_position_",
)
ROTATION_PREFIXES = (
    "q", "q_", "quat_", "rot_", "rotation_", "orientation_", "quaternion_", "q_rs_", "pose_orientation_",
)  # fmt: skip
OTHER_NAMES = {
    "number": {"n", "number", "frame", "frame#", "frame_number", "sequence", "seq", "sample", "index"},
    "tracked": {"tracked", "valid", "tracking_valid", "is_tracked", "visible"},
    "grasp": {"grasp", "grasped", "closed"},
    "flexion": {"flexion", "closure"},
}


@dataclass(frozen=True)
class ColumnMap:
    """Where a table has what.

    Attributes:
        places: index of the column of each role: t, x, y, z, perhaps qw to qz, number, tracked, grasp or flexion.
        flexions: indices of the columns f1 to f18 or f22.
        unit_names: units that headers name, of roles `t` and `x`.
        unused: headers that stand for nothing here.
    """

    places: Mapping[str, int]
    flexions: tuple[int, ...] = ()
    unit_names: Mapping[str, str] = None  # type: ignore[assignment]
    unused: tuple[str, ...] = ()

    @property
    def has_rotation(self) -> bool:
        """Whether there are orientations."""
        return "qw" in self.places


def parse_columns(text: str) -> dict[str, str]:
    """Return the column of each role that a user has named, e.g. `t=Time,x=Position.X`.

    Raises:
        UnusableInput: it cannot be read so, or a role is unknown or named twice.
    """
    named: dict[str, str] = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        role, mark, column = (piece.strip() for piece in part.partition("="))
        if not mark or not column or role not in ROLES or role in named:
            raise UnusableInput(
                f"columns: {part!r} is none; write role=column, each role once, e.g. t=Time,x=Position.X,y=3; roles: "
                f"{', '.join(ROLES)}"
            )
        named[role] = column
    return named


def map_columns(
    header: Sequence[str], named: Mapping[str, str], name: str, *, required: Sequence[str] = ("t", *POSITION)
) -> ColumnMap:
    """Return which column holds what.

    Args:
        header: names of the columns; empty texts where there are none.
        named: columns of roles, as the user says: their names, or numbers from 1.
        name: of the file, for errors.
        required: roles that there must be a column for.

    Raises:
        OptionNeeded: a column is missing, or two could be meant.
    """
    plain, units = zip(*(_without_unit(cell) for cell in header), strict=True) if header else ((), ())
    places = {role: _place(header, column, role, name) for role, column in named.items()}
    for role in ROLES:
        if role in places:
            continue
        found = [k for k, cell in enumerate(plain) if k not in places.values() and cell in _names(role)]
        if len(found) > 1:
            several = " and ".join(header[k] for k in found)
            raise OptionNeeded(f"{name}: {several} could all be {role}", "columns", f"{role}=...")
        if found:
            places[role] = found[0]
    _require(header, places, name, required)
    flexions = _flexions(plain, name)
    used = {*places.values(), *flexions}
    return ColumnMap(
        places,
        flexions,
        {role: units[places[role]] for role in ("t", "x") if role in places and units[places[role]]},
        tuple(cell for k, cell in enumerate(header) if cell and k not in used),
    )


def _require(header: Sequence[str], places: Mapping[str, int], name: str, required: Sequence[str]) -> None:
    if len(set(places.values())) < len(places):
        raise OptionNeeded(f"{name}: one column has two roles", "columns")
    missing = [role for role in required if role not in places]
    rotation = [role for role in ROTATION if role not in places]
    if 0 < len(rotation) < len(ROTATION):
        missing += rotation
    if missing:
        shown = ", ".join(cell or "''" for cell in header[:12]) + (", ..." if len(header) > 12 else "")
        raise OptionNeeded(
            f"{name}: no column for {', '.join(missing)}; its {len(header)} columns are {shown or 'without names'}",
            "columns",
            "t=1,x=2,y=3,z=4",
        )


def plain_name(cell: str) -> str:
    """Return a header in plain form: small letters, words joined by underscores, without its unit."""
    return _without_unit(cell)[0]


def _without_unit(cell: str) -> tuple[str, str]:
    """Return a header in plain form, and the unit that it names."""
    text = cell.lstrip("# ").lower()
    bracket = re.search(r"[\[(]\s*([a-zµ]*)\s*[\])]", text)
    unit = UNIT_NAMES.get(bracket.group(1), "") if bracket else ""
    plain = re.sub(r"[\s.\-/:]+", "_", re.sub(r"[\[(].*?[\])]", "", text).strip()).strip("_")
    stem, _, suffix = plain.rpartition("_")
    if not unit and suffix in UNIT_NAMES and (stem in TIME_NAMES or stem in _names("x")):
        return stem, UNIT_NAMES[suffix]
    return plain, unit


def _names(role: str) -> set[str]:
    if role == "t":
        return TIME_NAMES
    if role in POSITION:
        return {prefix + role for prefix in POSITION_PREFIXES}
    if role in ROTATION:
        return {prefix + role[1] for prefix in ROTATION_PREFIXES}
    return OTHER_NAMES[role]


def _place(header: Sequence[str], column: str, role: str, name: str) -> int:
    exact = [k for k, cell in enumerate(header) if cell == column]
    if len(exact) == 1:
        return exact[0]
    if not exact and column.isdecimal() and 1 <= int(column) <= len(header):
        return int(column) - 1
    problem = f"{len(exact)} columns are" if exact else "no column is"
    raise OptionNeeded(
        f"{name}: {problem} called {column!r}, which was to be {role}; they are {', '.join(header[:20])}", "columns"
    )


def _flexions(plain: Sequence[str], name: str) -> tuple[int, ...]:
    numbered = {int(match.group(1)): k for k, cell in enumerate(plain) if (match := FLEXION.fullmatch(cell))}
    if not numbered:
        return ()
    if sorted(numbered) != list(range(1, len(numbered) + 1)) or len(numbered) not in FLEXION_COUNTS:
        raise UnusableRecording(f"{name}: the flexions must be f1 to f18 or f1 to f22; there are {len(numbered)}")
    return tuple(numbered[k] for k in sorted(numbered))
