"""One process that does the jobs of some kinds in their order, each within limits of memory and time."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.queues import Queue
from typing import Any, Final

from teachpath.errors import Cancelled, OverLimit
from teachpath.jobs import worker
from teachpath.jobs.pool import KillablePool
from teachpath.process_server import CONTEXT

log = logging.getLogger("teachpath")

POLL_INTERVAL: Final = 0.1  # [s] between two looks at whether a job was cancelled or takes too long
CANCEL_GRACE: Final = 3.0  # [s] after which a cancelled job that reports nothing is ended with its process


@dataclass(frozen=True)
class LaneLimits:
    """What a job of a lane may take: memory beside its libraries [bytes], and time [s]."""

    memory: int
    duration: float


class JobLane:
    """Calls `process` with the keys of its jobs, one after another, on a thread of its own.

    Args:
        name: of its thread.
        limits: of each of its jobs.
        progress: receives the reports of its process.
        process: does the job of a key; it calls `work`.
    """

    def __init__(
        self,
        name: str,
        limits: LaneLimits,
        progress: Queue[tuple[str, float, str]],
        process: Callable[[JobLane, str], None],
    ) -> None:
        self.name, self._limits, self._process = name, limits, process
        self._queue: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._cancel = CONTEXT.Event()
        self._stopping = threading.Event()
        self._pool = KillablePool(worker.init_worker, progress, self._cancel, limits.memory)
        self._thread = threading.Thread(target=self._run, name=f"jobs: {name}", daemon=True)
        self.running = ""

    def start(self) -> None:
        """Begin to work."""
        self._thread.start()

    def stop(self) -> None:
        """Stop at once, even in the middle of a job."""
        self._stopping.set()
        self._cancel.set()
        self._queue.put(None)
        self._pool.close()
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
        self._queue.put(key)

    def cancel(self) -> None:
        """Cancel the running job."""
        self._cancel.set()

    def work(self, function: Callable[..., Any], inputs: tuple[Any, ...]) -> Any:
        """Return what `function` returns for the running job.

        Raises:
            Cancelled: the job was cancelled.
            OverLimit: it took too much time or memory.
            BrokenProcessPool: its process died; another one starts with the next job.
        """
        try:
            return self._await(self._pool.submit(worker.work, self.running, function, inputs))
        except MemoryError:
            self._pool.kill()
            raise OverLimit(
                f"it needs over {self._limits.memory} bytes of memory, the limit; give it less, or raise the setting "
                "(jobs.max_memory, for files jobs.max_file_memory)"
            ) from None
        except BrokenProcessPool:
            self._pool.kill()
            raise

    def _await(self, future: Future[Any]) -> Any:
        deadline, grace_end = time.monotonic() + self._limits.duration, float("inf")
        while True:
            try:
                return future.result(timeout=POLL_INTERVAL)
            except TimeoutError:
                if future.done():
                    raise
            now = time.monotonic()
            if self._cancel.is_set():
                grace_end = min(grace_end, now + CANCEL_GRACE)
            if now > grace_end:
                self._pool.kill()
                raise Cancelled("cancelled by the operator; its process was ended")
            if now > deadline:
                self._pool.kill()
                raise OverLimit(
                    f"it takes over {self._limits.duration:g} s, the limit; give it less, or raise the setting "
                    "(jobs.max_duration, for files jobs.max_file_duration)"
                )

    def _run(self) -> None:
        with suppress(BrokenProcessPool):  # told to stop already
            self._pool.submit(worker.begin)
        while (key := self._queue.get()) is not None and not self._stopping.is_set():
            self._cancel.clear()
            self.running = key
            try:
                self._process(self, key)
            except Exception:  # the job is run again at the next start; those behind it must not wait for that
                log.exception("job %s could not be ended in the store", key)
            finally:
                self.running = ""
