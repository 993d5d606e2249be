"""The executions: sends plans and commands to the executor's process, and records what it does."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Final

from teachpath.errors import Conflict, NotFound, TeachpathError, Unanswered, Unreachable, UnusableInput
from teachpath.io.bus import Bus
from teachpath.io.documents import encode
from teachpath.io.store.lists import Execution
from teachpath.io.store.motions import MotionHeader, read_motion
from teachpath.io.store.pages import Page, PageRequest
from teachpath.io.store.store import Store
from teachpath.io.wire import decode_lease, decode_status, encode_command, encode_lease_request
from teachpath.logs import request_number
from teachpath.motion.analysis.time_series import time_series
from teachpath.motion.arm.model import Arm
from teachpath.records import Command, ExecutorStatus, JournalEntry, Lease, LeaseRequest, TeleopRequest
from teachpath.robot.executor_monitor import ExecutorMonitor
from teachpath.robot.motion_recorder import SETTLING_NS, MotionRecorder
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
        on_entry: called with each entry of the executor's journal.
        robot: name of the robot.
    """

    def __init__(
        self, bus: Bus, keys: Keys, store: Store, on_entry: Callable[[JournalEntry], object], *, robot: str
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._store = store
        self._robot = robot
        self._recorder = MotionRecorder(bus, keys, store.motions, robot=robot)
        self._stopper = Stopper(bus, keys)
        self._starting: set[str] = set()  # executions that the executor has not answered for yet
        self._monitor = ExecutorMonitor(bus, keys, store, on_status=self._stopper.on_status, on_entry=on_entry)

    def start(self) -> None:
        """Receive the executor's statuses and journal from now on."""
        self._recorder.start()
        self._monitor.start()

    def stop(self) -> None:
        """Stop receiving; what came is stored first."""
        self._monitor.stop()
        self._stopper.close()
        self._recorder.stop()

    def end_lost(self, cause: str) -> None:
        """End the execution that is under way as faulted, because the executor died of `cause`."""
        self._monitor.end_lost(cause)
        self._recorder.finish_at_rest()

    def faults(self) -> list[str]:
        """Return why an execution is not recorded or cannot start, in sentences for the operator."""
        unasked = self.status.unasked_motion if self.status else ""
        return [fault for fault in (self._recorder.fault, unasked) if fault]

    def recording(self, execution: str) -> Path:
        """Return the file of an execution's setpoints, joint states, statuses and journal; raises NotFound.

        Once the execution is over, the file is complete.
        """
        row = self.get(execution)
        if row.status.state.is_resting:
            self._recorder.wait_for_file(row.id)
        return self._store.motions.path(row.id)

    @property
    def status(self) -> ExecutorStatus | None:
        """The executor's newest status, or None when the executor has been silent for over a second."""
        return self._monitor.status

    def is_moving(self) -> bool:
        """Tell whether an execution is under way, held ones too."""
        status = self.status
        return status is not None and not status.state.is_resting

    def execute(self, plan: str, *, override: float = 1.0, lease: str = "", who: str = "") -> Execution:
        """Move the robot along a plan.

        Args:
            plan: id of a stored plan.
            override: share of the planned speed.
            lease: token of the control lease, when somebody holds it.
            who: name for the journal, of somebody without a lease.

        Raises:
            NotFound: no such plan.
            Conflict: another execution is running, somebody else is in control, or the task was deleted.
            PathRefused: the certificate does not hold, or the way to its start is not free.
            Unreachable: the executor does not answer.
        """
        stored = self._store.plan(plan)
        self._store.task_changes.require_open_plan(plan)
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
            Unreachable: the executor does not answer.
        """
        if command.verb not in STEERING_VERBS:
            raise UnusableInput(f"{command.verb!r} is no command; say {', '.join(STEERING_VERBS)}")
        row, status = self.get(execution), self.status
        # An executor that is silent may only have got no turn: it is asked itself what it runs.
        if row.status.state.is_resting or (status is not None and status.execution != execution):
            raise Conflict(f"execution {execution} is not running")
        self._bus.ask(self._keys.executor_command, _message(command))
        return self.get(execution)

    def acknowledge(self, *, lease: str = "", who: str = "") -> ExecutorStatus:
        """Say that somebody has seen why the arm moved unasked, so that executions may start again.

        Returns:
            The executor's status that shows it; where nothing had to be acknowledged, as it was.

        Raises:
            Conflict: the arm does not rest yet, or somebody else is in control.
            Unreachable: the executor does not answer.
        """
        command = Command(CommandVerb.ACKNOWLEDGE, lease=lease, who=who)
        status = decode_status(self._bus.ask(self._keys.executor_command, _message(command)))
        self._monitor.unacknowledged = ""
        return status

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

    def stops(self) -> dict[str, int]:
        """Return how many stops were ordered since the service began, by outcome."""
        return dict(self._stopper.outcomes)

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
            Unreachable: the executor is there and has not heard it; the plan is revoked all the same.
        """
        stored = self._store.plan(plan)
        self._store.journal.revoke(stored.id, who=who, reason=reason)
        command = Command(CommandVerb.REVOKE, plan_id=stored.id, reason=reason, who=who)
        # Also at rest: a start that is being answered ends before the revocation is heard. And also an executor that is
        # silent, for it may only have got no turn.
        try:
            self._bus.ask(self._keys.executor_command, _message(command))
        except Unreachable as error:
            if self.status is not None or isinstance(error, Unanswered):
                raise

    def get(self, execution: str) -> Execution:
        """Return an execution with its present status; raises NotFound."""
        return self._monitor.get(execution)

    def page(self, wanted: PageRequest) -> Page[Execution]:
        """List executions with their present statuses, newest first."""
        return self._monitor.page(wanted)

    def _start_execution(self, command: Command, header: MotionHeader) -> Execution:
        if self._monitor.unacknowledged:
            raise Conflict(self._monitor.unacknowledged)
        key, plan = command.execution, header.plan.id if header.plan else None
        starting = ExecutorStatus(execution=key, state=ExecutorState.STARTING, override=command.override)
        self._monitor.track(key, plan, starting)
        self._recorder.begin(header)
        self._starting.add(key)
        try:
            self._bus.ask(self._keys.executor_command, _message(command), timeout=30.0)
        except TeachpathError as error:
            self._monitor.refuse(key, str(error))
            self._recorder.finish_after(SETTLING_NS)
            if isinstance(error, Unanswered):  # an executor that is only late would move the arm when nobody expects it
                self._stopper.send(Command(CommandVerb.STOP, key))
            raise
        finally:
            self._starting.discard(key)
        return self.get(key)


def _message(command: Command) -> bytes:
    """Return the message of a command, with the number of the request that it comes from."""
    return encode_command(replace(command, id=command.id or request_number()))


def encode_series(recording: Path, points: int, arm: Arm) -> bytes:
    """Return the JSON of what the arm did over time (`TimeSeries`), from the recording of an execution."""
    motion = read_motion(recording)
    return encode(time_series(motion.setpoints, motion.states, points, arm))
