"""Judges what is asked of the executor: who may, and whether the arm can; the loop obeys in its next period.

Everything here runs on the bus's threads. A stop has a thread of its own, so that it waits for nothing.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Final

import numpy as np

from teachpath.errors import Conflict, TeachpathError, Unreachable, UnusableInput
from teachpath.executor.execution import Execution
from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.lease import ControlLease
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.teleop.program import TeleopProgram
from teachpath.io import documents, wire
from teachpath.io.bus import Bus, Handle
from teachpath.motion.execution.motion_program import MotionProgram
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.settings import MotionSettings
from teachpath.records import Array, Command, ExecutorStatus, JournalEntry, Plan, Scene, TeleopRequest
from teachpath_proto.control import CommandVerb, ExecutorState, LeaseAction
from teachpath_proto.keys import Keys

DEFAULT_OPERATOR = "somebody"  # who commands without a lease and without a name
RESET_TIMEOUT = 10.0  # [s] that the simulated arm may take to build a scene
LEASE_FREE_VERBS: Final = (CommandVerb.STOP, CommandVerb.REVOKE)  # verbs that need no lease


class CommandHandler:
    """Keeps the execution that is under way and what it was told.

    Args:
        joint_states: monitor of the arm.
        robot: name of the arm in its keys.
        status: makes the status that is answered.
        on_start: called before a new execution is moved.
        clock: monotonic nanoseconds.
        wall: nanoseconds since the Unix epoch.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        settings: ExecutorSettings,
        motion: MotionSettings,
        joint_states: JointStateMonitor,
        *,
        robot: str,
        status: Callable[[], ExecutorStatus],
        on_start: Callable[[], None],
        clock: Callable[[], int],
        wall: Callable[[], int],
    ) -> None:
        self._bus, self._keys, self._settings, self._motion = bus, keys, settings, motion
        self._joint_states, self._robot, self._status, self._on_start = joint_states, robot, status, on_start
        self._clock, self._wall = clock, wall
        self._starting = threading.Lock()
        self._stops = 0
        self.lease = ControlLease(clock)
        self.current: Execution | None = None
        self.pending: deque[Callable[[Execution], None]] = deque()  # for the loop

    def serve(self) -> list[Handle]:
        """Begin to answer."""
        return [
            self._bus.serve(self._keys.executor_command, self.answer),
            self._bus.serve(self._keys.executor_stop, self._answer_stop),
            self._bus.serve(self._keys.executor_lease, self._answer_lease),
        ]

    @property
    def is_resting(self) -> bool:
        """Whether nothing is under way."""
        return self.current is None or self.current.is_resting

    def write_journal(self, who: str, verb: str, answer: str) -> None:
        """Tell the journal who did what."""
        execution = self.current.id if self.current else ""
        entry = JournalEntry(self._wall(), who, verb, execution, answer)
        self._bus.publish(self._keys.executor_journal, wire.encode_entry(entry))

    def answer(self, payload: bytes) -> bytes:
        """Answer a command with the status; raises what it is refused for."""
        command = wire.decode_command(payload)
        who = self.lease.name_of(command.lease, command.who or DEFAULT_OPERATOR)
        try:
            if command.verb not in LEASE_FREE_VERBS:
                who = self.lease.require(command.lease, who)
            self._dispatch(command, who)
        except TeachpathError as error:
            self.write_journal(who, command.verb, str(error))
            raise
        self.write_journal(who, command.verb, "done")
        return wire.encode_status(self._status())

    def _answer_stop(self, payload: bytes) -> bytes:
        command = wire.decode_command(payload) if payload else Command(CommandVerb.STOP)
        if command.verb != CommandVerb.STOP:
            raise UnusableInput(f"this key answers stop alone; send {command.verb} to {self._keys.executor_command}")
        return self.answer(wire.encode_command(command))

    def _answer_lease(self, payload: bytes) -> bytes:
        request = wire.decode_lease_request(payload)
        lease = self.lease.answer(request)
        if request.action not in (LeaseAction.LOOK, LeaseAction.BEAT):
            self.write_journal(request.name or lease.holder or "the holder", f"{request.action} control", "done")
        return wire.encode_lease(lease)

    def _dispatch(self, command: Command, who: str) -> None:
        if command.verb == CommandVerb.START:
            self._start(command, self._plan_program)
        elif command.verb == CommandVerb.MIRROR:
            self._start(command, self._teleop_program)
        elif command.verb == CommandVerb.STOP:
            self._stop_execution(command, who)
        elif command.verb == CommandVerb.REVOKE:
            self._revoke(command)
        else:
            current = self.current
            if current is None or current.is_resting or command.execution != current.id:
                raise Conflict(f"execution {command.execution!r} is not running")
            self._steer(current, command, who)

    def _steer(self, current: Execution, command: Command, who: str) -> None:
        verb = command.verb
        if verb == CommandVerb.OVERRIDE:
            self.pending.append(lambda execution: execution.set_override(command.override))
        elif verb == CommandVerb.HOLD:
            reason = "held by the operator" if who == DEFAULT_OPERATOR else f"held by {who}"
            self.pending.append(lambda execution: execution.hold(reason))
        elif verb in (CommandVerb.RESUME, CommandVerb.REVERSE, CommandVerb.STEP):
            if current.revocation:
                raise Conflict(current.revocation)
            if verb == CommandVerb.STEP:
                self._step(current, command)
                return
            self._return_to_path(current)
            self.pending.append(Execution.resume if verb == CommandVerb.RESUME else Execution.reverse)
        else:
            raise UnusableInput(f"{verb} is not possible while a path is executed")

    def _step(self, current: Execution, command: Command) -> None:
        if (command.length == 0.0) == (command.nodes == 0):
            raise UnusableInput("a step has a length in metres or a number of nodes: one of the two, and not zero")
        off = self._deviation(current)
        if off > self._settings.regain:
            raise Conflict(f"the arm is {off:.3f} rad off the path; resume brings it back, then hold it and step")
        here = current.program.current_q
        aside = current.program.plan_step(length=command.length, nodes=command.nodes)
        self.pending.append(lambda execution: execution.start_detour(aside, here))

    def _deviation(self, current: Execution) -> float:
        return float(np.abs(self._joint_states.current().position - current.program.current_q).max())

    def _return_to_path(self, current: Execution) -> None:
        """Let the arm go back to where it was held when it is elsewhere now."""
        off = self._deviation(current)
        if off <= self._settings.regain:
            return
        if not current.is_settled or not (
            current.displacement or current.arm_has_stopped(self._joint_states.current())
        ):
            raise Conflict(f"the arm is {off:.3f} rad off its setpoint and not at rest yet; hold it first, and wait")
        here = self._resting_q()
        aside = current.program.plan_return(here)
        self.pending.append(lambda execution: execution.start_detour(aside, here))

    def _stop_execution(self, command: Command, who: str) -> None:
        self._stops += 1
        current = self.current
        if current is not None and command.execution in ("", current.id):
            reason = "stopped by the operator" if who == DEFAULT_OPERATOR else f"stopped by {who}"
            self.pending.append(
                lambda execution: execution.end(ExecutorState.ENDED, reason) if execution is current else None
            )

    def _revoke(self, command: Command) -> None:
        if self.current is not None and self.current.plan == command.plan_id:
            self.pending.append(partial(Execution.revoke, reason=command.reason or "no reason was given"))

    def _start(self, command: Command, make: Callable[[Command], tuple[MotionProgram, str, Scene]]) -> None:
        stops = self._stops
        with self._starting:
            if self.current is not None and not self.current.is_resting:
                raise Conflict(f"execution {self.current.id} is {self.current.state}; stop it first")
            program, plan, scene = make(command)
            with suppress(Unreachable):  # only the simulated robot has a scene to put back
                self._bus.ask(self._keys.reset(self._robot), documents.encode(scene), timeout=RESET_TIMEOUT)
            if self._stops != stops:
                program.close()
                raise Conflict("it was stopped before it began")
            if self.current is not None:
                self.current.program.close()
            self._on_start()
            self.pending.clear()
            offset = self._wall() - self._clock()
            self.current = Execution(command.execution, program, plan=plan, rate=self._settings.rate, offset=offset)

    def _plan_program(self, command: Command) -> tuple[PlanProgram, str, Scene]:
        plan = documents.decode(Plan, command.plan)
        settings, period = self._settings, 1.0 / self._settings.rate
        here, override = self._resting_q(), command.override
        program = PlanProgram(plan, here, self._motion, override=override, dwell=settings.dwell, period=period)
        return program, plan.id, plan.scene

    def _teleop_program(self, command: Command) -> tuple[TeleopProgram, str, Scene]:
        order = documents.decode(TeleopRequest, command.mirror)
        if not (0.05 <= order.scale <= 5.0 and 0.05 <= order.share <= 1.0):
            raise UnusableInput(
                f"scale {order.scale:g} is outside 0.05 to 5, or share {order.share:g} outside 0.05 to 1"
            )
        period = 1.0 / self._settings.rate
        here = self._resting_q()
        hand = TeleopProgram(
            self._bus,
            self._keys,
            order,
            here,
            self._motion,
            joint_states=self._joint_states,
            period=period,
            silence=self._settings.hand_silence,
            clock=self._clock,
        )
        return hand, "", order.scene

    def _resting_q(self) -> Array:
        """Return the arm's configuration (6,), at rest."""
        arm = self._joint_states.current()
        speed = float(np.abs(arm.velocity).max())
        if speed > self._settings.rest_speed:
            raise Conflict(f"the arm still moves at {speed:.2f} rad/s; wait until it rests")
        return arm.position
