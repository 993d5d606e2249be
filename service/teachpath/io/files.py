"""Recordings that other programs wrote, CSV files and arrays: read within limits, checked before anything is stored."""

from __future__ import annotations

import csv
import io
import math
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.wire import MAX_COORDINATE
from teachpath.records import Array

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
FORMATS = ("csv", "npy", "robottasks")
LARGEST_FILE = 64 * 1024 * 1024  # bytes
LONGEST_LINE = 1_000_000  # characters of a text file
MAX_EXTRA_LINES = 1000  # lines of a text file that are no samples
COLUMNS = ["t", "x", "y", "z"]
ROTATION = ["qw", "qx", "qy", "qz"]


@dataclass(frozen=True, eq=False)
class Track:
    """One recorded motion: times (n,) [s], positions (n, 3) [m], orientations (n, 4) w, x, y, z or None."""

    times: Array
    positions: Array
    orientations: Array | None


def check_format(name: str, kind: str, units: str, rate: float) -> None:
    """Raise UnusableRecording when a file `name` cannot be read as asked for; `kind` may also be mcap."""
    if kind not in (*FORMATS, "mcap"):
        raise UnusableRecording(f"{name}: format {kind!r} is unknown; known: {', '.join(FORMATS)}, mcap")
    if units not in UNITS:
        raise UnusableRecording(f"{name}: units {units!r} are unknown; known: {', '.join(UNITS)}")
    if not 1.0 <= rate <= 10_000.0:
        raise UnusableRecording(f"{name}: a rate of {rate:g} Hz is outside 1 to 10000")


def read_tracks(
    content: bytes, name: str, limits: ImportSettings, *, kind: str, units: str, rate: float
) -> list[Track]:
    """Read the motions of a file.

    Args:
        content: of the file.
        name: of the file, for errors.
        limits: of what it may hold.
        kind: "csv" (one motion, columns t, x, y, z and perhaps qw, qx, qy, qz), "npy" (the same columns as an array
            (samples, 4 or 8), or (motions, samples, 4 or 8)) or "robottasks" (an .npy array (motions, samples, 7) of
            x, y, z, qw, qx, qy, qz without a clock).
        units: of the positions: m, cm, mm or in.
        rate: [Hz] of a format without a clock.

    Raises:
        UnusableRecording: with the row and column that is wrong.
    """
    check_format(name, kind, units, rate)
    if len(content) > LARGEST_FILE:
        raise UnusableRecording(f"{name}: {len(content)} bytes are over the limit of {LARGEST_FILE}; split the file")
    if not content:
        raise UnusableRecording(f"{name}: the file is empty")
    tracks = _read_csv(content, name, limits) if kind == "csv" else _read_arrays(content, name, limits, kind, rate)
    scaled = [Track(t.times, t.positions * UNITS[units], t.orientations) for t in tracks]
    for number, track in enumerate(scaled, 1):
        _check(track, name if len(scaled) == 1 else f"{name}, demonstration {number}", limits)
    return scaled


def text_lines(content: bytes, name: str, limits: ImportSettings) -> Iterator[str]:
    """Yield the lines of a text file, with their ends; empty ones count as well.

    Raises:
        UnusableRecording: a line is too long, or there are more than a file within the limits needs.
    """
    text = io.TextIOWrapper(io.BytesIO(content), "utf-8-sig", newline="")
    number = 0
    while line := text.readline(LONGEST_LINE + 1):
        number += 1
        if len(line) > LONGEST_LINE:
            raise UnusableRecording(f"{name}, line {number}: over {LONGEST_LINE} characters, the limit; split the line")
        if number > limits.max_samples + MAX_EXTRA_LINES:
            raise UnusableRecording(
                f"{name}: over {number - 1} lines; the limit is {limits.max_samples} samples (imports.max_samples); "
                "split the file"
            )
        yield line


def _read_csv(content: bytes, name: str, limits: ImportSettings) -> list[Track]:
    values = array("d")
    try:
        rows = (row for row in csv.reader(text_lines(content, name, limits)) if row)
        header = [cell.strip().lower() for cell in next(rows, [])]
        if header not in (COLUMNS, COLUMNS + ROTATION):
            raise UnusableRecording(
                f"{name}: the first line must be t,x,y,z or t,x,y,z,qw,qx,qy,qz; it is {header[:9]}"
            )
        for number, row in enumerate(rows, 2):
            values.extend(_numbers(row, len(header), f"{name}, line {number}"))
    except (UnicodeDecodeError, csv.Error) as error:
        raise UnusableRecording(f"{name}: not a CSV text file: {error}") from None
    if not values:
        raise UnusableRecording(f"{name}: there are no samples under the header")
    table = np.array(values).reshape(-1, len(header))
    check_count(name, 1, len(table), limits)
    return [Track(table[:, 0] - table[0, 0], table[:, 1:4], table[:, 4:8] if len(header) == 8 else None)]


