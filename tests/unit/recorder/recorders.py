"""A recorder on an in-memory bus for tests, with a clock of its own."""

from collections.abc import Callable
from typing import Any

from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.store import Store
from teachpath.io.wire import encode_sample
from teachpath.recorder.queries import RecorderQueries
from teachpath.recorder.recorder import Recorder
from teachpath.recorder.recording_setup import DemonstrationCallbacks, Lookup
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Sample, Scene, Shape, Trajectory
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys
from tests.waiting import wait_until

KEYS = Keys("test")
SCENE = Scene("paper", (), Shape("block", "box", (0.04, 0.04, 0.04), (0.5, 0.0, 0.48)))


class Bench:
    """A recorder on an in-memory bus, and a tracker that speaks to it.

    Args:
        bus: of a recorder that was stopped, whose trackers have stayed; None: a new one.
    """

    def __init__(
        self, store: Store, *, recorded: Callable[..., None] | None = None, bus: MemoryBus | None = None
    ) -> None:
        self.bus, self.store = bus or MemoryBus(), store
        self.recorded: list[tuple[Demonstration, Trajectory]] = []
        self.changed: list[Demonstration] = []
        self.now = 0.0  # [s]
        self.recorder = Recorder(
            self.bus,
            KEYS,
            store,
            RecordingSettings(handshake_timeout=1.0),
            Lookup(scene=lambda name: {"paper": SCENE}[name], calibration=Calibration),
            DemonstrationCallbacks(recorded or (lambda *made: self.recorded.append(made)), self.changed.append),
            clock=lambda: self.now,
        )
        self._queries = RecorderQueries(self.bus, KEYS, self.recorder)
        self.recorder.start()
        self._queries.start()

    def send(self, samples: list[Sample], tracker: str = "glove") -> None:
        for s in samples:
            self.bus.publish(KEYS.samples(tracker), encode_sample(s))

    def begin(self, tracker: str = "glove", task: str = "lift", **wishes: Any) -> None:
        request = tracker_pb2.StartRecording(task=task, tracker=tracker, scene="paper", **wishes)
        self.bus.ask(KEYS.recorder_start, request.SerializeToString())

    def end(self, last: int, tracker: str = "glove", *, discard: bool = False) -> tracker_pb2.RecordingReport:
        request = tracker_pb2.StopRecording(tracker=tracker, last_sequence=last, discard=discard)
        answer = self.bus.ask(KEYS.recorder_stop, request.SerializeToString())
        return tracker_pb2.RecordingReport.FromString(answer)

    def reports(self) -> list[tracker_pb2.RecordingReport]:
        return list(tracker_pb2.RecorderStatus.FromString(self.bus.ask(KEYS.recorder_status)).recordings)

    def received(self, count: int, tracker: str = "glove") -> tracker_pb2.RecordingReport:
        """Return the report of a running recording as soon as `count` samples, and their takes, are in it."""
        return self.until(lambda report: report.received >= count, tracker)

    def until(
        self,
        true: Callable[[tracker_pb2.RecordingReport], bool],
        tracker: str = "glove",
        *,
        settled: bool = True,
    ) -> tracker_pb2.RecordingReport:
        """Return the report of a running recording as soon as it is so, and with `settled` its takes are stored."""

        def found() -> tracker_pb2.RecordingReport | None:
            (report,) = (r for r in self.reports() if r.tracker == tracker)
            return report if true(report) else None

        assert wait_until(found, "the recording is so") is not None
        if settled:
            self.recorder.wait_for_takes()
        report = found()
        assert report is not None
        return report
