"""The executions: sends plans and commands to the executor's process and keeps what it says of itself."""

from __future__ import annotations

import threading
import time
import uuid
from contextlib import suppress

from teachpath.errors import Conflict, NotFound, Unreachable, UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.documents import encode
from teachpath.io.store import ExecutionRow, Store
from teachpath.io.wire import decode_status, encode_command
from teachpath.records import ExecutorStatus
from teachpath_proto.keys import Keys

RESTING = frozenset({"idle", "ended", "faulted"})
VERBS = ("override", "hold", "resume", "reverse", "stop")


class Executions:
    """Starts and steers executions; one at a time.

    Args:
        robot: name of the robot that is moved.
    """

    def __init__(self, bus: Bus, keys: Keys, store: Store, *, robot: str) -> None:
        self._bus, self._keys, self._store, self._robot = bus, keys, store, robot
        self._changed = threading.Condition()
        self._status: ExecutorStatus | None = None
        self._heard = 0.0
        self._plans: dict[str, str] = {}
        self._handle: Handle | None = None

    def start(self) -> None:
        """Begin to listen to the executor."""
        self._handle = self._bus.subscribe(self._keys.executor_status, self._receive)

    def stop(self) -> None:
        """Stop listening."""
        if self._handle is not None:
            self._handle.close()

    @property
    def status(self) -> ExecutorStatus | None:
        """What the executor said last, or None when it has been silent for over a second."""
        return self._status if time.monotonic() - self._heard < 1.0 else None

    def begin(self, plan: str, *, override: float = 1.0) -> ExecutionRow:
        """Move the robot along a plan.

        Raises:
            NotFound: no such plan.
            Conflict: another execution is running.
            PathRefused: the certificate does not match the plan, or the way to its start is not free.
            Unreachable: the executor does not answer.
        """
        stored = self._store.plan(plan)
        status = self.status
        if status is not None and status.state not in RESTING:
            raise Conflict(f"execution {status.execution} is {status.state}; stop it first")
        with suppress(Unreachable):  # only the simulated robot has a scene to put back
            self._bus.ask(self._keys.reset(self._robot), encode(stored.scene), timeout=5.0)
        key = f"execution-{uuid.uuid4().hex[:12]}"
        self._store.put_execution(key, plan, ExecutorStatus(execution=key, state="starting", override=override))
        self._plans[key] = plan
        command = encode_command("start", key, plan=encode(stored), override=override)
        try:
            self._bus.ask(self._keys.executor_command, command, timeout=10.0)
        except Exception as error:
            refused = ExecutorStatus(execution=key, state="faulted", reason=str(error))
            self._store.put_execution(key, plan, refused)
            raise
        return self._store.execution(key)

    def command(self, execution: str, verb: str, *, override: float = 1.0) -> ExecutionRow:
        """Steer an execution: override (speed, 0 to 1), hold, resume, reverse or stop.

        Raises:
            UnusableInput: an unknown verb.
            NotFound: no such execution.
            Conflict: it is not the one that is running.
        """
        if verb not in VERBS:
            raise UnusableInput(f"{verb!r} is no command; say {', '.join(VERBS)}")
        self._store.execution(execution)
        status = self.status
        if status is None or status.execution != execution:
            raise Conflict(f"execution {execution} is not running")
        self._bus.ask(self._keys.executor_command, encode_command(verb, execution, override=override))
        return self._store.execution(execution)

    def get(self, execution: str) -> ExecutionRow:
        """Return an execution as it stands now; raises NotFound."""
        row = self._store.execution(execution)
        status = self._status
        if status is not None and status.execution == execution:
            return ExecutionRow(row.id, row.plan, row.created_ns, status)
        return row

    def wait(self, execution: str, *, timeout: float) -> ExecutorStatus:
        """Return the final status of an execution.

        Raises:
            Unreachable: it did not end within `timeout` [s].
        """

        def ended() -> bool:
            return self._status is not None and self._status.execution == execution and self._status.state in RESTING

        with self._changed:
            if not self._changed.wait_for(ended, timeout):
                state = self._status.state if self._status else "silent"
                raise Unreachable(f"execution {execution} did not end within {timeout:g} s; the executor is {state}")
            assert self._status is not None
            return self._status

    def _receive(self, _: str, payload: bytes) -> None:
        with suppress(UnusableInput):
            status = decode_status(payload)
            with self._changed:
                before, self._status = self._status, status
                self._heard = time.monotonic()
                self._changed.notify_all()
            turned = before is None or before.state != status.state
            if turned and status.execution in self._plans:
                with suppress(NotFound):
                    self._store.put_execution(status.execution, self._plans[status.execution], status)
