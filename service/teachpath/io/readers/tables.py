"""Text tables with a row a reading: CSV with a header, or with columns named by the user; TUM and EuRoC."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.columns import POSITION, ROTATION, ColumnMap, map_columns, parse_columns
from teachpath.io.readers.contract import UNITS, FileMotions, Integers, OptionNeeded, Reader, ReadOptions, Track
from teachpath.io.readers.joint_columns import joint_places, read_joint_rows
from teachpath.io.readers.text import cells_of, delimiter_of, is_comment, is_number, numbered_lines, table
from teachpath.io.readers.time_units import stamps_of, time_unit
from teachpath.records import Array

Rows = list[tuple[int, list[str]]]


def read_table(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read a table whose columns have names, or are named by the options."""
    rows, header, delimiter = _split(content, name, limits)
    if places := joint_places(header, options):
        return read_joint_rows(rows, header, delimiter, name, options, places)
    return read_rows(rows, header, delimiter, name, options)


def table_columns(content: bytes, name: str, limits: ImportSettings) -> tuple[str, ...]:
    """Return what the columns of a table are called; those without a name by their numbers from 1.

    Raises:
        UnusableRecording: the file is no table.
    """
    _, header, _ = _split(content, name, limits)
    return tuple(cell or str(number) for number, cell in enumerate(header, 1))


def _split(content: bytes, name: str, limits: ImportSettings) -> tuple[Rows, list[str], str]:
    """Return the rows of a table, its header, and what separates its cells."""
    lines = numbered_lines(content, name, limits)
    data = [(number, line) for number, line in lines if not is_comment(line)]
    if not data:
        raise UnusableRecording(f"{name}: there are no samples in it")
    delimiter = delimiter_of(data[0][1])
    try:
        rows = [(number, cells_of(line, delimiter)) for number, line in data]
        comments = [cells_of(line.lstrip("#%/ "), delimiter) for _, line in lines if is_comment(line)]
    except csv.Error as error:
        raise UnusableRecording(f"{name}: not a CSV text file: {error}") from None
    header = _header(rows, comments, delimiter)  # which takes it off the rows
    return rows, header, delimiter


def _header(rows: Rows, comments: Sequence[list[str]], delimiter: str) -> list[str]:
    """Take the header off the rows and return it, or that in a comment, or names that are empty."""
    if not all(is_number(cell, delimiter) for cell in rows[0][1]):
        return rows.pop(0)[1]
    width = len(rows[0][1])
    return next((cells for cells in reversed(comments) if len(cells) == width), [""] * width)


def read_rows(
    rows: Rows, header: list[str], delimiter: str, name: str, options: ReadOptions, *, units: str = ""
) -> FileMotions:
    """Read the rows of a table.

    Args:
        rows: each with the number of its line.
        header: names of the columns.
        units: of the positions, as the file says them elsewhere.
    """
    while header and not header[-1] and len(header) > 1 and not any(any(row[len(header) - 1 :]) for _, row in rows):
        header = header[:-1]  # a delimiter behind the last column
    columns = map_columns(header, parse_columns(options.columns), name)
    if not rows:
        raise UnusableRecording(f"{name}: there are no samples under the header")
    places = columns.places
    wanted = [places["t"], *(places[axis] for axis in POSITION)]
    wanted += [places[axis] for axis in ROTATION] if columns.has_rotation else []
    others = [role for role in ("number", "tracked", "grasp", "flexion") if role in places]
    values = table(rows, [*wanted, *(places[role] for role in others), *columns.flexions], len(header), name, delimiter)
    unit = time_unit(values[:, 0], said=options.time_unit, stated=_time_unit_of(columns), name=name)
    length = options.units or _length_unit_of(columns) or units or "m"
    if not np.isfinite(values[:, 0]).all():
        line = rows[int(np.argmin(np.isfinite(values[:, 0])))][0]
        raise UnusableRecording(f"{name}, line {line}: a row without a time; take it out")
    extra = {role: values[:, len(wanted) + k] for k, role in enumerate(others)}
    track = Track(
        stamps_of([row[places["t"]] for _, row in rows], values[:, 0], unit, delimiter, name),
        values[:, 1:4] * UNITS[length],
        values[:, 4:8] if columns.has_rotation else None,
        extra["tracked"] > 0.5 if "tracked" in extra else None,
        _whole_numbers(extra["number"], name) if "number" in extra else None,
        extra.get("grasp", extra.get("flexion")),
        values[:, len(wanted) + len(others) :] if columns.flexions else None,
    )
    return FileMotions([track], _understood(columns, header, unit, length))


def _time_unit_of(columns: ColumnMap) -> str:
    return columns.unit_names.get("t", "")


def _length_unit_of(columns: ColumnMap) -> str:
    stated = columns.unit_names.get("x", "")
    return stated if stated in UNITS else ""


def _whole_numbers(values: Array, name: str) -> Integers:
    if not np.all((values >= 0) & (values < 2**53)) or np.any(values % 1.0):
        raise OptionNeeded(f"{name}: its numbers of readings are not all whole", "columns", "number=...")
    return values.astype(np.int64)


def _understood(columns: ColumnMap, header: Sequence[str], unit: str, length: str) -> tuple[str, ...]:
    called = {role: header[k] or f"column {k + 1}" for role, k in columns.places.items()}
    found = [
        f"time in {unit} ({called['t']})",
        f"position in {length} ({', '.join(called[axis] for axis in POSITION)})",
        f"quaternion w, x, y, z = {', '.join(called[axis] for axis in ROTATION)}"
        if columns.has_rotation
        else "no orientation",
    ]
    found += [f"{role} from {called[role]}" for role in ("number", "tracked", "grasp", "flexion") if role in called]
    if columns.flexions:
        found.append(f"{len(columns.flexions)} flexions")
    if columns.unused:
        found.append(f"not read: {', '.join(columns.unused[:8])}{', ...' if len(columns.unused) > 8 else ''}")
    return tuple(found)


def _preset(columns: str, unit: str) -> Callable[[bytes, str, ReadOptions, ImportSettings], FileMotions]:
    """Return a function that reads tables whose columns have fixed places."""

    def read(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
        filled = replace(options, columns=options.columns or columns, time_unit=options.time_unit or unit)
        return read_table(content, name, filled, limits)

    return read


def _begins(content: bytes, *words: bytes) -> bool:
    """Tell whether the first line is a comment that has all words."""
    first = content[:500].lower().partition(b"\n")[0]
    return first.startswith(b"#") and all(word in first for word in words)


TABLE = Reader("csv", "table with named columns", read_table)
TUM = Reader(
    "tum",
    "TUM trajectory: t x y z qx qy qz qw",
    _preset("t=1,x=2,y=3,z=4,qx=5,qy=6,qz=7,qw=8", "s"),
    lambda content, name: name.endswith(".tum") or _begins(content, b"timestamp tx ty tz qx qy qz qw"),
)
EUROC = Reader(
    "euroc",
    "EuRoC ground truth: t [ns], x, y, z, qw, qx, qy, qz, ...",
    _preset("t=1,x=2,y=3,z=4,qw=5,qx=6,qy=7,qz=8", "ns"),
    lambda content, name: _begins(content, b"timestamp", b"p_rs_r_x", b"q_rs_w"),
)
ARKIT = Reader(
    "arkit",
    "poses of ARKit: t, x, y, z, qw, qx, qy, qz",
    _preset("t=1,x=2,y=3,z=4,qw=5,qx=6,qy=7,qz=8", "s"),
    lambda content, name: name.endswith("arposes.txt"),
)
