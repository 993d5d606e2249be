"""A motion as a table: time, joints, their speeds and accelerations, under what a reader must know of it."""

from __future__ import annotations

import csv
import io
from typing import Final

import numpy as np

from teachpath.records import SampledMotion

COLUMNS: Final = ["t"] + [f"{quantity}{joint}" for quantity in "qva" for joint in range(1, 7)]
UNITS: Final = "Columns: t [s]; q1 to q6, the joints [rad]; v1 to v6 [rad/s]; a1 to a6 [rad/s^2]."


def timed_csv(motion: SampledMotion) -> bytes:
    """Write a motion as CSV; lines that begin with # come before the names of the columns."""
    text = io.StringIO()
    for note in (*motion.notes, UNITS):
        text.write(f"# {note}\n")
    rows = np.column_stack([motion.times, motion.positions, motion.velocities, motion.accelerations])
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([repr(value) for value in row] for row in rows.tolist())
    return text.getvalue().encode()
