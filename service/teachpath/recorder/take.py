"""One take: the samples that may become a demonstration, and their file as far as it can be written."""

from __future__ import annotations

import uuid
from collections.abc import Callable

from teachpath.errors import StorageUnavailable, UnusableRecording
from teachpath.io.store.recordings import RecordingFile, RecordingHeader
from teachpath.io.store.store import Store
from teachpath.recorder.object_place import ObjectPlace
from teachpath.recorder.take_completion import SegmentedTake, complete_take
from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Sample, StreamStatistics, Trajectory

FinishedTake = tuple[Demonstration, Trajectory]


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
        self.samples: list[Sample] = []
        self.fault = ""
        self._id = new_id()
        self._file: RecordingFile | None = None

    @property
    def seconds(self) -> float:
        """Duration so far, by the device's clock."""
        return (self.samples[-1].device_ns - self.samples[0].device_ns) * 1e-9 if self.samples else 0.0

    def write(self, sample: Sample, payload: bytes) -> None:
        """Add a sample, `payload` as it came."""
        self.samples.append(sample)
        if self.fault:
            return
        try:
            if self._file is None:
                self._file = self._store.recordings.begin(self._id, self._header)
            self._file.write(sample, payload)
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
        self.fault = reason
        self._note(reason)
        if self._file is not None:
            self._file.leave()
            self._file = None

    def finalize(
        self, cut: TransportSpan, statistics: StreamStatistics, place: ObjectPlace, fault: str
    ) -> FinishedTake | None:
        """Make and store its demonstration; if that is impossible, note why, and leave no file.

        Args:
            cut: its transport phase.
            statistics: of its samples.
            place: where the object was grasped.
            fault: why the take ended too early, or empty.
        """
        try:
            if self._file is None:
                raise UnusableRecording(f"a demonstration was lost: {self.fault}")
            identity = {"id": self._id, "task": self._header.task, "source": self._header.tracker}
            take = SegmentedTake(
                self.samples, cut, statistics, self._header.calibration, place.start, place.pose, fault
            )
            return complete_take(self._store, self._settings, self._file, take, identity)
        except UnusableRecording as error:
            self._note(str(error))
            self.discard()
            if self.fault:
                self._note_lost(f"its file could not be written ({self.fault})")
        except OSError as error:
            self.fail(_disk_fault("finished", error))
            self._note_lost(self.fault)
        except StorageUnavailable as error:
            self.fail(f"the recording is whole, and its row could not be stored: {error}")
            self._note_lost(f"its recording is whole, but {error}; its row is made by: teachpath doctor")
        return None

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
