"""Logs of setpoints as CSV: t, q1 to q6 or q7, perhaps on_path or speeds and accelerations; # begins remarks."""

from __future__ import annotations

import csv
import io

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.records import Array

JOINT_COUNTS = (6, 7)  # that an arm may have
ON_PATH = "on_path"
MAX_FILE_SIZE = 256 * 1024 * 1024  # bytes


def read_setpoints(content: bytes, name: str) -> tuple[Array, Array, Array | None]:
    """Read a log of setpoints.

    Returns:
        times (n,) [s], positions (n, joints) [rad], and whether each is on the path (n,) when the file says it.

    Raises:
        UnusableRecording: with the line that is wrong.
    """
    if len(content) > MAX_FILE_SIZE:
        raise UnusableRecording(f"{name}: {len(content)} bytes are over the limit of {MAX_FILE_SIZE}; split the file")
    try:
        rows = list(csv.reader(io.StringIO(content.decode("utf-8-sig"))))
    except (UnicodeDecodeError, csv.Error) as error:
        raise UnusableRecording(f"{name}: this is no CSV ({error})") from None
    numbered = [(line, row) for line, row in enumerate(rows, 1) if row and not row[0].startswith("#")]
    header = [column.strip() for column in numbered[0][1]] if numbered else []
    count = next((count for count in JOINT_COUNTS if header in _headers(count)), None)
    if count is None:
        first = " or ".join(",".join(_headers(count)[0]) for count in JOINT_COUNTS)
        raise UnusableRecording(f"{name}: the first line must be {first} (s and rad), perhaps with on_path")
    values = np.array([_numbers(row, line, len(header), name) for line, row in numbered[1:]])
    if len(values) < 4:
        raise UnusableRecording(f"{name}: {len(values)} setpoints are too few to difference; at least 4")
    backward = np.flatnonzero(np.diff(values[:, 0]) <= 0)
    if len(backward):
        raise UnusableRecording(f"{name}, line {numbered[backward[0] + 2][0]}: time does not go on")
    if np.abs(values[:, 1 : count + 1]).max() > 4 * np.pi:
        raise UnusableRecording(
            f"{name}: a joint is at {np.abs(values[:, 1 : count + 1]).max():.1f} rad; are these degrees?"
        )
    return values[:, 0], values[:, 1 : count + 1], values[:, count + 1] if ON_PATH in header else None


def _headers(count: int) -> list[list[str]]:
    """Return the first lines that a log of so many joints may have; speeds and accelerations are not read."""
    columns = ["t", *(f"q{joint}" for joint in range(1, count + 1))]
    return [
        columns,
        [*columns, ON_PATH],
        [*columns, *(f"{quantity}{joint}" for quantity in "va" for joint in range(1, count + 1))],
    ]


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
