"""The gate: trackers that come over a WebSocket, from the page above all, join the bus like any other."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, Final

from teachpath.errors import Conflict, UnusableInput, UnusableSample
from teachpath.io.bus import Bus, Handle
from teachpath.io.wire import LARGEST_SAMPLE, parse, report_document, sample_from
from teachpath.recorder.presence import Tracker
from teachpath.recorder.recorder import Recorder
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys, is_name, name_refusal

MAX_TRACKERS: Final = 32  # trackers that may be here at once
RATE_LIMIT: Final = 1000.0  # samples a second in the long run
RATE_BURST: Final = 2000.0  # samples that may come at once, after a pause of the network
MAX_CONSECUTIVE_REJECTS: Final = 100  # refused messages in a row, after which a tracker has to leave

REANNOUNCE_GRACE: Final = 5.0  # [s] a tracker that has just been let out may still be seen on the bus

OnDisconnect = Callable[[str], None]


class WebSocketTrackers:
    """Lets trackers in and out; safe to use from several threads.

    Args:
        recorder: ends recordings with the handshake, and knows which trackers are there without the gate.
        clock: [s] monotonic, for the limit on the rate.
    """

    def __init__(
        self, bus: Bus, keys: Keys, recorder: Recorder, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._bus, self._keys, self._recorder, self._clock = bus, keys, recorder, clock
        self._lock = threading.Lock()
        self._trackers: dict[str, WebSocketTracker] = {}
        self._unregistered: dict[str, float] = {}  # when

    def register(self, name: str, on_disconnect: OnDisconnect) -> WebSocketTracker:
        """Let a tracker in; one of the same name that came through the gate before has to leave.

        Args:
            name: of the tracker, unique at the station.
            on_disconnect: called with a sentence, from any thread, when it has to leave.

        Raises:
            UnusableInput: the name cannot be a key.
            Conflict: a tracker of that name is there without the gate, or too many are here.
        """
        if not is_name(name):
            raise UnusableInput(name_refusal("tracker", name))
        with self._lock:
            before = self._trackers.get(name)
            if before is None:
                self._check_free(name, self._recorder.trackers())
            tracker = WebSocketTracker(self._bus, self._keys, self._recorder, name, on_disconnect, self._clock)
            self._trackers[name] = tracker
        if before is not None:
            before.disconnect(f"another page came as {name}")
        tracker.announce()
        return tracker

    def unregister(self, tracker: WebSocketTracker) -> None:
        """Forget a tracker that has gone; a second call does nothing."""
        with self._lock:
            if self._trackers.get(tracker.name) is tracker:
                del self._trackers[tracker.name]
                recent = {name: at for name, at in self._unregistered.items() if self._clock() - at < REANNOUNCE_GRACE}
                self._unregistered = recent | {tracker.name: self._clock()}
        tracker.withdraw()

    def _check_free(self, name: str, trackers: Sequence[Tracker]) -> None:
        just_left = self._clock() - self._unregistered.get(name, -REANNOUNCE_GRACE) < REANNOUNCE_GRACE
        if not just_left and any(tracker.name == name and tracker.announced for tracker in trackers):
            raise Conflict(f"a tracker {name} is there already, not from a page; choose another name")
        if len(self._trackers) >= MAX_TRACKERS:
            raise Conflict(
                f"{len(self._trackers)} trackers are connected from pages, the most there may be; close some"
            )


class WebSocketTracker:
    """One tracker that came through the gate.

    Attributes:
        name: of the tracker.
        passed: samples that were put on the bus and are sound.
        refused: messages that could not be used.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        recorder: Recorder,
        name: str,
        on_disconnect: OnDisconnect,
        clock: Callable[[], float],
    ) -> None:
        self.name = name
        self.accepted = self.refused = 0
        self._bus, self._recorder, self._clock = bus, recorder, clock
        self._key, self._alive = keys.samples(name), keys.alive("tracker", name)
        self._on_disconnect = on_disconnect
        self._token: Handle | None = None
        self._consecutive_rejects = 0
        self._tokens, self._refilled = RATE_BURST, clock()

    def announce(self) -> None:
        """Show that the tracker is there."""
        self._token = self._bus.announce(self._alive)

    def withdraw(self) -> None:
        """Show that it has gone; a second call does nothing."""
        token, self._token = self._token, None
        if token is not None:
            token.close()

    def disconnect(self, sentence: str) -> None:
        """Tell it to leave, and why."""
        self.withdraw()
        self._on_disconnect(sentence)

    def publish(self, content: bytes | dict[str, Any]) -> str:
        """Put a sample on the bus and return an empty text, or why it was refused.

        What is a `HandSample` with unsound values goes on the bus all the same, as from any other tracker, so that
        the account of the recording holds it as refused.

        Args:
            content: a `HandSample` as protobuf, or as JSON object with the names of its fields.

        Raises:
            UnusableInput: samples come too fast, or too many were refused in a row: the tracker has to leave.
        """
        self._count_rate()
        try:
            message = _message(content)
            self._bus.publish(self._key, message.SerializeToString())
            sample_from(message, self.name, 0)
        except UnusableSample as error:
            return self.refuse(str(error))
        self.accepted += 1
        self._consecutive_rejects = 0
        return ""

    def refuse(self, sentence: str) -> str:
        """Count something that cannot be used and return the sentence; raises UnusableInput as `take` does."""
        self.refused += 1
        self._consecutive_rejects += 1
        if self._consecutive_rejects > MAX_CONSECUTIVE_REJECTS:
            raise UnusableInput(f"{self._consecutive_rejects} messages in a row were refused; the last one: {sentence}")
        return sentence

    def end_recording(self, last_sequence: int, *, discard: bool) -> dict[str, Any]:
        """End the recording of this tracker with the handshake and return its account.

        Raises:
            NotFound: it is not being recorded.
        """
        return report_document(self._recorder.end(self.name, last_sequence=last_sequence, discard=discard))

    def _count_rate(self) -> None:
        now = self._clock()
        self._tokens = min(RATE_BURST, self._tokens + RATE_LIMIT * (now - self._refilled)) - 1.0
        self._refilled = now
        if self._tokens < 0.0:
            raise UnusableInput(f"samples come faster than {RATE_LIMIT:g} a second; slow down")


def _message(content: bytes | dict[str, Any]) -> tracker_pb2.HandSample:
    if isinstance(content, dict):
        try:
            return tracker_pb2.HandSample(**content)
        except (TypeError, ValueError, AttributeError) as error:
            shown = json.dumps(content)[:120]
            raise UnusableSample(f"{shown} is no HandSample: {' '.join(str(error).split())}") from None
    if len(content) > LARGEST_SAMPLE:
        raise UnusableSample(f"a sample of {len(content)} bytes is over the limit of {LARGEST_SAMPLE}")
    try:
        return parse(tracker_pb2.HandSample, content)
    except UnusableInput as error:
        raise UnusableSample(str(error)) from None
