"""The recorder as Zenoh queries: what REST can ask of recordings and demonstrations, trackers can ask too."""

from __future__ import annotations

from teachpath.errors import UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.wire import (
    decode_amendment,
    decode_recording_request,
    decode_stop_request,
    decode_task_reference,
    decode_tracker,
    encode_demonstration,
    encode_recorder_status,
    encode_recording_status,
)
from teachpath.recorder.recorder import Recorder
from teachpath_proto.keys import Keys


class RecorderQueries:
    """Answers the queries under `recorder/`."""

    def __init__(self, bus: Bus, keys: Keys, recorder: Recorder) -> None:
        self._bus = bus
        self._keys = keys
        self._recorder = recorder
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
        """Stop answering; a second call does nothing."""
        for handle in self._handles:
            handle.close()
        self._handles.clear()

    def _start(self, payload: bytes) -> bytes:
        return encode_recording_status(self._recorder.begin(decode_recording_request(payload)))

    def _stop(self, payload: bytes) -> bytes:
        return encode_recording_status(self._recorder.end(decode_stop_request(payload)))

    def _pause(self, payload: bytes) -> bytes:
        return encode_recording_status(self._recorder.pause(decode_tracker(payload)))

    def _resume(self, payload: bytes) -> bytes:
        return encode_recording_status(self._recorder.resume(decode_tracker(payload)))

    def _discard(self, payload: bytes) -> bytes:
        return encode_demonstration(self._recorder.annotations.discard_last(self._task(payload)))

    def _restore(self, payload: bytes) -> bytes:
        return encode_demonstration(self._recorder.annotations.restore_last(self._task(payload)))

    def _amend(self, payload: bytes) -> bytes:
        return encode_demonstration(self._recorder.annotations.amend(*decode_amendment(payload)))

    def _status(self, _: bytes) -> bytes:
        return encode_recorder_status(self._recorder.statuses(with_statistics=True))

    def _task(self, payload: bytes) -> str:
        reference = decode_task_reference(payload)
        if not reference.task and not reference.tracker:
            raise UnusableInput("name the task, or a tracker that is recording it")
        return reference.task or self._recorder.task_of(reference.tracker)
