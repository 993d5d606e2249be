"""One recording that is running: a take, its account and its phases."""

from __future__ import annotations

import time
import uuid
from dataclasses import replace

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.documents import encode
from teachpath.io.store import RecordingHeader, Store, Take
from teachpath.io.wire import encode_report
from teachpath.recording import (
    Cut,
    RecordingSettings,
    Segmenter,
    StreamAccount,
    judge,
    object_trajectory,
    to_world,
)
from teachpath.records import Calibration, Demonstration, Phase, Sample, Scene, Trajectory
from teachpath_proto import tracker_pb2

Finished = tuple[Demonstration, Trajectory]


class RecordingSession:
    """Writes the samples of one tracker and cuts them; not thread-safe, its owner locks."""

    def __init__(
        self,
        store: Store,
        settings: RecordingSettings,
        *,
        task: str,
        tracker: str,
        calibration: Calibration,
        scene: Scene,
    ) -> None:
        self.task, self.tracker, self.calibration = task, tracker, calibration
        self.account = StreamAccount()  # of the whole recording
        self._store, self._settings = store, settings
        self._carried = scene.carried.position if scene.carried else None
        self._segmenter = Segmenter(settings, self._carried)
        self._demonstrations: list[str] = []
        self._idle = 0
        self._fault = ""
        self._torn = False
        self._take: Take | None = None
        self._samples: list[Sample] = []
        self._part = StreamAccount()  # of the take that is open

    def add(self, sample: Sample) -> Finished | None:
        """Write one sample; return the demonstration that it completes."""
        fresh = self.account.observe(sample)
        self._part.observe(sample)
        self._write(sample)
        self._samples.append(sample)
        if not fresh:
            self._segmenter.pass_over()
            return None
        cut = self._segmenter.push(sample, to_world(self.calibration, np.array(sample.position)))
        if cut is not None:
            return self._close(cut)
        if self._segmenter.phase is Phase.REACH and self._reaches_too_long():
            self._drop()
        return None

    def refuse(self, reason: str) -> None:
        """Count a payload that is no sample."""
        self.account.refuse(reason)
        self._part.refuse(reason)

    def expect(self, last_sequence: int) -> None:
        """Count as lost what was sent up to `last_sequence` and did not come."""
        self.account.expect(last_sequence)
        if self._part.first is not None:
            self._part.expect(last_sequence)

    def remark(self, sentence: str) -> None:
        """Keep a sentence with the recording and its open demonstration."""
        self.account.note(sentence)
        self._part.note(sentence)

    def flush(self) -> None:
        """Hand what was written to the operating system."""
        if self._take is not None:
            try:
                self._take.flush()
            except OSError as error:
                self.fail(f"the recording cannot be written: {error}")

    def finish(self, *, discard: bool = False, torn: bool = False) -> list[Finished]:
        """End the recording; return the demonstration that its end completes, if there is one.

        Args:
            discard: throw away the demonstration that is still open.
            torn: the stream was cut off, so a hand that is still closed was never seen to release.
        """
        self._torn = torn
        cut = None if discard else self._segmenter.finish()
        finished = self._close(cut) if cut is not None else None
        self._drop()
        return [finished] if finished else []

    def report(self, *, ended: bool = False) -> tracker_pb2.RecordingReport:
        """Return the account of this recording so far."""
        phase = "" if ended else self._segmenter.phase.value
        return encode_report(
            self.task, self.tracker, self._demonstrations, self.account.account(), phase=phase, idle=self._idle
        )

    def fail(self, reason: str) -> None:
        """Stop writing the open take and leave its file as it is; the next one is tried again."""
        self._fault = reason
        self.account.note(reason)
        if self._take is not None:
            self._take.leave()
            self._take = None

    def _write(self, sample: Sample) -> None:
        if self._fault:
            return
        try:
            if self._take is None:
                self._id = f"demo-{uuid.uuid4().hex[:12]}"
                header = RecordingHeader(self.task, self.tracker, self.calibration)
                self._take = self._store.recordings.begin(self._id, header)
            self._take.write(sample)
        except OSError as error:
            self.fail(f"the recording cannot be written: {error}")

    def _reaches_too_long(self) -> bool:
        reach_ns = self._samples[-1].device_ns - self._samples[0].device_ns
        return reach_ns > self._settings.longest_reach * 1e9

    def _close(self, cut: Cut) -> Finished | None:
        """Finish the take as a demonstration; a take that cannot be one is dropped, with a note that says why."""
        try:
            if self._take is None:
                raise UnusableRecording(f"a demonstration was lost: {self._fault}")
            if cut.release - cut.grasp < self._settings.shortest_transport:
                raise UnusableRecording(
                    f"a transport phase of {cut.release - cut.grasp} samples is under the least of "
                    f"{self._settings.shortest_transport}: the object was let go at once"
                )
            trajectory = object_trajectory(self._samples, cut, self.calibration, self._carried)
        except UnusableRecording as error:
            self.account.note(str(error))
            self._drop()
            return None
        try:
            demonstration = self._store.add_demonstration(self._finish_take(self._take, cut, trajectory))
        except OSError as error:
            self.fail(f"the recording cannot be finished: {error}")
            self._drop()
            return None
        self._demonstrations.append(demonstration.id)
        self._open_next()
        return demonstration, trajectory

    def _finish_take(self, take: Take, cut: Cut, trajectory: Trajectory) -> Demonstration:
        account = self._part.account()
        verdict = judge(account, self._settings)
        # A device without a glove lets go by ending its recording; a glove would have shown the release.
        if cut.open_ended and (self._torn or self._samples[-1].flexions):
            verdict = "reject"
            account = replace(
                account, notes=(*account.notes, "the recording ended before the hand let go")
            )
        file = take.finish({"verdict": verdict, "account": encode(account).decode()})
        return Demonstration(
            id=self._id,
            task=self.task,
            number=0,
            source=self.tracker,
            calibration=self.calibration,
            created_ns=time.time_ns(),
            duration=float(trajectory.times[-1]),
            samples=len(self._samples),
            grasp=cut.grasp,
            release=cut.release,
            verdict=verdict,
            account=account,
            recording=self._store.recordings.place(file),
        )

    def _drop(self) -> None:
        if self._take is not None:
            self._take.discard()
        self._idle += len(self._samples)
        self._open_next()

    def _open_next(self) -> None:
        self._take = None
        self._fault = ""
        self._samples = []
        self._part = StreamAccount()
        self._segmenter = Segmenter(self._settings, self._carried)
