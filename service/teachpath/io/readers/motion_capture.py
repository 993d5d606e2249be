"""Exports of motion capture programs: Motive (CSV), Vicon Nexus and Tracker (CSV), and marker trajectories (TRC)."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import replace

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.columns import UNIT_NAMES
from teachpath.io.readers.contract import UNITS, FileMotions, OptionNeeded, Reader, ReadOptions
from teachpath.io.readers.tables import Rows, read_rows
from teachpath.io.readers.text import cells_of, numbered_lines

MAX_HEADER_LINES = 20
AXES = ("x", "y", "z")


def read_motive(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read the rigid body of a CSV export of Motive; `options.track` chooses among several."""
    rows = _rows(content, name, limits, ",")
    at = next((k for k, (_, row) in enumerate(rows[:MAX_HEADER_LINES]) if row[:1] == ["Frame"]), None)
    if at is None or at < 2:
        raise UnusableRecording(f"{name}: no line that begins with Frame under the header of Motive")
    about = dict(zip(rows[0][1][::2], rows[0][1][1::2], strict=False))
    names = next((row for _, row in rows[1:at] if len(row) > 1 and row[1] == "Name"), [])
    kinds, axes = rows[at - 1][1], rows[at][1]
    bodies: dict[str, dict[str, int]] = {}
    for k in range(2, len(axes)):
        named, kind = (line[k] if k < len(line) else "" for line in (names, kinds))
        role = axes[k].lower() if kind == "Position" else f"q{axes[k].lower()}" if kind == "Rotation" else ""
        if role in (*AXES, "qw", "qx", "qy", "qz"):
            bodies.setdefault(named, {})[role] = k
    whole = {named: places for named, places in bodies.items() if len(places) == 7}  # markers have no rotation
    body, choices = _chosen(whole or bodies, options.track, name)
    unit = UNIT_NAMES.get(about.get("Length Units", "").lower(), "")
    places = {"number": 0, "t": 1} | body
    return replace(_read(rows[at + 1 :], len(axes), places, name, options, unit=unit), choices=choices)


def read_vicon(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read an object or a marker of a CSV export of Vicon.

    Rotations are not read: the file does not say whether its three columns are Euler angles or a rotation vector.
    """
    rows = _rows(content, name, limits, ",")
    at = next((k for k, (_, row) in enumerate(rows[:MAX_HEADER_LINES]) if row[:1] == ["Frame"]), None)
    if at is None or at < 2 or at + 1 >= len(rows):
        raise UnusableRecording(f"{name}: no line that begins with Frame under the header of Vicon")
    rate = _rate(rows[1][1][0], name)
    axes, units, names = rows[at][1], rows[at + 1][1], _spread(rows[at - 1][1])
    bodies: dict[str, dict[str, int]] = {}
    for k, axis in enumerate(axes):
        role = axis.lower().removeprefix("t")
        if k >= 2 and role in AXES:
            bodies.setdefault(names[k] if k < len(names) else "", {})[role] = k
    body, choices = _chosen(bodies, options.track, name)
    places = {"number": 0} | body
    unit = UNIT_NAMES.get(units[places["x"]].lower() if places["x"] < len(units) else "", "")
    timed = [(line, [*row, _time_of(row[0], rate, name, line)]) for line, row in rows[at + 2 :]]
    width = len(axes)
    padded = [(line, [*row[:-1], *[""] * (width + 1 - len(row)), row[-1]]) for line, row in timed]
    found = _read(padded, width + 1, places | {"t": width}, name, options, unit=unit)
    understood = (*found.understood, f"time from frames at {rate:g} Hz", "rotations not read")
    return replace(found, understood=understood, choices=choices)


def read_trc(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read a marker of a TRC file; `options.track` chooses among several."""
    rows = _rows(content, name, limits, "\t")
    if len(rows) < 5:
        raise UnusableRecording(f"{name}: a TRC file has five lines above its samples; it has {len(rows)} in all")
    about = dict(zip(rows[1][1], rows[2][1], strict=False))
    markers = [marker for marker in rows[3][1][2:] if marker]
    bodies = {marker: {axis: 2 + 3 * k + j for j, axis in enumerate(AXES)} for k, marker in enumerate(markers)}
    body, choices = _chosen(bodies, options.track, name)
    unit = UNIT_NAMES.get(about.get("Units", "").lower(), "")
    width, places = 2 + 3 * len(markers), {"number": 0, "t": 1} | body
    samples = [(line, row[:width] + [""] * (width - len(row))) for line, row in rows[4:] if row[0].isdecimal()]
    return replace(_read(samples, width, places, name, options, unit=unit), choices=choices)


def _read(rows: Rows, width: int, places: dict[str, int], name: str, options: ReadOptions, *, unit: str) -> FileMotions:
    columns = options.columns or ",".join(f"{role}={k + 1}" for role, k in places.items())
    filled = replace(options, columns=columns, time_unit=options.time_unit or "s")
    return read_rows(rows, [""] * width, ",", name, filled, units=unit if unit in UNITS else "")


def _rows(content: bytes, name: str, limits: ImportSettings, delimiter: str) -> Rows:
    try:
        return [(number, cells_of(line, delimiter)) for number, line in numbered_lines(content, name, limits)]
    except csv.Error as error:
        raise UnusableRecording(f"{name}: not a table: {error}") from None


def _chosen(bodies: dict[str, dict[str, int]], wanted: str, name: str) -> tuple[dict[str, int], tuple[str, ...]]:
    """Return the columns of a body, and the names of all bodies if there are several."""
    whole = {body: places for body, places in bodies.items() if all(axis in places for axis in AXES)}
    if wanted and wanted not in whole:
        raise OptionNeeded(f"{name}: no {wanted!r} in it", "track", *whole)
    if not whole:
        raise UnusableRecording(f"{name}: it holds no positions X, Y, Z")
    if len(whole) > 1 and not wanted:
        raise OptionNeeded(f"{name}: it holds {len(whole)} of them", "track", *whole)
    return whole[wanted or next(iter(whole))], tuple(whole) if len(whole) > 1 else ()


def _spread(names: Sequence[str]) -> list[str]:
    """Return the name of each column, where a name stands over the first of its columns only."""
    spread: list[str] = []
    for cell in names:
        spread.append(cell or (spread[-1] if spread else ""))
    return spread


def _rate(cell: str, name: str) -> float:
    try:
        rate = float(cell)
    except ValueError:
        rate = 0.0
    if not 1.0 <= rate <= 10_000.0:
        raise UnusableRecording(f"{name}, line 2: {cell!r} is no rate from 1 to 10000 Hz")
    return rate


def _time_of(frame: str, rate: float, name: str, line: int) -> str:
    try:
        return repr(float(frame) / rate)
    except ValueError:
        raise UnusableRecording(f"{name}, line {line}: {frame!r} is no number of a frame") from None


def _first_line(content: bytes) -> bytes:
    return content[:400].lstrip(b"\xef\xbb\xbf").partition(b"\n")[0].strip().rstrip(b",")


MOTIVE = Reader(
    "motive",
    "CSV export of Motive",
    read_motive,
    lambda content, name: _first_line(content).startswith(b"Format Version"),
)
VICON = Reader(
    "vicon",
    "CSV export of Vicon Nexus or Tracker",
    read_vicon,
    lambda content, name: _first_line(content) in (b"Trajectories", b"Objects", b"Segments"),
)
TRC = Reader(
    "trc", "marker trajectories (TRC)", read_trc, lambda content, name: _first_line(content).startswith(b"PathFileType")
)
