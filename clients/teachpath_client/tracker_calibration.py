"""The tracker's frame in the world: where the tracker sees points that are known, and the calibration in words."""

from __future__ import annotations

import csv
import math
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from teachpath_client.devices.source import Source
from teachpath_client.errors import ClientError
from teachpath_client.models import MeasuredCalibration
from teachpath_client.reading import HandReading, Vector

HOLD_TIME = 1.0  # [s] the tracker is held still at a point
MIN_READINGS = 10  # readings in that time
MAX_DEVIATION = 0.005  # [m] from their mean that a reading may lie while it is held still
READING_TIMEOUT = 10.0  # [s] for the readings to come
COLUMNS = ["tracker_x", "tracker_y", "tracker_z", "x", "y", "z"]


@dataclass(frozen=True)
class Pair:
    """A point as the tracker saw it, and where it is in the world [m]."""

    tracker: Vector
    world: Vector


def measure_points(
    make: Callable[[], Source], places: Sequence[Vector], prompt: Callable[[str], object], *, held: float = HOLD_TIME
) -> list[Pair]:
    """Measure where the tracker sees each place; `prompt` returns when the tracker is held there.

    It must be held for `held` [s] of its own time each; a point at which it moved, was not tracked or did not answer is
    asked for again. The source is connected anew for each point: however slow this computer is, no reading that waited
    somewhere on the way can be taken for one of now.

    Args:
        make: returns the source, not yet connected.

    Raises:
        ClientError: nothing answers at first, or no reading comes.
    """
    with make():
        pass  # whoever has to walk to a point should know before
    pairs = []
    for number, place in enumerate(places, 1):
        x, y, z = place
        where = f"point {number} of {len(places)}: hold the tracker still at {x:g}, {y:g}, {z:g} m"
        fault = ""
        while True:
            prompt(f"{fault}{where}")
            readings, fault = _hold(make(), held)
            if not fault:
                break
        pairs.append(Pair(_mean(readings), place))
    return pairs


def read_points(file: Path) -> list[Pair]:
    """Read pairs from a CSV file with the columns tracker_x, tracker_y, tracker_z, x, y, z [m].

    Raises:
        ClientError: with the line that cannot be read.
    """
    try:
        rows = [row for row in csv.reader(file.read_text().splitlines()) if row]
    except (OSError, UnicodeDecodeError) as error:
        raise ClientError(f"cannot read {file}: {error}") from None
    if not rows or [cell.strip() for cell in rows[0]] != COLUMNS:
        raise ClientError(
            f"{file}: the first line must be {','.join(COLUMNS)}; it is {','.join(rows[0]) if rows else ''}"
        )
    pairs = []
    for number, row in enumerate(rows[1:], 2):
        try:
            a, b, c, x, y, z = map(float, row)
        except ValueError:
            raise ClientError(f"{file}, line {number}: {','.join(row)} is not six numbers") from None
        pairs.append(Pair((a, b, c), (x, y, z)))
    return pairs


def lines(measured: MeasuredCalibration) -> Iterator[str]:
    """Yield the measured calibration as lines for the operator, and as lines of a settings file."""
    calibration, points = measured.calibration, measured.points
    for number, point in enumerate(points, 1):
        x, y, z = point.world
        yield f"point {number} at {x:g}, {y:g}, {z:g} m: {1000 * point.residual:.1f} mm off"
    kept = f"version {measured.version} is kept" if measured.version else "not kept"
    yield f"{calibration.name}: {1000 * measured.rms:.2f} mm rms over {len(points)} points; {kept}"
    yield "# the same for a settings file:"
    yield "[[calibrations]]"
    yield f'name = "{calibration.name}"'
    yield f"scale = {calibration.scale}"
    yield f"rotation = {list(calibration.rotation)}"
    yield f"offset = {list(calibration.offset)}"


def _hold(source: Source, seconds: float) -> tuple[list[HandReading], str]:
    """Return the readings of the next `seconds` on the device's clock, and a sentence about what is wrong with them."""
    held: list[HandReading] = []
    over = threading.Timer(READING_TIMEOUT, source.close)
    try:
        with source:
            over.start()
            for reading in source:
                held.append(reading)
                if len(held) >= MIN_READINGS and reading.time - held[0].time >= seconds:
                    return held, _fault(held)
    except ClientError as error:
        return held, f"{error}; again, "
    finally:
        over.cancel()
    raise ClientError(f"only {len(held)} readings came; is the device on, and in view?")


def _mean(held: Sequence[HandReading]) -> Vector:
    x, y, z = (fmean(axis) for axis in zip(*(reading.position for reading in held), strict=True))
    return x, y, z


def _fault(held: Sequence[HandReading]) -> str:
    lost = sum(not reading.tracked for reading in held)
    if lost:
        return f"{lost} of {len(held)} readings were not tracked; again, "
    mean = _mean(held)
    farthest = max(math.dist(reading.position, mean) for reading in held)
    if farthest > MAX_DEVIATION:
        return f"it moved by {1000 * farthest:.0f} mm, {1000 * MAX_DEVIATION:.0f} mm are allowed; again, "
    return ""
