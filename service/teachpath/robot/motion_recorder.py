"""Records every execution in a file of its own: setpoints, joint states, statuses and journal."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Final

import numpy as np

from teachpath.errors import TeachpathError, UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.store.motions import MotionHeader, Motions, MotionTake
from teachpath.io.wire import decode_setpoint, decode_state, decode_status, without_way_to_rest
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import JointState
from teachpath_proto.keys import Keys

log: logging.Logger = logging.getLogger(__name__)

POLL_INTERVAL: Final = 0.05  # [s] between two rounds of writing
FLUSH_NS: Final = 1_000_000_000  # between two flushes
SETTLING_NS: Final = 500_000_000  # after the end of an execution, in which the arm still settles
STOPPING_NS: Final = 5_000_000_000  # after the death of the executor, in which the arm comes to rest on its way
REST_SPEED: Final = 0.05  # [rad/s] below which it rests
FILE_END_TIMEOUT: Final = 10.0  # [s] that somebody waits for the end of a file


class MotionRecorder:
    """Writes the messages of the bus while an execution runs; start it, then `begin` each execution.

    Args:
        robot: name of the arm in its keys.
        clock: returns nanoseconds since the Unix epoch.

    Attributes:
        fault: why nothing is recorded now, for the operator; empty while all is well.
    """

    def __init__(
        self, bus: Bus, keys: Keys, motions: Motions, *, robot: str, clock: Callable[[], int] = time.time_ns
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._motions = motions
        self._robot = robot
        self._clock = clock
        self._queue: deque[tuple[str, int, bytes]] = deque()
        self._lock = threading.Lock()
        self._file_ended = threading.Condition(self._lock)  # notified when a file is complete or given up
        self._take: MotionTake | None = None
        self._execution = ""
        self._setpoints = self._lost = 0
        self._last_cycle = -1
        self._flushed = 0
        self._end_ns = 0  # when the file is to be ended; 0: not known yet
        self._awaits_rest = False  # whether it is ended sooner, when the arm rests
        self._handles: list[Handle] = []
        self._thread = PeriodicThread("motion recorder", POLL_INTERVAL, self.process_round)
        self.fault: str = ""

    def start(self) -> None:
        """Receive messages from now on; first complete the files that a crash cut off."""
        for part in self._motions.unfinished():
            try:
                log.warning("made a whole recording of one that was cut off: %s", self._motions.mend(part).name)
            except (TeachpathError, OSError) as error:
                log.warning("left as it is: %s", error)
        topics = {
            "setpoints": self._keys.setpoint(self._robot),
            "states": self._keys.state(self._robot),
            "statuses": self._keys.executor_status,
            "journal": self._keys.executor_journal,
        }
        self._handles = [self._bus.subscribe(key, self._receiver(topic)) for topic, key in topics.items()]
        self._thread.start()

    def stop(self) -> None:
        """Stop receiving, and end the recording that is under way."""
        for handle in self._handles:
            handle.close()
        self._handles.clear()
        if self._thread.is_running:
            self._thread.stop()
            self.process_round()
        with self._lock:
            self._finish()

    def begin(self, header: MotionHeader) -> None:
        """Record an execution from now on; a disk that refuses sets `fault` and does not keep the arm from moving."""
        with self._lock:
            self._finish()
            self._queue.clear()
            self._execution = header.execution
            self._setpoints = self._lost = 0
            self._last_cycle = -1
            try:
                self._take, self.fault = self._motions.begin(header), ""
            except OSError as error:
                self._fail(error)

    def finish_after(self, time_ns: int) -> None:
        """End the recording in `time_ns` from now, because the executor will not say when the execution is over."""
        with self._lock:
            self._end_ns = self._end_ns or self._clock() + time_ns

    def finish_at_rest(self) -> None:
        """End the recording when the arm rests, because its executor has died; after `STOPPING_NS` in any case."""
        with self._lock:
            self._awaits_rest = not self._end_ns
            self._end_ns = self._end_ns or self._clock() + STOPPING_NS

    def wait_for_file(self, execution: str) -> None:
        """Wait until the file of an execution that is over is complete, but no longer than `FILE_END_TIMEOUT`."""
        if self._thread.is_running:
            with self._file_ended:
                self._file_ended.wait_for(lambda: self._take is None or self._execution != execution, FILE_END_TIMEOUT)

    def process_round(self) -> None:
        """Write what was received; the thread calls this once an interval."""
        with self._lock:
            now = self._clock()
            while self._queue:
                topic, at_ns, payload = self._queue.popleft()
                if self._take is not None:
                    self._write(topic, at_ns, payload)
            if self._take is None:
                return
            try:
                if now - self._flushed >= FLUSH_NS:
                    self._take.flush()
                    self._flushed = now
            except OSError as error:
                self._fail(error)
            if self._end_ns and now >= self._end_ns:
                self._finish()

    def _receiver(self, topic: str) -> Callable[[str, bytes], None]:
        return lambda _, payload: self._queue.append((topic, self._clock(), payload))

    def _write(self, topic: str, at_ns: int, payload: bytes) -> None:
        assert self._take is not None
        with suppress(UnusableInput):
            if topic == "setpoints":
                setpoint = decode_setpoint(payload)
                if setpoint.execution != self._execution:
                    return
                self._setpoints += 1
                self._lost += max(setpoint.cycle - self._last_cycle - 1, 0)
                self._last_cycle = setpoint.cycle
                payload = without_way_to_rest(payload)
            elif topic == "statuses":
                status = decode_status(payload)
                if status.execution != self._execution:
                    return
                if status.state.is_resting and not self._end_ns:
                    self._end_ns = at_ns + SETTLING_NS
            elif topic == "states" and self._awaits_rest and _rests(decode_state(payload)):
                self._awaits_rest, self._end_ns = False, min(self._end_ns, at_ns + SETTLING_NS)
            try:
                self._take.write(topic, payload, at_ns)
            except OSError as error:
                self._fail(error)

    def _finish(self) -> None:
        take, self._take, self._end_ns, self._awaits_rest = self._take, None, 0, False
        if take is None:
            return
        self._file_ended.notify_all()
        facts = {"execution": self._execution, "setpoints": str(self._setpoints), "lost": str(self._lost)}
        try:
            take.finish(facts)
        except OSError as error:
            take.leave()
            self._fail(error)

    def _fail(self, error: OSError) -> None:
        if self._take is not None:
            self._take.leave()
        self._take = None
        self._file_ended.notify_all()
        self.fault = f"execution {self._execution} is not recorded: {error}; make room on the disk"
        log.error("%s", self.fault)


def _rests(arm: JointState) -> bool:
    """Tell whether an arm stands at the end of its way to rest."""
    return arm.stopped and float(np.abs(arm.velocity).max()) < REST_SPEED
