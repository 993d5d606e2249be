"""Recording from a live source until somebody ends it, and the calibration of a glove."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from teachpath_client.devices.cyberglove import GloveProtocol, GloveSettings, Raw, connect
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.devices.source import Source, TouchSource
from teachpath_client.reading import HandReading
from teachpath_client.tracker import Routine, Tracker
from teachpath_proto import tracker_pb2

HOLDING_TIMEOUT = (
    3.0  # [s] after which a station that said the hand holds something counts as gone; it says so each second
)
CALIBRATION_SAMPLES = 100  # samples of a hand that is held still
SAMPLE_TIMEOUT = 5.0  # [s] without a sample


@contextmanager
def ended_by_signals(source: Source) -> Iterator[None]:
    """Close the source at the first Ctrl-C or SIGTERM, so that the recording ends with a handshake."""
    numbers = (signal.SIGINT, signal.SIGTERM)

    def end(_number: int, _frame: FrameType | None) -> None:
        source.close()
        for number in numbers:
            signal.signal(number, before[number])

    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, before[number])


def record_live(
    tracker: Tracker,
    source: Source,
    task: str,
    *,
    scene: str = "",
    calibration: str = "",
    speed: float = 1.0,
    rate: float = 0.0,
    routine: Routine | None = None,
    reading_filter: Callable[[Iterator[HandReading]], Iterator[HandReading]] = lambda readings: readings,
) -> tracker_pb2.RecordingReport:
    """Record `task` from a source until the source ends, and return the station's report, whatever ended it.

    `rate` [Hz] is declared to the station, which assesses the takes by it (0: nothing is declared);
    `reading_filter` may change the readings.
    """
    tracker.start(task, scene=scene, calibration=calibration, rate=rate, routine=routine)
    try:
        tracker.publish(reading_filter(iter(source)), speed=speed)
    finally:
        report = tracker.stop()
    return report


class HapticFeedback:
    """Makes the glove vibrate while a living station reports that the hand holds the object.

    Args:
        source: the device that vibrates.
        clock: [s] that never runs back.
    """

    def __init__(self, source: TouchSource, clock: Callable[[], float] = time.monotonic) -> None:
        self._source, self._clock = source, clock
        self._until = float("inf")

    def on_feedback(self, payload: bytes) -> None:
        """Start or stop the vibration as a `HandFeedback` says."""
        holding = tracker_pb2.HandFeedback.FromString(payload).holding
        self._until = self._clock() + HOLDING_TIMEOUT if holding else float("inf")
        self._source.touch(holding)

    def readings(self, readings: Iterator[HandReading]) -> Iterator[HandReading]:
        """Pass readings on; stop the vibration when the station is silent for too long, and after the last reading."""
        try:
            for reading in readings:
                if self._clock() > self._until:
                    self._until = float("inf")
                    self._source.touch(False)
                yield reading
        finally:
            self._source.touch(False)


def calibrate_glove(settings: GloveSettings, prompt: Callable[[str], object]) -> GloveCalibration:
    """Measure the open hand and the fist with a glove; `prompt` shows an instruction and returns when it was followed.

    The glove is connected again for each measurement, so that no earlier sample is used.

    Raises:
        ClientError: the glove does not answer, falls silent, or cannot tell the two hands apart.
    """
    measured = []
    with connect(settings, GloveProtocol(settings, 0)):
        pass  # a glove that does not answer is said before anything is asked for
    for sentence in ("Open the hand, fingers straight", "Make a fist"):
        prompt(sentence)
        with connect(settings, GloveProtocol(settings, 0)) as connection:
            taken = [connection.next_record(SAMPLE_TIMEOUT) for _ in range(CALIBRATION_SAMPLES)]
        measured.append([sample for sample in map(_raw, taken) if sample is not None])
    return GloveCalibration.between(*measured)


def _raw(taken: tuple[float, Raw] | None) -> Raw | None:
    return taken[1] if taken else None
