"""The executor: streams the setpoints of one plan at a time to the arm and obeys the operator meanwhile.

It lives in a process of its own, in which nothing else runs. The loop never raises in mid-motion: whatever goes wrong
brings the arm to rest on its path, with a reason in the status.
"""

from __future__ import annotations

import gc
import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le

from teachpath.errors import Conflict, Unreachable, UnusableInput
from teachpath.io import documents, wire
from teachpath.io.bus import Bus
from teachpath.motion.governor import warm_up
from teachpath.motion.program import Program
from teachpath.motion.settings import MotionSettings
from teachpath.records import ExecutorStatus, JointState, Plan
from teachpath.workers.executor.execution import Execution
from teachpath.workers.executor.pacing import Pacer, ask_for_realtime
from teachpath_proto.keys import Keys

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class ExecutorSettings:
    """How plans are executed."""

    # [Hz] setpoints a second
    rate: Annotated[float, Ge(125), Le(500)] = 250.0
    # [Hz] statuses a second
    status_rate: Annotated[float, Gt(0), Le(50)] = 10.0
    # [s] that the gripper takes to close or open
    dwell: Annotated[float, Ge(0), Le(10)] = 0.5
    # [s] without a joint state after which the arm is held
    silence: Annotated[float, Gt(0), Le(5)] = 0.2
    # [rad] tracking error of a joint at which the execution is given up
    largest_error: Annotated[float, Gt(0), Le(0.5)] = 0.05
    # [rad/s] that the arm may still move when an execution starts
    rest_speed: Annotated[float, Gt(0), Le(0.5)] = 0.05
    # [rad] that the arm may be off its setpoint when a held execution goes on
    regain: Annotated[float, Gt(0), Le(0.5)] = 0.02
    # whether to ask for real-time scheduling
    realtime: bool = True


