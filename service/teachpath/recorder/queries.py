"""The recorder as Zenoh queries: what REST can ask of recordings and demonstrations, trackers can ask too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teachpath.errors import UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.wire import encode_demonstration, parse
from teachpath.recorder.annotations import Amendment
from teachpath.recording.state_machine import Routine
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys

if TYPE_CHECKING:  # the recorder opens its own queries
    from teachpath.recorder.recorder import Recorder


class RecorderQueries:
    """Answers the queries under `recorder/`."""

    def __init__(self, bus: Bus, keys: Keys, recorder: Recorder) -> None:
        self._bus, self._keys, self._recorder, self._curation = bus, keys, recorder, recorder.annotations
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Answer from now on."""
        answers = {
            self._keys.recorder_start: self._start,
            self._keys.recorder_stop: self._stop,
            self._keys.recorder_pause: self._pause,
            self._keys.recorder_resume: self._resume,
            self._keys.recorder_discard: self._discard,
            self._keys.recorder_restore: self._restore,
            self._keys.recorder_amend: self._amend,
            self._keys.recorder_status: self._status,
        }
        self._handles = [self._bus.serve(key, answer) for key, answer in answers.items()]

    def stop(self) -> None:
        """Answer no more; a second call does nothing."""
        for handle in self._handles:
            handle.close()
        self._handles.clear()

    def _start(self, payload: bytes) -> bytes:
        request = parse(tracker_pb2.StartRecording, payload)
        return self._recorder.begin(
            request.task,
            request.tracker,
            calibration=request.calibration,
            scene=request.scene,
            rate=request.rate,
            routine=Routine(
                armed=request.armed,
                countdown=request.countdown if request.HasField("countdown") else None,
                takes=request.takes,
                one_by_one=request.one_by_one,
            ),
        ).SerializeToString()

    def _stop(self, payload: bytes) -> bytes:
        request = parse(tracker_pb2.StopRecording, payload)
        return self._recorder.end(
            request.tracker, last_sequence=request.last_sequence, discard=request.discard
        ).SerializeToString()

    def _pause(self, payload: bytes) -> bytes:
        return self._recorder.pause(parse(tracker_pb2.PauseRecording, payload).tracker).SerializeToString()

    def _resume(self, payload: bytes) -> bytes:
        return self._recorder.resume(parse(tracker_pb2.PauseRecording, payload).tracker).SerializeToString()

    def _discard(self, payload: bytes) -> bytes:
        return encode_demonstration(self._curation.discard_last(self._task(payload)))

    def _restore(self, payload: bytes) -> bytes:
        return encode_demonstration(self._curation.restore_last(self._task(payload)))

    def _amend(self, payload: bytes) -> bytes:
        request = parse(tracker_pb2.AmendDemonstration, payload)
        return encode_demonstration(
            self._curation.amend(
                request.demonstration,
                Amendment(
                    mark=request.mark if request.HasField("mark") else None,
                    discarded=request.discarded if request.HasField("discarded") else None,
                    trim=(request.trim.begin, request.trim.end) if request.HasField("trim") else None,
                ),
            )
        )

    def _status(self, _: bytes) -> bytes:
        return tracker_pb2.RecorderStatus(recordings=self._recorder.reports()).SerializeToString()

    def _task(self, payload: bytes) -> str:
        request = parse(tracker_pb2.PickDemonstration, payload)
        if not request.task and not request.tracker:
            raise UnusableInput("name the task, or a tracker that is recording it")
        return request.task or self._recorder.task_of(request.tracker)
