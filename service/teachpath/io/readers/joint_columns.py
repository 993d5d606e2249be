"""Joint angles of the station's arm in the columns of a table, instead of positions."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.readers.columns import POSITION, map_columns, parse_columns, plain_name
from teachpath.io.readers.contract import FileMotions, JointTrack, ReadOptions
from teachpath.io.readers.text import table
from teachpath.io.readers.time_units import stamps_of, time_unit

DEGREES = re.compile(r"[\[(]\s*(deg|degrees?|°)\s*[\])]|_deg$")
NUMBERED_NAMES = ("j{}", "q{}", "joint{}", "joint_{}")  # what columns are called where the arm's own names are not used


def joint_places(header: Sequence[str], options: ReadOptions) -> tuple[int, ...]:
    """Return which column holds each joint of the station's arm; empty where the table has positions, or lacks a joint.

    Args:
        header: names of the columns.
        options: with the names of the arm's joints; columns that the user names for positions count first.
    """
    if any(axis in parse_columns(options.columns) for axis in POSITION):
        return ()
    plain = [re.sub(r"_(rad|deg)$", "", plain_name(cell)) for cell in header]
    if not options.joints or set(POSITION) <= set(plain):
        return ()
    numbers = range(1, len(options.joints) + 1)
    ways = [
        [plain_name(name) for name in options.joints],
        *([way.format(k) for k in numbers] for way in NUMBERED_NAMES),
    ]
    found = next((names for names in ways if set(names) <= set(plain)), ())
    return tuple(plain.index(name) for name in found)


def read_joint_rows(
    rows: list[tuple[int, list[str]]],
    header: Sequence[str],
    delimiter: str,
    name: str,
    options: ReadOptions,
    places: tuple[int, ...],
) -> FileMotions:
    """Read the rows of a table of time and joint angles, and perhaps grasp or flexion.

    Args:
        rows: each with the number of its line.
        header: names of the columns.
        delimiter: between the cells.
        name: of the file, for errors.
        options: what the user says of it, and the names of the arm's joints.
        places: of their columns (see `joint_places`).

    Raises:
        UnusableRecording: a cell is no number; OptionNeeded: there is no time, or its unit is not known.
    """
    if options.units:
        raise UnusableRecording(f"{name}: it holds joint angles, of which no units of length can be said")
    columns = map_columns(header, parse_columns(options.columns), name, required=("t",))
    if not rows:
        raise UnusableRecording(f"{name}: there are no samples under the header")
    closes = next((role for role in ("grasp", "flexion") if role in columns.places), "")
    wanted = [columns.places["t"], *places, *([columns.places[closes]] if closes else [])]
    values = table(rows, wanted, len(header), name, delimiter)
    if not np.isfinite(values[:, 0]).all():
        line = rows[int(np.argmin(np.isfinite(values[:, 0])))][0]
        raise UnusableRecording(f"{name}, line {line}: a row without a time; take it out")
    unit = time_unit(values[:, 0], said=options.time_unit, stated=columns.unit_names.get("t", ""), name=name)
    cells = [row[columns.places["t"]] for _, row in rows]
    turned = [bool(DEGREES.search(header[place].lower())) for place in places]
    angles = values[:, 1 : len(places) + 1] * np.where(turned, np.pi / 180.0, 1.0)
    track = JointTrack(
        stamps_of(cells, values[:, 0], unit, delimiter, name),
        options.joints,
        angles,
        values[:, -1] if closes else None,
    )
    understood = [
        f"time in {unit} ({header[columns.places['t']]})",
        f"joint angles in {'deg' if all(turned) else 'rad'} ({', '.join(header[place] for place in places)})",
    ]
    understood += [f"{closes} from {header[columns.places[closes]]}"] if closes else []
    return FileMotions((), tuple(understood), joint_tracks=[track])
