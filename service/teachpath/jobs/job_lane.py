"""Jobs of some kinds that are done in their order, one after another."""

from __future__ import annotations

import logging
import queue
import threading
from collections.abc import Callable
from typing import Any

from teachpath.jobs.executors import JobExecutor, Work

log: logging.Logger = logging.getLogger("teachpath")

Orders = queue.SimpleQueue[str | None]


class JobLane:
    """Calls `process` with the keys of its jobs, one after another, on a thread of its own.

    Args:
        name: of its thread.
        executor: works on its jobs.
        process: does the job of a key; it calls `work`.
        orders: keys of jobs that wait; several lanes may take from the same.
    """

    def __init__(
        self, name: str, executor: JobExecutor, process: Callable[[JobLane, str], None], orders: Orders
    ) -> None:
        self._executor, self._process, self._orders = executor, process, orders
        self.name: str = name
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"jobs: {name}", daemon=True)
        self.running: str = ""

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def request_stop(self) -> None:
        """Stop at once, even in the middle of a job; `join` waits for it."""
        self._stopping.set()
        self._orders.put(None)
        self._executor.close()

    def join(self) -> None:
        """Wait until it has stopped."""
        if self._thread.ident is not None:
            self._thread.join(timeout=10.0)

    @property
    def is_stopping(self) -> bool:
        """Whether it was told to stop."""
        return self._stopping.is_set()

    def wait_for_stop(self, seconds: float) -> bool:
        """Wait until it is told to stop, but no longer; return whether it was."""
        return self._stopping.wait(seconds)

    def put(self, key: str) -> None:
        """Queue a job."""
        self._orders.put(key)

    def cancel(self) -> None:
        """Cancel the running job."""
        self._executor.cancel()

    def work(self, work: Work, inputs: tuple[Any, ...]) -> Any:
        """Return the outcome of the running job; raises as `JobExecutor.work`."""
        return self._executor.work(self.running, work, inputs)

    def _run(self) -> None:
        self._executor.begin()
        while (key := self._orders.get()) is not None and not self._stopping.is_set():
            self._executor.renew()
            self.running = key
            try:
                self._process(self, key)
            except Exception:  # the job is run again at the next start; those behind it must not wait for that
                log.exception("job %s could not be ended in the store", key)
            finally:
                self.running = ""
