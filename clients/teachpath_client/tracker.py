"""A tracker: it publishes readings at their pace and ends a recording with a handshake."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from teachpath_client.errors import ClientError
from teachpath_client.link import Link
from teachpath_client.reading import HandReading
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys, is_name, name_refusal


@dataclass(frozen=True, slots=True)
class Routine:
    """How a recording goes from one take to the next without a command of the operator."""

    armed: bool = False  # begin paused: the pedal, a fist or the page begins the first take
    countdown: float | None = None  # [s] before each take; None: as the station's settings say
    takes: int = 0  # after so many it pauses by itself; 0: never
    one_by_one: bool = False  # pause after each take


class Tracker:
    """One tracker at one station.

    Args:
        link: the session with the station.
        name: of this tracker, unique at the station.
        prefix: of the station's keys.
        clock, sleep: monotonic clock [s] and its wait; tests pass their own.

    Raises:
        ClientError: the name cannot be one.
    """

    def __init__(
        self,
        link: Link,
        name: str,
        *,
        prefix: str = "teachpath/station",
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        if not is_name(name):
            raise ClientError(name_refusal("tracker", name))
        self.name: str = name
        self._link, self._keys = link, Keys(prefix)
        self._clock, self._sleep = clock, sleep
        self._publisher = link.publisher(self._keys.samples(name))
        self._token = link.announce(self._keys.alive("tracker", name))
        self._next = 1
        self._subscriptions: list[object] = []

    def start(
        self, task: str, *, scene: str = "", calibration: str = "", rate: float = 0.0, routine: Routine | None = None
    ) -> tracker_pb2.RecordingReport:
        """Ask the station to record `task` from this tracker.

        Args:
            task: what is demonstrated.
            scene: makes a new task with this scene.
            calibration: of the tracker's frame; empty: the task's own.
            rate: [Hz] of readings that the source means to give; 0: not known.
            routine: how takes follow each other; None: as the station does it.
        """
        request = tracker_pb2.StartRecording(
            task=task, tracker=self.name, scene=scene, calibration=calibration, rate=rate
        )
        if routine is not None:
            request.armed, request.takes, request.one_by_one = routine.armed, routine.takes, routine.one_by_one
            if routine.countdown is not None:
                request.countdown = routine.countdown
        answer = self._link.ask(self._keys.recorder_start, request.SerializeToString())
        return tracker_pb2.RecordingReport.FromString(answer)

    def subscribe_feedback(self, receive: Callable[[bytes], object]) -> None:
        """Call `receive` with each `HandFeedback` that the station sends to this tracker."""
        # Zenoh drops a subscriber that nobody keeps.
        self._subscriptions.append(self._link.subscribe(self._keys.feedback(self.name), receive))

    def publish(self, readings: Iterable[HandReading], *, speed: float = 1.0) -> int:
        """Publish readings when they are due, `speed` times as fast as they were taken; return how many.

        The device clock in the samples keeps the readings' own time, from the moment when the first one was there.
        """
        start_ns, start = 0, 0.0
        count = 0
        for reading in readings:
            if count == 0:
                start_ns, start = time.time_ns(), self._clock()
            wait = start + reading.time / speed - self._clock()
            if wait > 0:
                self._sleep(wait)
            self._publisher.put(reading.message(self._next, start_ns).SerializeToString())
            self._next += 1
            count += 1
        return count

    def stop(self, *, discard: bool = False) -> tracker_pb2.RecordingReport:
        """End the recording: name the last sequence number sent and return the station's account."""
        request = tracker_pb2.StopRecording(tracker=self.name, last_sequence=self._next - 1, discard=discard)
        answer = self._link.ask(self._keys.recorder_stop, request.SerializeToString())
        return tracker_pb2.RecordingReport.FromString(answer)
