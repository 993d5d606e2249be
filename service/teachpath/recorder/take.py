"""The take that is open: its samples so far, and its file as far as that can be written."""

from __future__ import annotations

import uuid
from collections.abc import Callable

from teachpath.errors import UnusableRecording
from teachpath.io.store.recordings import RecordingFile, RecordingHeader
from teachpath.io.store.store import Store
from teachpath.recorder.take_completion import SegmentedTake, complete_take
from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Sample, StreamStatistics, Trajectory, Vector

FinishedTake = tuple[Demonstration, Trajectory]


class Take:
    """Keeps and writes samples until they become a demonstration or are dropped.

    A file that cannot be written is left as it is, for the doctor; the samples are kept no less.

    Args:
        note: is told what an operator should know.
    """

    def __init__(
        self, store: Store, settings: RecordingSettings, header: RecordingHeader, note: Callable[[str], None]
    ) -> None:
        self._store, self._settings, self._header, self._note = store, settings, header, note
        self.samples: list[Sample] = []
        self.fault = ""  # why nothing is written
        self._id = f"demo-{uuid.uuid4().hex[:12]}"
        self._file: RecordingFile | None = None

    @property
    def seconds(self) -> float:
        """How long it has been going on, by the device's clock."""
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
            self.fail(_cannot("written", error))

    def flush(self) -> None:
        """Hand what was written to the operating system."""
        if self._file is not None:
            try:
                self._file.flush()
            except OSError as error:
                self.fail(_cannot("written", error))

    def fail(self, reason: str) -> None:
        """Write no more of this take, and leave its file as it is."""
        self.fault = reason
        self._note(reason)
        if self._file is not None:
            self._file.leave()
            self._file = None

    def finalize(
        self, cut: TransportSpan, account: StreamStatistics, carried: Vector | None, fault: str
    ) -> FinishedTake | None:
        """Make a demonstration of it; one that cannot be made leaves a note that says why, and no file.

        Args:
            account: of its samples.
            carried: start of the object's centre [m, world], or None.
            fault: why it ended too early, or empty.
        """
        try:
            if self._file is None:
                raise UnusableRecording(f"a demonstration was lost: {self.fault}")
            facts = {"id": self._id, "task": self._header.task, "source": self._header.tracker}
            taken = SegmentedTake(self.samples, cut, account, self._header.calibration, carried, fault)
            return complete_take(self._store, self._settings, self._file, taken, facts)
        except UnusableRecording as error:
            self._note(str(error))
            self.discard()
        except OSError as error:
            self.fail(_cannot("finished", error))
        return None

    def discard(self) -> None:
        """Throw it away."""
        if self._file is not None:
            self._file.discard()
            self._file = None


def _cannot(what: str, error: OSError) -> str:
    return (
        f"the recording cannot be {what}: {error.strerror or error}; free space or mend the folder, then show it again"
    )
