"""Judges what is asked of the executor: who may, and whether the arm can; the loop obeys in its next period.

Everything here runs on the bus's threads. A stop has a thread of its own, so that it waits for nothing.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial

import numpy as np

from teachpath.errors import Conflict, TeachpathError, Unreachable, UnusableInput
from teachpath.executor.execution import Execution
from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.lease import ControlLease
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.teleop.program import TeleopProgram
from teachpath.io import documents, wire
from teachpath.io.bus import Bus, Handle
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.settings import MotionSettings
from teachpath.records import Array, Command, ExecutorStatus, JournalEntry, Plan, Scene, TeleopRequest
from teachpath_proto.keys import Keys

UNNAMED = "somebody"  # who commands without a lease and without a name
RESET = 10.0  # [s] that the simulated arm may take to build a scene
FREE = ("stop", "revoke")  # verbs that need no lease


class CommandHandler:
    """Keeps the execution that is under way and what it was told.

    Args:
        hearing: of the arm.
        robot: name of the arm in its keys.
        told: makes the status that is answered.
        begun: called before a new execution is moved.
        clock: monotonic nanoseconds.
        wall: nanoseconds since the Unix epoch.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        settings: ExecutorSettings,
        motion: MotionSettings,
        hearing: JointStateMonitor,
        *,
        robot: str,
        told: Callable[[], ExecutorStatus],
        begun: Callable[[], None],
        clock: Callable[[], int],
        wall: Callable[[], int],
    ) -> None:
        self._bus, self._keys, self._settings, self._motion = bus, keys, settings, motion
        self._hearing, self._robot, self._told, self._begun = hearing, robot, told, begun
        self._clock, self._wall = clock, wall
        self._starting = threading.Lock()
        self._stops = 0
        self.lease = ControlLease(clock)
        self.current: Execution | None = None
        self.orders: deque[Callable[[Execution], None]] = deque()  # for the loop

    def serve(self) -> list[Handle]:
        """Begin to answer."""
        return [
            self._bus.serve(self._keys.executor_command, self.answer),
            self._bus.serve(self._keys.executor_stop, self._stop),
            self._bus.serve(self._keys.executor_lease, self._control),
        ]

    @property
    def resting(self) -> bool:
        """Whether nothing is under way."""
        return self.current is None or self.current.resting

    def note(self, who: str, verb: str, answer: str) -> None:
        """Tell the journal who did what."""
        execution = self.current.execution if self.current else ""
        entry = JournalEntry(self._wall(), who, verb, execution, answer)
        self._bus.publish(self._keys.executor_journal, wire.encode_entry(entry))

    def answer(self, payload: bytes) -> bytes:
        """Answer a command with the status; raises what it is refused for."""
        command = wire.decode_command(payload)
        who = self.lease.name_of(command.lease, command.who or UNNAMED)
        try:
            if command.verb not in FREE:
                who = self.lease.require(command.lease, who)
            self._judge(command, who)
        except TeachpathError as error:
            self.note(who, command.verb, str(error))
            raise
        self.note(who, command.verb, "done")
        return wire.encode_status(self._told())

    def _stop(self, payload: bytes) -> bytes:
        command = wire.decode_command(payload) if payload else Command("stop")
        if command.verb != "stop":
            raise UnusableInput(f"this key answers stop alone; send {command.verb} to {self._keys.executor_command}")
        return self.answer(wire.encode_command(command))

    def _control(self, payload: bytes) -> bytes:
        request = wire.decode_lease_request(payload)
        lease = self.lease.answer(request)
        if request.action in ("acquire", "release", "ask", "keep"):
            self.note(request.name or lease.holder or "the holder", f"{request.action} control", "done")
        return wire.encode_lease(lease)

    def _judge(self, command: Command, who: str) -> None:
        if command.verb == "start":
            self._start(command, self._program)
        elif command.verb == "mirror":
            self._start(command, self._hand)
        elif command.verb == "stop":
            self._end(command, who)
        elif command.verb == "revoke":
            self._revoke(command)
        else:
            current = self.current
            if current is None or current.resting or command.execution != current.execution:
                raise Conflict(f"execution {command.execution!r} is not running")
            self._steer(current, command, who)

    def _steer(self, current: Execution, command: Command, who: str) -> None:
        verb = command.verb
        if verb == "override":
            self.orders.append(lambda execution: execution.override(command.override))
        elif verb == "hold":
            reason = "held by the operator" if who == UNNAMED else f"held by {who}"
            self.orders.append(lambda execution: execution.hold(reason))
        elif verb in ("resume", "reverse", "step"):
            if current.revoked:
                raise Conflict(current.revoked)
            if verb == "step":
                self._step(current, command)
                return
            self._bring_back(current)
            self.orders.append(Execution.resume if verb == "resume" else Execution.reverse)
        else:
            raise UnusableInput(f"{verb} is not possible while a path is executed")

    def _step(self, current: Execution, command: Command) -> None:
        if (command.length == 0.0) == (command.nodes == 0):
            raise UnusableInput("a step has a length in metres or a number of nodes: one of the two, and not zero")
        off = self._off(current)
        if off > self._settings.regain:
            raise Conflict(f"the arm is {off:.3f} rad off the path; resume brings it back, then hold it and step")
        here = current.program.here
        if isinstance(current.program, TeleopProgram):
            raise Conflict("a live hand has no path to step on; stop it, and run a plan")
        aside = current.program.plan_step(length=command.length, nodes=command.nodes)
        self.orders.append(lambda execution: execution.take_aside(aside, here))

    def _off(self, current: Execution) -> float:
        return float(np.abs(self._hearing.present().position - current.program.here).max())

    def _bring_back(self, current: Execution) -> None:
        """Let the arm go back to where it was held when it is elsewhere now."""
        off = self._off(current)
        if off <= self._settings.regain:
            return
        if not current.settled or not (current.displaced or current.rests_with(self._hearing.present())):
            raise Conflict(f"the arm is {off:.3f} rad off its setpoint and not at rest yet; hold it first, and wait")
        if isinstance(current.program, TeleopProgram):
            raise Conflict(f"the arm was pushed {off:.3f} rad away; stop, and begin again from where it is")
        here = self._resting_arm()
        aside = current.program.plan_return(here)
        self.orders.append(lambda execution: execution.take_aside(aside, here))

    def _end(self, command: Command, who: str) -> None:
        self._stops += 1
        current = self.current
        if current is not None and command.execution in ("", current.execution):
            reason = "stopped by the operator" if who == UNNAMED else f"stopped by {who}"
            self.orders.append(lambda execution: execution.end("ended", reason) if execution is current else None)

    def _revoke(self, command: Command) -> None:
        if self.current is not None and self.current.plan == command.plan_id:
            self.orders.append(partial(Execution.revoke, reason=command.reason or "no reason was given"))

    def _start(
        self, command: Command, make: Callable[[Command], tuple[PlanProgram | TeleopProgram, str, Scene]]
    ) -> None:
        stops = self._stops
        with self._starting:
            if self.current is not None and not self.current.resting:
                raise Conflict(f"execution {self.current.execution} is {self.current.state}; stop it first")
            program, plan, scene = make(command)
            with suppress(Unreachable):  # only the simulated robot has a scene to put back
                self._bus.ask(self._keys.reset(self._robot), documents.encode(scene), timeout=RESET)
            if self._stops != stops:
                raise Conflict("it was stopped before it began")
            if self.current is not None and isinstance(self.current.program, TeleopProgram):
                self.current.program.close()
            self._begun()
            self.orders.clear()
            offset = self._wall() - self._clock()
            self.current = Execution(command.execution, program, plan=plan, rate=self._settings.rate, offset=offset)

    def _program(self, command: Command) -> tuple[PlanProgram, str, Scene]:
        plan = documents.decode(Plan, command.plan)
        settings, period = self._settings, 1.0 / self._settings.rate
        here, override = self._resting_arm(), command.override
        program = PlanProgram(plan, here, self._motion, override=override, dwell=settings.dwell, period=period)
        return program, plan.id, plan.scene

    def _hand(self, command: Command) -> tuple[TeleopProgram, str, Scene]:
        order = documents.decode(TeleopRequest, command.mirror)
        if not (0.05 <= order.scale <= 5.0 and 0.05 <= order.share <= 1.0):
            raise UnusableInput(
                f"scale {order.scale:g} is outside 0.05 to 5, or share {order.share:g} outside 0.05 to 1"
            )
        period = 1.0 / self._settings.rate
        here = self._resting_arm()
        hand = TeleopProgram(
            self._bus,
            self._keys,
            order,
            here,
            self._motion,
            hearing=self._hearing,
            period=period,
            silence=self._settings.hand_silence,
            clock=self._clock,
        )
        return hand, "", order.scene

    def _resting_arm(self) -> Array:
        """Return the arm's configuration (6,), at rest."""
        arm = self._hearing.present()
        speed = float(np.abs(arm.velocity).max())
        if speed > self._settings.rest_speed:
            raise Conflict(f"the arm still moves at {speed:.2f} rad/s; wait until it rests")
        return arm.position
