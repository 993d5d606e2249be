"""Places that are touched with a tracker: where it sees itself while it is held still, in its own frame."""

from __future__ import annotations

import math
import queue
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from statistics import fmean
from typing import Final

from teachpath.errors import Conflict, NotFound, Unanswered, UnusableSample
from teachpath.io.wire import decode_sample
from teachpath.recorder.presence import Presence
from teachpath.records import Sample, Vector
from teachpath_proto.keys import Keys

READING_TIMEOUT: Final = 10.0  # [s] for the readings to come
MIN_READINGS: Final = 10
MAX_DEVIATION: Final = 0.005  # [m] from their mean that a reading may lie while the tracker is held still
MAX_TOUCHES: Final = 4  # at a time: each keeps a thread of the web port waiting
MAX_WAITING: Final = 10_000  # samples that wait to be looked at


@dataclass(frozen=True, slots=True)
class Touch:
    """A place at which a tracker was held still.

    Attributes:
        tracker: its name.
        position: mean of the readings, in the tracker's frame [m].
        deviation: of the reading farthest from it [m].
        readings: how many there were.
    """

    tracker: str
    position: Vector
    deviation: float
    readings: int


class Touches:
    """Measures touched places; safe to use from several threads.

    Args:
        presence: knows which trackers are there.
        timeout: [s] for the readings to come.
    """

    def __init__(self, keys: Keys, presence: Presence, *, timeout: float = READING_TIMEOUT) -> None:
        self._keys = keys
        self._presence = presence
        self._timeout = timeout
        self._lock = threading.Lock()
        self._waiting: dict[str, queue.Queue[bytes]] = {}  # by the key of the samples

    def on_sample(self, key: str, payload: bytes) -> None:
        """Take a sample; on the transport's thread."""
        if (samples := self._waiting.get(key)) is not None:
            with suppress(queue.Full):
                samples.put_nowait(payload)

    def is_waiting_for(self, tracker: str) -> bool:
        """Tell whether a place is being touched with a tracker now."""
        return self._keys.samples(tracker) in self._waiting

    def measure(self, tracker: str, *, hold_time: float) -> Touch:
        """Return where a tracker sees itself; it must be held still for `hold_time` [s] of its own clock from now on.

        Raises:
            NotFound: no tracker of that name is there.
            Unanswered: too few readings came.
            Conflict: the tracker moved or was not tracked, or too many places are being touched.
        """
        names = [known.name for known in self._presence.trackers()]
        if tracker not in names:
            raise NotFound(f"there is no tracker {tracker!r} now; there are: {', '.join(names) or 'none'}")
        with self._listening(tracker) as samples:
            return _touch(tracker, self._readings(tracker, samples, hold_time))

    @contextmanager
    def _listening(self, tracker: str) -> Iterator[queue.Queue[bytes]]:
        key = self._keys.samples(tracker)
        with self._lock:
            if key in self._waiting:
                raise Conflict(f"a place is being touched with {tracker} already; try again when that is done")
            if len(self._waiting) >= MAX_TOUCHES:
                raise Conflict(f"{MAX_TOUCHES} places are being touched already; try again when one is done")
            samples = self._waiting[key] = queue.Queue(MAX_WAITING)
        try:
            yield samples
        finally:
            del self._waiting[key]

    def _readings(self, tracker: str, samples: queue.Queue[bytes], hold_time: float) -> list[Sample]:
        deadline, readings = time.monotonic() + self._timeout, list[Sample]()
        while len(readings) < MIN_READINGS or _duration(readings) < hold_time:
            try:
                payload = samples.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                raise Unanswered(
                    f"{len(readings)} readings over {_duration(readings):.2g} s of {tracker} came in {self._timeout:g} "
                    f"s, {MIN_READINGS} over {hold_time:g} s are needed; is it on, and in view?"
                ) from None
            with suppress(UnusableSample):  # it is counted where it is recorded
                readings.append(decode_sample(tracker, payload, time.time_ns()))
        return readings


def _duration(readings: list[Sample]) -> float:
    """Return the time between the first and the last reading [s], by the device's clock."""
    return (readings[-1].device_ns - readings[0].device_ns) / 1e9 if readings else 0.0


def _touch(tracker: str, readings: list[Sample]) -> Touch:
    """Return the mean of readings; raises Conflict where the tracker was not held still, or not seen."""
    if lost := sum(not reading.tracked for reading in readings):
        raise Conflict(f"{tracker} was not tracked in {lost} of {len(readings)} readings; touch the place again")
    x, y, z = (fmean(axis) for axis in zip(*(reading.position for reading in readings), strict=True))
    deviation = max(math.dist(reading.position, (x, y, z)) for reading in readings)
    if deviation > MAX_DEVIATION:
        raise Conflict(
            f"{tracker} moved by {1000 * deviation:.0f} mm while it touched the place, {1000 * MAX_DEVIATION:.0f} mm "
            "are allowed; hold it still, and touch the place again"
        )
    return Touch(tracker, (x, y, z), deviation, len(readings))