class Executor:
    """Owns the control loop; `run` is its life."""

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        settings: ExecutorSettings | None = None,
        *,
        robot: str = "puma560",
        motion: MotionSettings | None = None,
        clock: Callable[[], int] = time.monotonic_ns,
        wall: Callable[[], int] = time.time_ns,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        """Prepare the executor; nothing runs before `run`.

        Args:
            robot: name of the arm in its keys.
            clock: monotonic nanoseconds, by which the loop is paced.
            wall: nanoseconds since the Unix epoch, for the stamps of setpoints.
            sleep: waits for so many seconds.
        """
        self._bus, self._keys, self._robot = bus, keys, robot
        self._settings = settings or ExecutorSettings()
        self._motion = motion or MotionSettings()
        self._clock, self._wall = clock, wall
        self._period = 1.0 / self._settings.rate
        self._pacer = Pacer(round(1e9 * self._period), clock=clock, sleep=sleep)
        self._starting = threading.Lock()
        self._states: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._heard: tuple[int, JointState] | None = None  # the newest joint state and when it came
        self._commands: deque[tuple[str, float]] = deque()
        self._current: Execution | None = None
        self._told = ("", "", 0)  # execution, state and time of the newest status

    def run(self, stop: threading.Event) -> None:
        """Stream until `stop` is set; then the arm is brought to rest on its path first."""
        s = self._settings
        warm_up(self._period)
        handles = [
            self._bus.subscribe(self._keys.state(self._robot), self._hear),
            self._bus.serve(self._keys.executor_command, self._answer),
            self._bus.announce(self._keys.alive("executor", self._robot)),
        ]
        log.info("%s", ask_for_realtime() if s.realtime else "real-time scheduling was not asked for")
        # A collection in the loop can last a hundred periods; nothing in this process makes cyclic garbage in bulk.
        gc.collect()
        gc.freeze()
        gc.disable()
        try:
            while not (stop.is_set() and self._resting):
                if stop.is_set() and self._current is not None:
                    self._current.end("ended", "the executor was told to stop")
                self._cycle(self._pacer.wait(counted=not self._resting))
        finally:
            gc.enable()
            gc.unfreeze()
            for handle in handles:
                handle.close()

    @property
    def _resting(self) -> bool:
        return self._current is None or self._current.resting

    def _cycle(self, due: int) -> None:
        self._listen()
        current = self._current
        if current is not None and not current.resting:
            self._obey(current)
            self._watch(current, due)
            setpoint = current.step(due, self._wall())
            self._bus.publish(self._keys.setpoint(self._robot), wire.encode_setpoint(setpoint))
        self._tell(due)

    def _hear(self, _: str, payload: bytes) -> None:
        self._states.append((self._clock(), payload))

    def _listen(self) -> None:
        if not self._states:
            return
        when, payload = self._states.pop()
        try:
            self._heard = (when, wire.decode_state(payload))
        except UnusableInput as error:
            log.warning("left out: %s", error)

    def _answer(self, payload: bytes) -> bytes:
        """Answer a command; runs on the bus's thread, the loop obeys in its next period."""
        verb, execution, document, override = wire.decode_command(payload)
        if verb == "start":
            return wire.encode_status(self._start(execution, document, override).status(self._pacer))
        current = self._current
        if current is None or current.resting or execution != current.execution:
            raise Conflict(f"execution {execution!r} is not running")
        if verb in ("resume", "reverse"):
            self._check_regain(current)
        self._commands.append((verb, override))
        return wire.encode_status(current.status(self._pacer))

    def _start(self, execution: str, document: bytes, override: float) -> Execution:
        with self._starting:
            if self._current is not None and not self._current.resting:
                raise Conflict(f"execution {self._current.execution} is {self._current.state}; stop it first")
            plan = documents.decode(Plan, document)
            arm = self._present()
            speed = float(np.abs(arm.velocity).max())
            if speed > self._settings.rest_speed:
                raise Conflict(f"the arm still moves at {speed:.2f} rad/s; wait until it rests")
            program = Program(
                plan,
                arm.position,
                self._motion,
                override=override,
                dwell=self._settings.dwell,
                period=self._period,
            )
            self._pacer.reset()
            self._commands.clear()
            offset = self._wall() - self._clock()
            self._current = Execution(execution, program, rate=self._settings.rate, offset=offset)
            return self._current

    def _present(self) -> JointState:
        heard = self._heard
        if heard is None or self._clock() - heard[0] > 1e9 * self._settings.silence:
            raise Unreachable(f"no joint state from {self._robot}; is the simulator or the arm's driver running?")
        return heard[1]

    def _check_regain(self, current: Execution) -> None:
        off = float(np.abs(self._present().position - current.program.here).max())
        if off > self._settings.regain:
            raise Conflict(
                f"the arm is {off:.3f} rad off the point where it was held, at most {self._settings.regain:g}; "
                "stop, and start again from where it is"
            )

    def _obey(self, current: Execution) -> None:
        while self._commands:
            verb, override = self._commands.popleft()
            if verb == "override":
                current.override(override)
            elif verb == "hold":
                current.hold("held by the operator")
            elif verb == "resume":
                current.resume()
            elif verb == "reverse":
                current.reverse()
            elif verb == "stop":
                current.end("ended", "stopped by the operator")

    def _watch(self, current: Execution, due: int) -> None:
        if self._heard is None:
            return
        when, arm = self._heard
        silent = (due - when) / 1e9
        if silent > self._settings.silence:
            current.hold(f"no joint state for {silent:.2f} s: is the arm's driver running? resume when it is back")
        if arm.execution != current.execution:
            return
        current.tracking_error = max(current.tracking_error, arm.tracking_error)
        if arm.tracking_error > self._settings.largest_error:
            current.end(
                "faulted",
                f"tracking error {arm.tracking_error:.3f} rad {current.program.place}, limit "
                f"{self._settings.largest_error:g}: is the arm blocked? free it, or start again at a lower override",
            )

    def _tell(self, due: int) -> None:
        current = self._current
        status = (current.execution, current.state) if current is not None else ("", "idle")
        if status == self._told[:2] and due - self._told[2] < 1e9 / self._settings.status_rate:
            return
        self._told = (*status, due)
        told = current.status(self._pacer) if current is not None else ExecutorStatus()
        self._bus.publish(self._keys.executor_status, wire.encode_status(told))
