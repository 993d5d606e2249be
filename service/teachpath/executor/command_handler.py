"""Checks every command to the executor: who may give it, and whether the arm can obey.

A command that passes is queued for the control loop, which obeys in its next period. Commands are answered on the bus's
threads. A stop has a key and a thread of its own, so that it waits for nothing; one that was put there is obeyed by the
control loop, for nobody can answer a put in the executor's place.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np

from teachpath.errors import Conflict, TeachpathError, UnusableInput
from teachpath.executor.arm_rest import ArmRest
from teachpath.executor.execution import Execution
from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.lease import ControlLease
from teachpath.executor.program_factory import PreparedProgram, ProgramFactory
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.unasked_motion import UnaskedMotionDetector, moved_since_order
from teachpath.io import wire
from teachpath.io.bus import Bus, Handle
from teachpath.io.bus_delivery import Delivery
from teachpath.logs import continue_request
from teachpath.records import Array, Command, ExecutorStatus, JournalEntry
from teachpath.time_source import TimeSource
from teachpath_proto.control import CommandVerb, ExecutorState, JournalVerb, LeaseAction
from teachpath_proto.keys import Keys

log: logging.Logger = logging.getLogger(__name__)

DEFAULT_OPERATOR: Final = "somebody"  # name of a person who commands without a lease and without a name
MAX_WAITING_STOPS: Final = 1000  # stops that were put and not obeyed yet
STOPS_A_PERIOD: Final = 10  # of them that are obeyed in one cycle of the loop, so that a flood delays no setpoint
KNOWN_STOPS: Final = 100  # ids of stops whose repeats are not written to the journal
LEASE_FREE_VERBS: Final = (CommandVerb.STOP, CommandVerb.REVOKE)


class CommandHandler:
    """Holds the current execution and the commands that wait for the control loop.

    Args:
        joint_states: monitor of the arm.
        programs: makes the program of a start command.
        status: returns the status with which commands are answered.
        unasked_motion: because of which nothing may start before somebody acknowledges it.
        on_start: called before a new execution moves the arm.

    Attributes:
        lease: who is in control.
        current: the execution under way, or the one that ended last; None before the first.
        pending: what the control loop does to the current execution in its next period.
        status_is_due: whether a stop came since the control loop has published the status.
        stop_came: set when a stop has come that the control loop, at rest, is to confirm in its next period.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        settings: ExecutorSettings,
        joint_states: JointStateMonitor,
        programs: ProgramFactory,
        *,
        time_source: TimeSource,
        status: Callable[[], ExecutorStatus],
        unasked_motion: UnaskedMotionDetector,
        on_start: Callable[[], None],
    ) -> None:
        self._bus, self._keys, self._settings = bus, keys, settings
        self._joint_states = joint_states
        self._programs = programs
        self._time = time_source
        self._status = status
        self._unasked_motion = unasked_motion
        self._on_start = on_start
        self._start_lock = threading.Lock()
        self._lock = threading.Lock()  # held where a stop and the begin of an execution must not cross
        self._stop_count = 0
        self._received_stops: deque[bytes] = deque(maxlen=MAX_WAITING_STOPS)
        self._known_stops: deque[str] = deque(maxlen=KNOWN_STOPS)
        self.status_is_due: bool = False
        self.stop_came: threading.Event = threading.Event()
        self.lease: ControlLease = ControlLease(time_source.monotonic_ns)
        self.current: Execution | None = None
        self.pending: deque[Callable[[Execution], None]] = deque()

    def receive_stops(self) -> Handle:
        """Receive the stops that are put from now on; the control loop obeys them."""

        def receive(_: str, payload: bytes) -> None:
            self._received_stops.append(payload)
            self.stop_came.set()

        return self._bus.subscribe(self._keys.executor_stop, receive)

    def serve(self) -> list[Handle]:
        """Answer commands, stops and lease requests from now on."""
        return [
            self._bus.serve(self._keys.executor_command, self.answer),
            self._bus.serve(self._keys.executor_stop, self._answer_stop),
            self._bus.serve(self._keys.executor_lease, self._answer_lease),
        ]

    @property
    def is_resting(self) -> bool:
        """Whether no execution is under way."""
        return self.current is None or self.current.is_resting

    def write_journal(self, who: str, verb: JournalVerb, answer: str, *, execution: str | None = None) -> None:
        """Publish an entry of the journal, and never wait: who did what to an execution, and the answer."""
        current = self.current.id if self.current else ""
        entry = JournalEntry(self._time.wall_ns(), who, verb, current if execution is None else execution, answer)
        self._bus.publish(self._keys.executor_journal, wire.encode_entry(entry), delivery=Delivery.DROPS_LAST)

    def answer(self, payload: bytes) -> bytes:
        """Answer a command with the status; raise the reason when it is refused."""
        command = wire.decode_command(payload)
        continue_request(command.id)
        who = self.lease.name_of(command.lease, command.who or DEFAULT_OPERATOR)
        try:
            if command.verb not in LEASE_FREE_VERBS:
                who = self.lease.require(command.lease, who)
            self._dispatch(command, who)
        except TeachpathError as error:
            self.write_journal(who, JournalVerb(command.verb), str(error))
            log.info("%s by %s is refused: %s", command.verb, who, error)
            raise
        if not self._is_repeat(command):
            self.write_journal(who, JournalVerb(command.verb), "done")
            log.info("%s by %s: done", command.verb, who)
        return wire.encode_status(self._status())

    def obey_stops(self) -> None:
        """Obey the stops that were put; called by the control loop."""
        self.stop_came.clear()
        for _ in range(min(len(self._received_stops), STOPS_A_PERIOD)):
            try:
                self._answer_stop(self._received_stops.popleft())
            except TeachpathError as error:
                log.warning("a stop that was put is none: %s", error)

    def _answer_stop(self, payload: bytes) -> bytes:
        command = wire.decode_command(payload) if payload else Command(CommandVerb.STOP)
        if command.verb != CommandVerb.STOP:
            raise UnusableInput(f"this key answers stop alone; send {command.verb} to {self._keys.executor_command}")
        return self.answer(wire.encode_command(command))

    def _is_repeat(self, command: Command) -> bool:
        with self._lock:
            known = command.id in self._known_stops
            if command.id and not known and command.verb == CommandVerb.STOP:
                self._known_stops.append(command.id)
        return known

    def _answer_lease(self, payload: bytes) -> bytes:
        request = wire.decode_lease_request(payload)
        lease = self.lease.answer(request)
        if request.action not in (LeaseAction.LOOK, LeaseAction.BEAT):
            verb = JournalVerb(f"{request.action} control")
            self.write_journal(request.name or lease.holder or "the holder", verb, "done")
        return wire.encode_lease(lease)

    def _dispatch(self, command: Command, who: str) -> None:
        if command.verb in (CommandVerb.START, CommandVerb.TELEOPERATE):
            self._start(command)
        elif command.verb == CommandVerb.STOP:
            self._stop(command, who)
        elif command.verb == CommandVerb.REVOKE:
            self._revoke(command)
        elif command.verb == CommandVerb.ACKNOWLEDGE:
            self._unasked_motion.acknowledge()
            self.status_is_due = True
        else:
            current = self.current
            if current is None or current.is_resting or command.execution != current.id:
                raise Conflict(f"execution {command.execution!r} is not running")
            self._steer(current, command, who)

    def _steer(self, current: Execution, command: Command, who: str) -> None:
        if command.verb == CommandVerb.OVERRIDE:
            if current.state is ExecutorState.HELD:  # at an override of zero: another one moves the arm again
                current.confirm()
            self.pending.append(lambda execution: execution.program.set_override(command.override))
        elif command.verb == CommandVerb.HOLD:
            reason = "held by the operator" if who == DEFAULT_OPERATOR else f"held by {who}"
            self.pending.append(lambda execution: execution.hold(reason))
        elif current.revocation:
            raise Conflict(current.revocation)
        else:
            current.confirm()
            self._move_on(current, command)

    def _move_on(self, current: Execution, command: Command) -> None:
        if command.verb == CommandVerb.STEP:
            self._step(current, command)
        else:
            self._return_to_path(current)
            self.pending.append(Execution.resume if command.verb == CommandVerb.RESUME else Execution.reverse)

    def _step(self, current: Execution, command: Command) -> None:
        if (command.length == 0.0) == (command.nodes == 0):
            raise UnusableInput("a step has a length in metres or a number of nodes: one of the two, and not zero")
        off = self._deviation(current)
        if off > self._settings.regain:
            raise Conflict(f"the arm is {off:.3f} rad off the path; resume brings it back, then hold it and step")
        start_q = current.program.current_q
        detour = current.program.plan_step(length=command.length, nodes=command.nodes)
        self.pending.append(lambda execution: execution.start_detour(detour, start_q))

    def _deviation(self, current: Execution) -> float:
        """Return how far the arm is from its newest setpoint [rad]."""
        return float(np.abs(self._joint_states.current().position - current.program.current_q).max())

    def _return_to_path(self, current: Execution) -> None:
        """Begin the way back to where the arm was held, if it is elsewhere now."""
        off = self._deviation(current)
        if off <= self._settings.regain:
            return
        stopped = current.displacement or current.arm_has_stopped(self._joint_states.current())
        if not (current.is_settled and stopped):
            raise Conflict(f"the arm is {off:.3f} rad off its setpoint and not at rest yet; hold it first, and wait")
        start_q = self._joint_states.resting_q(self._settings.rest_speed)
        detour = current.program.plan_return(start_q)
        self.pending.append(lambda execution: execution.start_detour(detour, start_q))

    def _stop(self, command: Command, who: str) -> None:
        with self._lock:
            self._stop_count += 1
            stopped, self.status_is_due = self.current, True
        self.stop_came.set()
        if stopped is None or command.execution not in ("", stopped.id):
            return
        reason = "stopped by the operator" if who == DEFAULT_OPERATOR else f"stopped by {who}"

        def end(execution: Execution) -> None:
            if execution is stopped:  # and not one that began meanwhile
                execution.end(ExecutorState.ENDED, reason)

        self.pending.append(end)

    def _revoke(self, command: Command) -> None:
        if self.current is not None and self.current.plan == command.plan_id:
            self.pending.append(partial(Execution.revoke, reason=command.reason or "no reason was given"))

    def _start(self, command: Command) -> None:
        stops_before = self._stop_count
        with self._start_lock:
            if self.current is not None and not self.current.is_resting:
                raise Conflict(f"execution {self.current.id} is {self.current.state}; stop it first")
            if self.current is not None and self.current.id == command.execution:
                raise Conflict(f"execution {command.execution} has been: give the next one another name")
            if self._unasked_motion.reason:
                raise Conflict(self._unasked_motion.reason)
            # Who was lost while nothing moved matters no more.
            self.lease.pop_lost_holder()
            self._joint_states.has_lost_driver = False
            prepared = self._programs.make(command)
            try:
                self._programs.reset_scene(prepared.scene)
                with self._lock:
                    self._begin(command.execution, prepared, stops_before)
            except BaseException:
                prepared.program.close()
                raise

    def _check_begin(self, start_q: Array, stops_before: int) -> None:
        """Refuse to begin when a stop came, or the arm has moved, since the execution was ordered: that took time."""
        if self._stop_count != stops_before:
            raise Conflict("it was stopped before it began")
        if self._unasked_motion.reason:
            raise Conflict(self._unasked_motion.reason)
        arm_q = self._joint_states.resting_q(self._settings.rest_speed)
        off = float(np.abs(arm_q - start_q).max())
        if off > self._settings.unasked_motion:
            raise Conflict(moved_since_order(off))

    def _begin(self, execution: str, prepared: PreparedProgram, stops_before: int) -> None:
        self._check_begin(prepared.program.current_q, stops_before)
        if self.current is not None:
            self.current.program.close()
        self._on_start()
        self.pending.clear()
        self.current = Execution(
            execution,
            prepared.program,
            plan=prepared.plan,
            confirm=prepared.confirm,
            grasp=prepared.grasp,
            rate=self._settings.rate,
            offset=self._time.wall_ns() - self._time.monotonic_ns(),
            arm=self._programs.arm,
            arm_rest=ArmRest(self._settings.rest_speed, self._settings.rest_timeout),
        )
