"""Monitors the executor: keeps its newest status, and stores the statuses and the journal that it publishes."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.store.lists import Execution
from teachpath.io.store.pages import Page, PageRequest
from teachpath.io.store.store import Store
from teachpath.io.wire import decode_entry, decode_status
from teachpath.records import ExecutorStatus, JournalEntry
from teachpath_proto.control import ExecutorState
from teachpath_proto.keys import Keys

SILENCE_TIMEOUT: Final = 1.0  # [s] without a status after which the executor counts as silent
CUT_OFF: Final = "the service ended before the execution did; look where the arm stands, then start again"


class ExecutorMonitor:
    """Receives what the executor publishes, and knows every execution that has not ended.

    Args:
        on_status: called with each status, on a thread of the bus.
        on_entry: called with each entry of the journal, after it was stored.

    Attributes:
        unacknowledged: that the arm moved unasked, as an executor said that died before somebody acknowledged it.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        store: Store,
        *,
        on_status: Callable[[ExecutorStatus], None] = lambda status: None,
        on_entry: Callable[[JournalEntry], object] = lambda entry: None,
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._store = store
        self._on_status = on_status
        self._on_entry = on_entry
        self.unacknowledged: str = ""
        self._lock = threading.Lock()
        self._latest: ExecutorStatus | None = None
        self._received_at = -SILENCE_TIMEOUT  # [s, monotonic]
        self._plans: dict[str, str | None] = {}  # of the executions of this service, by their ids
        self._under_way: dict[str, ExecutorStatus] = {}  # newest status of those that have not ended
        self._lost: set[str] = set()  # ids of the executions whose executor died
        self._handles: list[Handle] = []
        self._to_store: queue.SimpleQueue[ExecutorStatus | JournalEntry | None] = queue.SimpleQueue()
        self._writer: threading.Thread | None = None

    def start(self) -> None:
        """Receive from now on; executions that an earlier service left under way end as faulted."""
        for execution in self._store.unfinished_executions():
            ended = replace(execution.status, state=ExecutorState.FAULTED, reason=CUT_OFF)
            self._store.put_execution(execution.id, execution.plan, ended)
        self._handles = [
            self._bus.subscribe(self._keys.executor_status, self._receive_status),
            self._bus.subscribe(self._keys.executor_journal, self._receive_entry),
        ]
        self._writer = threading.Thread(target=self._write, name="executor monitor", daemon=True)
        self._writer.start()

    def stop(self) -> None:
        """Stop receiving; what came is stored first, and what has not ended by then ends as faulted."""
        for handle in self._handles:
            handle.close()
        self._handles.clear()
        if self._writer is not None:
            self._end_as_faulted(CUT_OFF)
            self._to_store.put(None)
            self._writer.join()
            self._writer = None

    @property
    def status(self) -> ExecutorStatus | None:
        """The executor's newest status, or None when the executor is silent."""
        return self._latest if time.monotonic() - self._received_at < SILENCE_TIMEOUT else None

    def track(self, execution: str, plan: str | None, status: ExecutorStatus) -> None:
        """Store a new execution; its statuses are stored from now on."""
        self._store.put_execution(execution, plan, status)
        with self._lock:
            self._plans[execution] = plan
            self._under_way[execution] = status

    def refuse(self, execution: str, reason: str) -> None:
        """End an execution as faulted that the executor has refused."""
        with self._lock:
            self._under_way.pop(execution, None)
        refused = ExecutorStatus(execution=execution, state=ExecutorState.FAULTED, reason=reason)
        self._store.put_execution(execution, self._plans[execution], refused)

    def get(self, execution: str) -> Execution:
        """Return an execution with its present status; raises NotFound."""
        return self._with_latest(self._store.execution(execution))

    def page(self, wanted: PageRequest) -> Page[Execution]:
        """List executions with their present statuses, newest first."""
        page = self._store.lists.executions(wanted)
        return Page([self._with_latest(row) for row in page.entries], page.next)

    def _with_latest(self, row: Execution) -> Execution:
        latest = self._latest
        return replace(row, status=latest) if latest is not None and latest.execution == row.id else row

    def end_lost(self, cause: str) -> None:
        """End every execution that is under way as faulted, because the executor died of `cause`."""
        self._received_at = -SILENCE_TIMEOUT  # nothing was heard of the next executor yet
        self.unacknowledged = (self._latest.unasked_motion if self._latest else "") or self.unacknowledged
        self._end_as_faulted(f"the executor died ({cause}); look where the arm stands, then start again")

    def _end_as_faulted(self, reason: str) -> None:
        with self._lock:
            for execution, status in self._under_way.items():
                lost = replace(status, state=ExecutorState.FAULTED, reason=reason)
                self._lost.add(execution)
                self._to_store.put(lost)
                if self._latest is None or self._latest.execution in ("", execution):
                    self._latest = lost
            self._under_way.clear()

    def _receive_status(self, _: str, payload: bytes) -> None:
        with suppress(UnusableInput):
            status = decode_status(payload)
            if self.unacknowledged and not status.unasked_motion:  # the present executor knows nothing of it
                status = replace(status, unasked_motion=self.unacknowledged)
            with self._lock:
                if status.execution in self._lost:
                    return  # sent before the executor died
                before, self._latest = self._latest, status
                self._received_at = time.monotonic()
                if status.state.is_resting:
                    self._under_way.pop(status.execution, None)
                elif status.execution in self._plans:
                    self._under_way[status.execution] = status
            self._on_status(status)
            if before is None or (before.execution, before.state) != (status.execution, status.state):
                self._to_store.put(status)

    def _receive_entry(self, _: str, payload: bytes) -> None:
        with suppress(UnusableInput):
            self._to_store.put(decode_entry(payload))

    def _write(self) -> None:
        """Store what was received, on a thread of its own: the bus's threads must not wait for the disk."""
        while (received := self._to_store.get()) is not None:
            if isinstance(received, JournalEntry):
                self._store.journal.write(received)
                self._on_entry(received)
            elif received.execution in self._plans:
                self._store.put_execution(received.execution, self._plans[received.execution], received)