def _numbers(row: list[str], count: int, where: str) -> list[float]:
    if len(row) != count:
        raise UnusableRecording(f"{where}: {len(row)} values, the header has {count} columns; is the file truncated?")
    try:
        return [float(cell) for cell in row]
    except ValueError as error:
        raise UnusableRecording(f"{where}: {error}") from None


def _read_arrays(content: bytes, name: str, limits: ImportSettings, kind: str, rate: float) -> list[Track]:
    try:
        values = _load_array(content, name, limits)
    except (UnusableRecording, MemoryError):
        raise
    except Exception as error:  # a damaged header ends in whatever its tokens and sizes make numpy raise
        raise UnusableRecording(f"{name}: not a whole .npy array of numbers: {error}") from None
    is_array = values.dtype.kind == "f"
    if is_array and kind == "npy" and values.ndim == 2:
        values = values[None]
    columns = (7,) if kind == "robottasks" else (4, 8)
    if not is_array or values.ndim != 3 or values.shape[2] not in columns:
        wanted = " or ".join(map(str, columns))
        raise UnusableRecording(f"{name}: the array must be floats (motions, samples, {wanted}); it is {values.shape}")
    if len(values) == 0:
        raise UnusableRecording(f"{name}: the array holds no demonstrations")
    motions = values.astype(np.float64)
    if kind == "robottasks":
        times = np.arange(values.shape[1]) / rate
        return [Track(times, v[:, :3], v[:, 3:]) for v in motions]
    return [Track(v[:, 0] - v[:1, 0], v[:, 1:4], v[:, 4:] if v.shape[1] == 8 else None) for v in motions]


def _load_array(content: bytes, name: str, limits: ImportSettings) -> NDArray[Any]:
    """Return the array of an .npy file; what its header states is checked before memory is taken for it."""
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream)
    if dtype.hasobject:
        raise ValueError("it holds Python objects")
    check_count(name, shape[0] if len(shape) == 3 else 1, math.prod(shape[:-1]), limits)
    if math.prod(shape) * dtype.itemsize != len(content) - stream.tell():
        raise ValueError(f"{shape} of {dtype} is not what {len(content) - stream.tell()} bytes hold")
    stream.seek(0)
    loaded: NDArray[Any] = np.load(stream, allow_pickle=False)
    return loaded


def check_count(name: str, motions: int, samples: int, limits: ImportSettings) -> None:
    """Raise UnusableRecording when a file holds more motions or samples than the limits allow."""
    if motions > limits.max_motions:
        raise UnusableRecording(
            f"{name}: {motions} motions, limit {limits.max_motions} (imports.max_motions); split the file"
        )
    if samples > limits.max_samples:
        raise UnusableRecording(
            f"{name}: {samples} samples, limit {limits.max_samples} (imports.max_samples); split the file"
        )


def _check(track: Track, where: str, limits: ImportSettings) -> None:
    if len(track.times) < 2:
        raise UnusableRecording(f"{where}: {len(track.times)} samples are too few for a motion")
    columns = [track.times[:, None], track.positions]
    if track.orientations is not None:
        columns.append(track.orientations)
    bad = np.argwhere(~np.isfinite(np.hstack(columns)))
    if len(bad):
        column = (COLUMNS + ROTATION)[int(bad[0, 1])]
        raise UnusableRecording(f"{where}: sample {int(bad[0, 0])} has a {column} that is not finite")
    farthest, span = np.max(np.abs(track.positions)), track.times[-1] - track.times[0]
    if farthest > MAX_COORDINATE:
        raise UnusableRecording(
            f"{where}: a position is {farthest:g} m away, limit {MAX_COORDINATE:g}; are the units right?"
        )
    if span > limits.max_duration:
        raise UnusableRecording(
            f"{where}: it lasts {span:g} s, limit {limits.max_duration:g} (imports.max_duration); t is in seconds"
        )
    steps = np.diff(track.times)
    if np.any(steps <= 0):
        i = int(np.argmax(steps <= 0))
        raise UnusableRecording(
            f"{where}: time goes from {track.times[i]:g} to {track.times[i + 1]:g} s at sample {i + 1}; sort by t"
        )
    if track.orientations is not None:
        norms = np.linalg.norm(track.orientations, axis=1)
        worst = int(np.argmax(np.abs(norms - 1.0)))
        if not math.isclose(norms[worst], 1.0, abs_tol=0.01):
            raise UnusableRecording(f"{where}: the quaternion of sample {worst} has length {norms[worst]:.3g}, not 1")
