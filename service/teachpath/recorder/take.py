"""One take: the samples that may become a demonstration, and their file as far as it can be written."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from teachpath.errors import UnusableRecording
from teachpath.io.store.recordings import RecordingFile
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.sample_rows import SampleRows
from teachpath.io.store.store import Store
from teachpath.recorder.take_completion import SegmentedTake, complete_take
from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, ObjectPose, Sample, SampleColumns, StreamStatistics, Trajectory, Vector

FinishedTake = tuple[Demonstration, Trajectory]


@dataclass(frozen=True, slots=True)
class TakeOutcome:
    """What became of a take that was completed: a demonstration, or sentences for the operator why there is none yet.

    Attributes:
        row_waits: its recording is whole, and its row is stored later.
    """

    finished: FinishedTake | None
    notes: tuple[str, ...] = ()
    row_waits: bool = False


def random_id() -> str:
    """Return a new id of a demonstration."""
    return f"demo-{uuid.uuid4().hex[:12]}"


class Take:
    """Keeps and writes samples until they become a demonstration or are discarded.

    A file that cannot be written any more is left as it is, for the doctor; the samples are kept all the same.

    Args:
        note: called with sentences for the operator.
        new_id: returns the id of the demonstration that it may become.

    Attributes:
        samples: in the order received.
        fault: why nothing is written, or empty.
    """

    def __init__(
        self,
        store: Store,
        settings: RecordingSettings,
        header: RecordingHeader,
        note: Callable[[str], None],
        new_id: Callable[[], str] = random_id,
    ) -> None:
        self._store = store
        self._settings = settings
        self._header = header
        self._note = note
        self.samples: SampleRows = SampleRows()
        self._times: tuple[int, int, int, int] | None = None  # device_ns, receive_ns of the first and the last sample
        self.fault: str = ""
        self._id = new_id()
        self._file: RecordingFile | None = None

    @property
    def seconds(self) -> float:
        """Duration so far, by the device's clock."""
        return self.seconds_until(self._times[2]) if self._times else 0.0

    @property
    def seconds_received(self) -> float:
        """Duration so far, by our clock."""
        return (self._times[3] - self._times[1]) * 1e-9 if self._times else 0.0

    def seconds_until(self, device_ns: int) -> float:
        """Return its duration up to a time, by the device's clock; 0 before its first sample."""
        return (device_ns - self._times[0]) * 1e-9 if self._times else 0.0

    def write(self, sample: Sample, payload: bytes) -> None:
        """Add a sample, `payload` as it came."""
        self._keep_times(sample.device_ns, sample.receive_ns, sample.device_ns, sample.receive_ns)
        self.samples.append(sample)
        self._to_file(lambda file: file.write(sample, payload))

    def write_run(self, samples: SampleColumns, payloads: Sequence[bytes]) -> None:
        """Add samples, of which there is at least one, `payloads` as they came."""
        device_ns, receive_ns = samples.device_ns, samples.receive_ns
        self._keep_times(int(device_ns[0]), int(receive_ns[0]), int(device_ns[-1]), int(receive_ns[-1]))
        self.samples.extend(samples)
        self._to_file(lambda file: file.write_run(samples, payloads))

    def _keep_times(self, device_ns: int, receive_ns: int, last_device_ns: int, last_receive_ns: int) -> None:
        first = self._times[:2] if self._times else (device_ns, receive_ns)
        self._times = (*first, last_device_ns, last_receive_ns)

    def _to_file(self, write: Callable[[RecordingFile], None]) -> None:
        if self.fault:
            return
        try:
            if self._file is None:
                self._file = self._store.recordings.begin(self._id, self._header)
            write(self._file)
        except OSError as error:
            self.fail(_disk_fault("written", error))

    def flush(self) -> None:
        """Hand all that was written to the operating system."""
        if self._file is not None:
            try:
                self._file.flush()
            except OSError as error:
                self.fail(_disk_fault("written", error))

    def fail(self, reason: str) -> None:
        """Write no more of this take, and leave its file as it is."""
        self._leave(reason)
        self._note(reason)

    def suspend(self) -> str:
        """Leave its file for the service's next start; return its id, or nothing where its file cannot be written."""
        if self._file is None:
            return ""
        try:
            self._file.suspend()
        except OSError as error:
            self.fail(_disk_fault("written", error))
            return ""
        self._file = None
        return self._id

    def can_be_finalized(self, cut: TransportSpan) -> bool:
        """Tell whether a demonstration will come of it, as far as that is known before it is finalized."""
        return self._file is not None and cut.release - cut.grasp >= self._settings.shortest_transport

    def finalize(
        self,
        cut: TransportSpan,
        statistics: StreamStatistics,
        carried: Vector | None,
        object_pose: ObjectPose | None,
        fault: str,
    ) -> TakeOutcome:
        """Finish its file and make its demonstration, which is still to be stored; or say why not, and leave no file.

        Nothing may be written meanwhile. It may be called on another thread, because it changes this take alone.

        Args:
            cut: its transport phase.
            statistics: of its samples.
            carried: start of the object's centre [m, world], or None.
            object_pose: of the object before it was grasped; None = where the scene has it.
            fault: why the take ended too early, or empty.
        """
        try:
            if self._file is None:
                raise UnusableRecording(f"a demonstration was lost: {self.fault}")
            identity = {"id": self._id, "task": self._header.task, "source": self._header.tracker}
            samples, calibration = self.samples.arrays(), self._header.calibration
            take = SegmentedTake(samples, cut, statistics, calibration, carried, object_pose, fault)
            return TakeOutcome(complete_take(self._store.recordings, self._settings, self._file, take, identity))
        except UnusableRecording as error:
            self.discard()
            if self.fault:
                self._note_lost(f"its file could not be written ({self.fault})")
            return TakeOutcome(None, (str(error),))
        except OSError as error:
            return self.lose(_disk_fault("finished", error))

    def lose(self, fault: str) -> TakeOutcome:
        """Make no demonstration because of a fault, and leave the file for the doctor."""
        self._leave(fault)
        self._note_lost(fault)
        return TakeOutcome(None, (fault,))

    def _leave(self, fault: str) -> None:
        self.fault = fault
        if self._file is not None:
            self._file.leave()
            self._file = None

    def _note_lost(self, reason: str) -> None:
        header = self._header
        self._store.health.note_lost(f"take {self._id} of {header.task} by {header.tracker} was not kept: {reason}")

    def discard(self) -> None:
        """Throw the file away."""
        if self._file is not None:
            self._file.discard()
            self._file = None


def _disk_fault(what: str, error: OSError) -> str:
    return (
        f"the recording cannot be {what}: {error.strerror or error}; free space or mend the folder, then show it again"
    )
