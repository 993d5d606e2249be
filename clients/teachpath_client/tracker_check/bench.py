"""The bus on which a tracker is checked: the check takes the station's place, and the tracker connects to it."""

from __future__ import annotations

import json
import sys
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, Final

import zenoh

from teachpath_client.errors import ClientError
from teachpath_client.tracker_check.rules import Observation, Received, verdicts
from teachpath_client.verdict import print_verdicts
from teachpath_proto.keys import Keys
from teachpath_proto.sessions import listening, open_session
from teachpath_proto.tracker_pb2 import HandFeedback, RecordingReport, StartRecording, StopRecording

FEEDBACK_INTERVAL: Final = 0.2  # [s]
MAX_SAMPLES: Final = 200_000  # of one check: over an hour at 50 a second
STOP_GRACE: Final = 0.5  # [s] after the end, for what is still under way


class TrackerBench:
    """Listens at an endpoint for one tracker, and answers it as a recorder does; use it as a context manager.

    Args:
        endpoint: where it listens.
        prefix: of the keys.

    Attributes:
        seen: what came.
        ended: set when the tracker has ended its recording or has gone.

    Raises:
        ClientError: it cannot listen there.
    """

    def __init__(self, endpoint: str, prefix: str) -> None:
        self._keys = Keys(prefix)
        self.seen: Observation = Observation()
        self.ended: threading.Event = threading.Event()
        try:
            self._session = open_session(listening([endpoint]))
        except zenoh.ZError as error:
            raise ClientError(f"cannot listen at {endpoint}: is a station running there? ({error})") from error
        self._handles: list[Any] = [
            self._session.declare_subscriber(self._keys.all_samples, self._receive),
            self._session.liveliness().declare_subscriber(self._keys.all_trackers_alive, self._announce, history=True),
            self._serve(self._keys.recorder_start, self._start),
            self._serve(self._keys.recorder_stop, self._stop),
        ]

    def __enter__(self) -> TrackerBench:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def send_feedback(self) -> None:
        """Tell the tracker that it is recorded, as a station does."""
        if self.seen.received:
            task = self.seen.started.task if self.seen.started is not None else ""
            feedback = HandFeedback(task=task, phase="reach", state="recording")
            self._session.put(self._keys.feedback(self.seen.received[0].tracker), feedback.SerializeToString())

    # on the transport's threads

    def _receive(self, sample: zenoh.Sample) -> None:
        if len(self.seen.received) < MAX_SAMPLES:
            blocks = sample.congestion_control == zenoh.CongestionControl.BLOCK
            tracker = self._keys.tracker_of(str(sample.key_expr))
            self.seen.received.append(Received(tracker, sample.payload.to_bytes(), time.time_ns(), blocks))

    def _announce(self, sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.PUT:
            self.seen.announced.add(self._keys.announced(str(sample.key_expr)))
        elif self.seen.received:
            self.ended.set()

    def _start(self, payload: bytes) -> RecordingReport:
        request = StartRecording.FromString(payload)
        if not request.task or not request.tracker:
            raise ValueError(f"a start names task and tracker; this one names {request.task!r} and {request.tracker!r}")
        self.seen.started = request
        return RecordingReport(task=request.task, tracker=request.tracker, phase="reach", state="recording")

    def _stop(self, payload: bytes) -> RecordingReport:
        request = StopRecording.FromString(payload)
        self.seen.stopped = request
        self.ended.set()
        return RecordingReport(tracker=request.tracker, received=len(self.seen.received))

    def _serve(self, key: str, answer: Callable[[bytes], RecordingReport]) -> Any:
        def reply(query: zenoh.Query) -> None:
            """Answer a query of the tracker, by the fault where there is one."""
            with query:
                try:
                    payload = query.payload.to_bytes() if query.payload is not None else b""
                    query.reply(key, answer(payload).SerializeToString())
                except Exception as error:  # whatever the parser raises: the tracker should be told
                    query.reply_err(json.dumps({"error": "UnusableInput", "message": str(error)}).encode())

        return self._session.declare_queryable(key, reply)


def check_tracker(endpoint: str, prefix: str, *, seconds: float) -> bool:
    """Check the tracker that connects to `endpoint`, and print a verdict for every rule; return whether it keeps all.

    Args:
        endpoint: where the check listens.
        prefix: of the keys.
        seconds: it ends so long after the first sample [s], where the tracker does not end before.
    """
    with TrackerBench(endpoint, prefix) as bench:
        print(f"waiting for a tracker: start it with --endpoint {endpoint} (Ctrl-C ends)", file=sys.stderr)
        while not bench.seen.received and not bench.ended.wait(FEEDBACK_INTERVAL):
            pass
        print("it sends; close the hand, carry it on for a second or more, and open it", file=sys.stderr)
        end = time.monotonic() + seconds
        while time.monotonic() < end and not bench.ended.wait(FEEDBACK_INTERVAL):
            bench.send_feedback()
        time.sleep(STOP_GRACE)
    return print_verdicts(verdicts(bench.seen))
