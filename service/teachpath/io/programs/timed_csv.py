"""A motion as a table: time, joints, their speeds and accelerations, under what a reader must know of it."""

from __future__ import annotations

import csv
import io
from typing import Final

import numpy as np

from teachpath.records import SampledMotion

UNITS: Final = "Columns: t [s]; q1 to q{0}, the joints [rad]; v1 to v{0} [rad/s]; a1 to a{0} [rad/s^2]."


def timed_csv(motion: SampledMotion) -> bytes:
    """Write a motion as CSV; lines that begin with # come before the names of the columns."""
    text, count = io.StringIO(), motion.positions.shape[1]
    for note in (*motion.notes, UNITS.format(count)):
        text.write(f"# {note}\n")
    rows = np.column_stack([motion.times, motion.positions, motion.velocities, motion.accelerations])
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["t", *(f"{quantity}{joint}" for quantity in "qva" for joint in range(1, count + 1))])
    writer.writerows([repr(value) for value in row] for row in rows.tolist())
    return text.getvalue().encode()
