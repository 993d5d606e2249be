"""Logs of setpoints as CSV: t, q1 to q6, perhaps on_path or speeds and accelerations; lines with # are remarks."""

from __future__ import annotations

import csv
import io

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.records import Array

COLUMNS = ["t", "q1", "q2", "q3", "q4", "q5", "q6"]
ON_PATH = "on_path"
DERIVATIVES = [f"{quantity}{joint}" for quantity in "va" for joint in range(1, 7)]  # which are not read
LARGEST = 256 * 1024 * 1024  # bytes


def read_setpoints(content: bytes, name: str) -> tuple[Array, Array, Array | None]:
    """Read a log of setpoints.

    Returns:
        times (n,) [s], positions (n, 6) [rad], and whether each is on the path (n,) when the file says it.

    Raises:
        UnusableRecording: with the line that is wrong.
    """
    if len(content) > LARGEST:
        raise UnusableRecording(f"{name}: {len(content)} bytes are over the limit of {LARGEST}; split the file")
    try:
        rows = list(csv.reader(io.StringIO(content.decode("utf-8-sig"))))
    except (UnicodeDecodeError, csv.Error) as error:
        raise UnusableRecording(f"{name}: this is no CSV ({error})") from None
    numbered = [(line, row) for line, row in enumerate(rows, 1) if row and not row[0].startswith("#")]
    header = [column.strip() for column in numbered[0][1]] if numbered else []
    if header not in (COLUMNS, [*COLUMNS, ON_PATH], [*COLUMNS, *DERIVATIVES]):
        raise UnusableRecording(f"{name}: the first line must be {','.join(COLUMNS)} (s and rad), perhaps with on_path")
    values = np.array([_numbers(row, line, len(header), name) for line, row in numbered[1:]])
    if len(values) < 4:
        raise UnusableRecording(f"{name}: {len(values)} setpoints are too few to difference; at least 4")
    backward = np.flatnonzero(np.diff(values[:, 0]) <= 0)
    if len(backward):
        raise UnusableRecording(f"{name}, line {numbered[backward[0] + 2][0]}: time does not go on")
    if np.abs(values[:, 1:7]).max() > 4 * np.pi:
        raise UnusableRecording(f"{name}: a joint is at {np.abs(values[:, 1:7]).max():.1f} rad; are these degrees?")
    return values[:, 0], values[:, 1:7], values[:, 7] if ON_PATH in header else None


def _numbers(row: list[str], line: int, count: int, name: str) -> list[float]:
    if len(row) != count:
        raise UnusableRecording(f"{name}, line {line}: {len(row)} values, needs {count}")
    try:
        numbers = [float(text) for text in row]
    except ValueError:
        raise UnusableRecording(f"{name}, line {line}: {','.join(row)[:60]!r} are no numbers") from None
    if not np.all(np.isfinite(numbers)):
        raise UnusableRecording(f"{name}, line {line}: a value is not finite")
    return numbers
