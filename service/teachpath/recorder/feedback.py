"""What a hand is told while it demonstrates: phase, countdown, takes and verdicts, on a thread of its own.

Whoever listens may be slow or stuck; the recorder's thread never waits for it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from teachpath.errors import TeachpathError
from teachpath.io.bus import Bus
from teachpath.io.wire import encode_feedback
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Demonstration, Phase
from teachpath_proto.keys import Keys

POLL_INTERVAL = 0.03  # [s] between looks: what a hand feels it should feel at once
REPEAT_INTERVAL = 1.0  # [s] after which the same is said again: a hand that hears nothing knows that nobody records it
HOLDING = (Phase.GRASP, Phase.TRANSPORT)


@dataclass(frozen=True, slots=True)
class Standing:
    """How the recording of one tracker stands."""

    tracker: str
    task: str
    phase: str
    state: str
    countdown_left: float = 0.0
    takes_left: int = 0
    takes: int = 0
    newest: str = ""  # id of the last demonstration
    sign: str = ""

    @property
    def told_as(self) -> tuple[object, ...]:
        """What of it is worth telling when it changes: of the countdown each second that begins."""
        return (self.phase, self.state, math.ceil(self.countdown_left), self.takes_left, self.newest, self.sign)


class FeedbackPublisher:
    """Publishes how each recording stands, whenever that changes and once a second.

    Args:
        standings: gives how the running recordings stand.
        demonstration: gives the demonstration of an id.
        clock: [s] monotonic.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        standings: Callable[[], Iterable[Standing]],
        demonstration: Callable[[str], Demonstration],
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._bus, self._keys, self._clock = bus, keys, clock
        self._standings, self._demonstration = standings, demonstration
        self._told: dict[str, tuple[Standing, float, bytes]] = {}  # by tracker, what was said when
        self._thread = PeriodicThread("feedback", POLL_INTERVAL, self.publish_changes)

    def start(self) -> None:
        """Publish from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Publish what has changed last, and stop; a second call does nothing."""
        if self._thread.is_running:
            self._thread.stop()
            self.publish_changes()

    def publish_changes(self) -> None:
        """Publish what has changed since the last look, and what was not said for a second."""
        now, standings = self._clock(), {standing.tracker: standing for standing in self._standings()}
        for tracker, (before, _, _) in list(self._told.items()):
            if tracker not in standings:
                del self._told[tracker]
                ended = Standing(tracker, before.task, "", "", takes=before.takes, newest=before.newest)
                self._tell(tracker, self._said(ended))
        for tracker, standing in standings.items():
            last, at, said = self._told.get(tracker, (None, now, b""))
            changed = last is None or last.told_as != standing.told_as
            if changed or now - at >= REPEAT_INTERVAL:
                said = self._said(standing) if changed else said
                self._told[tracker] = (standing, now, said)
                self._tell(tracker, said)

    def _tell(self, tracker: str, said: bytes) -> None:
        self._bus.publish(self._keys.feedback(tracker), said)

    def _said(self, standing: Standing) -> bytes:
        return encode_feedback(
            self._newest(standing.newest),
            task=standing.task,
            phase=standing.phase,
            state=standing.state,
            holding=standing.phase in HOLDING,
            countdown_left=standing.countdown_left,
            takes_left=standing.takes_left,
            takes=standing.takes,
            sign=standing.sign,
        )

    def _newest(self, key: str) -> Demonstration | None:
        try:
            return self._demonstration(key) if key else None
        except TeachpathError:  # its row is not there yet, or no longer: the hand is told the rest
            return None
