"""The executions: sends plans and commands to the executor's process, and stores its statuses and its journal."""

from __future__ import annotations

import queue
import threading
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Final

from teachpath.errors import Conflict, NotFound, PathRefused, TeachpathError, Unreachable, UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.documents import encode
from teachpath.io.store.motions import MotionHeader, read_motion
from teachpath.io.store.store import Execution, Store
from teachpath.io.wire import decode_entry, decode_lease, decode_status, encode_command, encode_lease_request
from teachpath.motion.analysis.time_series import TimeSeries, time_series
from teachpath.motion.arm.model import Arm
from teachpath.records import Command, ExecutorStatus, JournalEntry, Lease, LeaseRequest, Plan, Scene, TeleopRequest
from teachpath.robot.motion_recorder import MotionRecorder
from teachpath.robot.stopper import Stopper
from teachpath_proto.control import CommandVerb, ExecutorState
from teachpath_proto.keys import Keys

STEERING_VERBS: Final = (
    CommandVerb.OVERRIDE,
    CommandVerb.HOLD,
    CommandVerb.RESUME,
    CommandVerb.STEP,
    CommandVerb.REVERSE,
)


class Executions:
    """Starts and steers executions, one at a time.

    Args:
        robot: name of the robot.
        scene: returns the present scene of a name; raises NotFound.
        arm: that is moved.
    """

    def __init__(
        self, bus: Bus, keys: Keys, store: Store, *, robot: str, scene: Callable[[str], Scene], arm: Arm
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._store = store
        self._robot = robot
        self._scene = scene
        self._arm = arm
        self._recorder = MotionRecorder(bus, keys, store.motions, robot=robot)
        self._stopper = Stopper(bus, keys)
        self._starting: set[str] = set()  # executions that the executor has not answered for yet
        self._changed = threading.Condition()
        self._status: ExecutorStatus | None = None
        self._last_seen = 0.0
        self._plans: dict[str, str | None] = {}
        self._handles: list[Handle] = []
        self._received: queue.SimpleQueue[ExecutorStatus | JournalEntry | None] = queue.SimpleQueue()
        self._writer: threading.Thread | None = None

    def start(self) -> None:
        """Receive the executor's statuses and journal from now on."""
        self._recorder.start()
        self._handles = [
            self._bus.subscribe(self._keys.executor_status, self._receive),
            self._bus.subscribe(self._keys.executor_journal, self._receive_entry),
        ]
        self._writer = threading.Thread(target=self._write, name="executions", daemon=True)
        self._writer.start()

    def stop(self) -> None:
        """Stop receiving; what came is stored first."""
        for handle in self._handles:
            handle.close()
        self._stopper.close()
        if self._writer is not None:
            self._received.put(None)
            self._writer.join()
            self._writer = None
        self._recorder.stop()

    def faults(self) -> list[str]:
        """Return why an execution is not recorded, in sentences for the operator."""
        return [self._recorder.fault] if self._recorder.fault else []

    def recording(self, execution: str) -> Path:
        """Return the file of an execution's setpoints, joint states, statuses and journal; raises NotFound.

        Once the execution is over, the file is complete.
        """
        row = self.get(execution)
        if row.status.state.is_resting:
            self._recorder.wait_for_file(row.id)
        return self._store.motions.path(row.id)

    def series(self, execution: str, points: int) -> TimeSeries:
        """Return what the arm did over time in an execution; raises NotFound."""
        motion = read_motion(self.recording(execution))
        return time_series(motion.setpoints, motion.states, points, self._arm)

    @property
    def status(self) -> ExecutorStatus | None:
        """The executor's newest status, or None when the executor has been silent for over a second."""
        return self._status if time.monotonic() - self._last_seen < 1.0 else None

    def execute(self, plan: str, *, override: float = 1.0, lease: str = "", who: str = "") -> Execution:
        """Move the robot along a plan.

        Args:
            plan: id of a stored plan.
            override: share of the planned speed.
            lease: token of the control lease, when somebody holds it.
            who: name for the journal, of somebody without a lease.

        Raises:
            NotFound: no such plan.
            Conflict: another execution is running, or somebody else is in control.
            PathRefused: the certificate does not hold, or the way to its start is not free.
            Unreachable: the executor does not answer.
        """
        stored = self._store.plan(plan)
        self._check_certificate(stored)
        status = self.status
        if status is not None and not status.state.is_resting:
            raise Conflict(f"execution {status.execution} is {status.state}; stop it first")
        key = f"execution-{uuid.uuid4().hex[:12]}"
        command = Command(CommandVerb.START, key, plan=encode(stored), override=override, lease=lease, who=who)
        path = None
        with suppress(NotFound):  # a file without it is judged by its limits alone
            path = self._store.versions.get(stored.path, stored.path_version)[1]
        return self._start_execution(command, MotionHeader(key, self._robot, stored, path))

    def teleoperate(self, order: TeleopRequest, *, lease: str = "", who: str = "") -> Execution:
        """Let the robot follow a live hand; such an execution is steered and stopped like any other.

        Raises:
            UnusableInput: a scale or share outside its limits.
            Conflict: an execution is running, or somebody else is in control.
            PathRefused: the arm stands where it can follow nothing.
            Unreachable: the executor does not answer.
        """
        key = f"execution-{uuid.uuid4().hex[:12]}"
        command = Command(CommandVerb.TELEOPERATE, key, teleop=encode(order), lease=lease, who=who)
        return self._start_execution(command, MotionHeader(key, self._robot))

    def command(self, execution: str, command: Command) -> Execution:
        """Steer an execution by one of `STEERING_VERBS`.

        Raises:
            UnusableInput: an unknown verb.
            NotFound: no such execution.
            Conflict: it is not the one that is running, or somebody else is in control.
        """
        if command.verb not in STEERING_VERBS:
            raise UnusableInput(f"{command.verb!r} is no command; say {', '.join(STEERING_VERBS)}")
        self.get(execution)
        status = self.status
        if status is None or status.execution != execution:
            raise Conflict(f"execution {execution} is not running")
        self._bus.ask(self._keys.executor_command, encode_command(command))
        return self.get(execution)

    def stop_one(self, execution: str, *, lease: str = "", who: str = "") -> Execution:
        """Stop an execution, and return it when the executor's status shows that it ends or has ended.

        Raises:
            NotFound: no such execution.
            NotStopped: the executor has not confirmed it; the stop is repeated.
        """
        row = self.get(execution)
        if row.status.state.is_resting:
            return row
        command = Command(CommandVerb.STOP, execution, lease=lease, who=who)
        confirmed = self._stopper.stop(command, lambda: execution in self._starting)
        row = self.get(execution)
        if row.status.state.is_resting or confirmed.execution == execution:
            return row
        reason = "the executor does not run it any more"
        return replace(row, status=replace(row.status, state=ExecutorState.FAULTED, reason=reason))

    def stop_all(self, *, lease: str = "", who: str = "") -> ExecutorStatus:
        """Stop whatever execution is under way, and return the executor's status that shows it; raises NotStopped."""
        command = Command(CommandVerb.STOP, lease=lease, who=who)
        return self._stopper.stop(command, lambda: bool(self._starting))

    def request_lease(self, request: LeaseRequest) -> Lease:
        """Send a request about the control lease and return who is in control.

        Raises:
            Conflict: somebody else is in control, or the token is out of date.
            Unreachable: the executor does not answer.
        """
        return decode_lease(self._bus.ask(self._keys.executor_lease, encode_lease_request(request)))

    def revoke(self, plan: str, *, reason: str, who: str = "") -> None:
        """Revoke a plan's certificate: the plan never starts again, and an execution of it is held for good.

        Raises:
            NotFound: no such plan.
        """
        stored = self._store.plan(plan)
        self._store.journal.revoke(stored.id, who=who, reason=reason)
        status = self.status
        if status is not None and not status.state.is_resting:
            command = Command(CommandVerb.REVOKE, plan_id=stored.id, reason=reason, who=who)
            self._bus.ask(self._keys.executor_command, encode_command(command))

    def get(self, execution: str) -> Execution:
        """Return an execution with its present status; raises NotFound."""
        row = self._store.execution(execution)
        status = self._status
        if status is not None and status.execution == execution:
            return Execution(row.id, row.plan, row.created_ns, status)
        return row

    def wait(self, execution: str, *, timeout: float) -> ExecutorStatus:
        """Return the final status of an execution.

        Raises:
            Unreachable: it did not end within `timeout` [s].
        """

        def ended() -> bool:
            return self._status is not None and self._status.execution == execution and self._status.state.is_resting

        with self._changed:
            if not self._changed.wait_for(ended, timeout):
                state = self._status.state if self._status else "silent"
                raise Unreachable(f"execution {execution} did not end within {timeout:g} s; the executor is {state}")
            assert self._status is not None
            return self._status

    def _start_execution(self, command: Command, header: MotionHeader) -> Execution:
        key, plan = command.execution, header.plan.id if header.plan else None
        self._store.put_execution(
            key, plan, ExecutorStatus(execution=key, state=ExecutorState.STARTING, override=command.override)
        )
        self._plans[key] = plan
        self._recorder.begin(header)
        self._starting.add(key)
        try:
            self._bus.ask(self._keys.executor_command, encode_command(command), timeout=30.0)
        except TeachpathError as error:
            refused = ExecutorStatus(execution=key, state=ExecutorState.FAULTED, reason=str(error))
            self._store.put_execution(key, plan, refused)
            self._recorder.abandon()
            raise
        finally:
            self._starting.discard(key)
        return self.get(key)

    def _check_certificate(self, plan: Plan) -> None:
        reason = self._store.journal.revoked(plan.id)
        if reason:
            raise PathRefused(f"the certificate of {plan.id} was revoked: {reason}; plan the path again")
        with suppress(NotFound):
            if self._scene(plan.scene.name) != plan.scene:
                raise PathRefused(
                    f"scene {plan.scene.name} has changed since {plan.id} was certified; plan the path again"
                )

    def _receive(self, _: str, payload: bytes) -> None:
        with suppress(UnusableInput):
            status = decode_status(payload)
            with self._changed:
                before, self._status = self._status, status
                self._last_seen = time.monotonic()
                self._changed.notify_all()
            self._stopper.on_status(status)
            if before is None or (before.execution, before.state) != (status.execution, status.state):
                self._received.put(status)

    def _receive_entry(self, _: str, payload: bytes) -> None:
        with suppress(UnusableInput):
            self._received.put(decode_entry(payload))

    def _write(self) -> None:
        """Store what was received, on a thread of its own: the bus's threads must not wait for the disk."""
        while (news := self._received.get()) is not None:
            if isinstance(news, JournalEntry):
                self._store.journal.write(news)
            elif news.execution in self._plans:
                self._store.put_execution(news.execution, self._plans[news.execution], news)
