"""A running recording that a service which stops leaves, and that the next one goes on with."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.store import Store
from teachpath.recorder.closed_take import Completer
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.run_session import RunSession
from teachpath.recorder.take import FinishedTake
from teachpath.recording.sample_runs import SampleBlock, SampleRun
from teachpath.recording.settings import RecordingSettings
from teachpath.records import RecordingRequest, Sample, SuspendedRecording, Vector


class SuspendableSession(RunSession):
    """A recording session whose take in the hand outlasts its service.

    The samples of that take are recorded again from its file, so that its phases and its statistics are what they would
    be without the stop, whatever version of the service made the file.

    Attributes:
        is_waiting: what its tracker sent while no service ran is still awaited; its queue waits meanwhile.
    """

    def __init__(
        self,
        store: Store,
        settings: RecordingSettings,
        setup: RecordingSetup,
        *,
        completer: Completer | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(store, settings, setup, completer=completer, clock=clock)
        self.is_waiting: bool = False
        self.last: tuple[int, int] | None = None
        self._suspended_take = ""
        self._is_replaying = False

    def add(self, sample: Sample, payload: bytes = b"") -> FinishedTake | None:
        """Write one sample, as `RecordingSession.add`."""
        self.last = sample.sequence, sample.device_ns
        return super().add(sample, payload)

    def add_run(self, block: SampleBlock, run: SampleRun, begin: int, payloads: Sequence[bytes]) -> int:
        """Write samples of a run, as `RunSession.add_run`."""
        count = super().add_run(block, run, begin, payloads)
        if count:
            self.last = block.sequence[begin + count - 1], block.device_ns[begin + count - 1]
        return count

    def suspend(self) -> None:
        """End here, and leave the take in the hand for the next service; one whose object was released is completed."""
        if self._segmenter.phase.has_object:
            self._suspended_take = self._take.suspend()
        if not self._suspended_take:
            self.finish()

    def snapshot(self) -> SuspendedRecording:
        """Return what the next service needs to go on; after `suspend`, and when all takes are settled."""
        setup = self._setup
        request = RecordingRequest(
            setup.task, setup.tracker, setup.calibration.name, rate=setup.rate, routine=setup.routine
        )
        take = self._suspended_take
        found = SuspendedRecording(
            request, self.state, tuple(self.demonstrations), self._state_machine.made, self.last, take
        )
        if not take:
            return found
        phase, grasp = self._segmenter.phase, self._segmenter.grasp
        return replace(found, phase=phase, grasp=grasp, object_pose=self._object.pose)

    @property
    def header(self) -> RecordingHeader:
        """What its takes are of."""
        return self._setup.header(self._object)

    def go_on(self, before: SuspendedRecording, taken: Sequence[tuple[Sample, bytes]]) -> bool:
        """Go on with a recording that was left, and wait for its tracker.

        Args:
            before: the recording.
            taken: samples of its take in the hand, each as it came, too.

        Returns:
            Whether the take stands where it stood.
        """
        self._state_machine.restore(before.state, before.made, self._clock())
        self.demonstrations += before.demonstrations
        self._is_replaying = True
        for sample, payload in taken:
            self.add(sample, payload)
        self._is_replaying = False
        self.last, self.is_waiting = before.last, True
        self.flush(self._clock())
        return not taken or (self._segmenter.phase, self._segmenter.grasp) == (before.phase, before.grasp)

    def _follow_commands(self, sample: Sample, position: Vector) -> None:
        if self._is_replaying:  # they were followed then
            self._commands.skip(sample)
        else:
            super()._follow_commands(sample, position)
