"""Trackers over a WebSocket, mostly hands in a page: their samples go on the bus like those of any other tracker."""

from __future__ import annotations

import hmac
import secrets
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, Final

from teachpath.errors import Conflict, UnusableInput, UnusableSample
from teachpath.io.bus import Bus, Handle
from teachpath.io.wire import decode_sample, recording_document, sample_payload
from teachpath.recorder.presence import Tracker
from teachpath.recorder.recorder import Recorder
from teachpath.records import StopRequest
from teachpath_proto.keys import Keys, is_name, name_refusal

MAX_TRACKERS: Final = 32  # connected at once
RATE_LIMIT: Final = 1000.0  # [1/s] samples in the long run
RATE_BURST: Final = 2000.0  # samples that may come at once, after a pause of the network
MAX_CONSECUTIVE_REJECTS: Final = 100  # messages; a tracker with more is disconnected
REANNOUNCE_GRACE: Final = 5.0  # [s] for which the bus may still show a tracker that has just been unregistered

OnDisconnect = Callable[[str], None]


class WebSocketTrackers:
    """Registers trackers that connect over a WebSocket; safe to use from several threads.

    Args:
        recorder: ends recordings with the handshake, and knows the trackers of the bus.
        clock: [s] monotonic, for the limit on the rate.
    """

    def __init__(
        self, bus: Bus, keys: Keys, recorder: Recorder, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._recorder = recorder
        self._clock = clock
        self._lock = threading.Lock()
        self._trackers: dict[str, WebSocketTracker] = {}
        self._unregistered: dict[str, float] = {}  # by name: when
        self._secret = secrets.token_bytes()  # by which nobody else names himself as the service names them

    def register(
        self, name: str, on_disconnect: OnDisconnect, session: str = "", *, subject: str = ""
    ) -> WebSocketTracker:
        """Register a tracker; an earlier connection of the same session is disconnected.

        All are behind the service's one session on the bus. Where the station knows who somebody is, each sends as a
        source of its own: an arm that one leads follows nobody else who takes the name when it is left.

        Args:
            name: of the tracker, unique at the station.
            on_disconnect: called with a sentence, from any thread, when the tracker is disconnected.
            session: secret of who connects, by which it comes back before its broken connection is given up; empty: it
                has none, and waits for that.
            subject: who it is by token or sign-in; empty where the station asks nobody.

        Raises:
            UnusableInput: the name cannot be a key.
            Conflict: a tracker of that name is there already, from another session, or too many are connected.
        """
        if not is_name(name):
            raise UnusableInput(name_refusal("tracker", name))
        with self._lock:
            before = self._trackers.get(name)
            if before is None:
                self._check_free(name, self._recorder.trackers())
            elif not secrets.compare_digest(before.session.encode(), session.encode()) or not session:
                raise Conflict(f"a tracker {name} is connected already; choose another name")
            source = self._source_of(subject) if subject else None
            tracker = WebSocketTracker(
                self._bus, self._keys, self._recorder, name, on_disconnect, self._clock, session, source
            )
            self._trackers[name] = tracker
        if before is not None:
            before.disconnect(f"{name} has connected again")
        tracker.announce()
        return tracker

    def unregister(self, tracker: WebSocketTracker) -> None:
        """Forget a tracker that has gone; a second call does nothing."""
        with self._lock:
            if self._trackers.get(tracker.name) is tracker:
                del self._trackers[tracker.name]
                now = self._clock()
                recent = {name: at for name, at in self._unregistered.items() if now - at < REANNOUNCE_GRACE}
                self._unregistered = recent | {tracker.name: now}
        tracker.withdraw()

    def _source_of(self, subject: str) -> str:
        """Return by which name a subject sends on the bus, of the form that sessions have."""
        return hmac.digest(self._secret, subject.encode(), "sha256").hex()[:32]

    def _check_free(self, name: str, trackers: Sequence[Tracker]) -> None:
        just_left = self._clock() - self._unregistered.get(name, -REANNOUNCE_GRACE) < REANNOUNCE_GRACE
        if not just_left and any(tracker.name == name for tracker in trackers):
            raise Conflict(f"a tracker {name} is there already, not from a page; choose another name")
        if len(self._trackers) >= MAX_TRACKERS:
            raise Conflict(
                f"{len(self._trackers)} trackers are connected from pages, the most there may be; close some"
            )


class WebSocketTracker:
    """One tracker that is connected over a WebSocket.

    Attributes:
        name: of the tracker.
        session: secret of who is connected; empty when it has none.
        accepted: number of samples that were put on the bus and are sound.
        refused: number of messages that could not be used.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        recorder: Recorder,
        name: str,
        on_disconnect: OnDisconnect,
        clock: Callable[[], float],
        session: str,
        source: str | None,
    ) -> None:
        self.name: str = name
        self.session: str = session
        self.accepted: int = 0
        self.refused: int = 0
        self._bus, self._source = bus, source
        self._recorder = recorder
        self._clock = clock
        self._on_disconnect = on_disconnect
        self._samples_key = keys.samples(name)
        self._liveliness_key = keys.alive("tracker", name)
        self._liveliness: Handle | None = None
        self._consecutive_rejects = 0
        self._tokens = RATE_BURST  # of the token bucket that limits the rate
        self._refilled = clock()

    def announce(self) -> None:
        """Show on the bus that the tracker is there."""
        self._liveliness = self._bus.announce(self._liveliness_key)

    def withdraw(self) -> None:
        """Show on the bus that it has gone; a second call does nothing."""
        liveliness, self._liveliness = self._liveliness, None
        if liveliness is not None:
            liveliness.close()

    def disconnect(self, sentence: str) -> None:
        """Disconnect the tracker and say why."""
        self.withdraw()
        self._on_disconnect(sentence)

    def publish(self, content: bytes | dict[str, Any]) -> str:
        """Put a sample on the bus and return an empty text, or the reason why it was refused.

        A `HandSample` with unsound values goes on the bus all the same, as from any other tracker, so that the
        statistics of the recording count it as refused.

        Args:
            content: a `HandSample` as protobuf, or as JSON object with the names of its fields.

        Raises:
            UnusableInput: samples come too fast, or too many in a row were refused: disconnect the tracker.
        """
        self._limit_rate()
        try:
            payload = sample_payload(content)
            self._bus.publish(self._samples_key, payload, source=self._source)
            decode_sample(self.name, payload, 0)
        except UnusableSample as error:
            return self.refuse(str(error))
        self.accepted += 1
        self._consecutive_rejects = 0
        return ""

    def refuse(self, sentence: str) -> str:
        """Count a message that cannot be used and return the sentence; raises UnusableInput as `publish` does."""
        self.refused += 1
        self._consecutive_rejects += 1
        if self._consecutive_rejects > MAX_CONSECUTIVE_REJECTS:
            raise UnusableInput(f"{self._consecutive_rejects} messages in a row were refused; the last one: {sentence}")
        return sentence

    def end_recording(self, last_sequence: int, *, discard: bool) -> dict[str, Any]:
        """End the recording of this tracker with the handshake and return its report.

        Raises:
            NotFound: it is not being recorded.
        """
        return recording_document(self._recorder.end(StopRequest(self.name, last_sequence, discard)))

    def _limit_rate(self) -> None:
        now = self._clock()
        self._tokens = min(RATE_BURST, self._tokens + RATE_LIMIT * (now - self._refilled)) - 1.0
        self._refilled = now
        if self._tokens < 0.0:
            raise UnusableInput(f"samples come faster than {RATE_LIMIT:g} a second; slow down")
