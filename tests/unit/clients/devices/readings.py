"""Readings, calibrations and records that the tests of the devices share."""

import math
from collections.abc import Callable, Iterator

from teachpath_client.devices.fastrak_wire import Pose
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.reading import HandReading
from tests.waiting import wait_until


def calibration(sensors: int = 22) -> GloveCalibration:
    """Return a calibration with rising and falling sensors; the last one does not tell the fist."""
    offset = tuple(40.0 + 3.0 * i if i % 3 else 220.0 - i for i in range(sensors))
    gain = tuple((1 if i % 3 else -1) / (100.0 + i) for i in range(sensors - 1))
    return GloveCalibration(offset, (*gain, 0.0))


def readings(count: int, sensors: int = 22) -> list[HandReading]:
    """Return readings that all differ, within what the devices can show."""
    found = []
    for i in range(count):
        angle = 0.01 * i
        flexions = tuple(min(1.0, (i % 50) / 50 + 0.001 * k) for k in range(sensors))
        orientation = (math.cos(angle), 0.6 * math.sin(angle), 0.0, 0.8 * math.sin(angle))
        found.append(HandReading(0.02 * i, (0.3 + 0.001 * i, -0.2 + 0.002 * i, 0.5), orientation, flexions))
    return found


def pose(i: int, station: int = 1) -> Pose:
    """Return the i-th of many different poses, exact in both record formats."""
    signs = ((1.0, 0.0, 0.0, 0.0), (0.5, 0.5, -0.5, 0.5), (0.0, -0.6, 0.8, 0.0), (-0.5, 0.5, 0.5, 0.5))
    return Pose(station, " D"[i % 7 == 3], (i * 0.25 % 300, -(i * 0.5 % 300), 12.75), signs[i % 4])


def until(true: Callable[[], object], what: str) -> None:
    """Wait until `true` returns something true."""
    wait_until(true, what)


def gather(source: Iterator[HandReading], last: Callable[[HandReading], bool]) -> list[HandReading]:
    """Return readings up to and including the one that `last` knows."""
    found = []
    for reading in source:
        found.append(reading)
        if last(reading):
            return found
    raise AssertionError("the source ended")
