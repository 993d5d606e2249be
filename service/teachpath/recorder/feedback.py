"""Feedback to the hand while it demonstrates: phase, countdown, takes and verdicts, on a thread of its own.

A receiver may be slow or stuck; neither the recording thread nor the other hands wait for it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable

from teachpath.errors import TeachpathError
from teachpath.io.bus import Bus
from teachpath.io.bus_delivery import Delivery
from teachpath.io.wire import encode_feedback
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Demonstration, RecordingStatus
from teachpath_proto.keys import Keys

POLL_INTERVAL = 0.03  # [s] short enough that a glove lets the hand feel a grasp at once
REPEAT_INTERVAL = 1.0  # [s] after which unchanged feedback is sent again: a hand without feedback is not recorded


class FeedbackPublisher:
    """Publishes the status of each recording when it changes, and once a second.

    Args:
        statuses: returns the status of every running recording.
        demonstration: returns the demonstration of an id.
        clock: [s] monotonic.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        statuses: Callable[[], Iterable[RecordingStatus]],
        demonstration: Callable[[str], Demonstration],
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._statuses = statuses
        self._demonstration = demonstration
        self._clock = clock
        self._published: dict[str, tuple[RecordingStatus, float, bytes]] = {}  # by tracker: status, time, message
        self._thread = PeriodicThread("feedback", POLL_INTERVAL, self.publish_changes)

    def start(self) -> None:
        """Publish from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Publish the last changes and stop; a second call does nothing."""
        if self._thread.is_running:
            self._thread.stop()
            self.publish_changes()

    def publish_changes(self) -> None:
        """Publish each status that has changed since the last call, or was published a second ago."""
        now, statuses = self._clock(), {status.tracker: status for status in self._statuses()}
        for tracker, (before, _, _) in list(self._published.items()):
            if tracker not in statuses:
                del self._published[tracker]
                ended = RecordingStatus(before.task, tracker, None, None, demonstrations=before.demonstrations)
                self._publish(tracker, self._message(ended))
        for tracker, status in statuses.items():
            last, at, message = self._published.get(tracker, (None, now, b""))
            # The one that was published is the same object while nothing has changed.
            changed = last is not status and (last is None or _visible(last) != _visible(status))
            if changed or now - at >= REPEAT_INTERVAL:
                message = self._message(status) if changed else message
                self._published[tracker] = (status, now, message)
                self._publish(tracker, message)

    def _publish(self, tracker: str, message: bytes) -> None:
        self._bus.publish(self._keys.feedback(tracker), message, delivery=Delivery.DROPS)

    def _message(self, status: RecordingStatus) -> bytes:
        return encode_feedback(status, self._newest(status))

    def _newest(self, status: RecordingStatus) -> Demonstration | None:
        try:
            return self._demonstration(status.demonstrations[-1]) if status.demonstrations else None
        except TeachpathError:  # its row is not stored yet, or no longer: the hand gets the rest of the feedback
            return None


def _visible(status: RecordingStatus) -> tuple[object, ...]:
    """Return what of a status is published when it changes; of the countdown, each second that begins."""
    return (
        status.phase,
        status.state,
        math.ceil(status.countdown_left),
        status.takes_left,
        status.demonstrations[-1:],
        status.pending_command,
        status.hint,
    )
