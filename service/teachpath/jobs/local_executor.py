"""Jobs worked on in a process of this machine, each within limits of memory and time."""

from __future__ import annotations

import ctypes
import time
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import Any, Final

from teachpath.errors import Cancelled, OverLimit
from teachpath.jobs import worker
from teachpath.jobs.executors import Limits, Reports, Work
from teachpath.jobs.pool import KillablePool
from teachpath.process_server import CONTEXT

POLL_INTERVAL: Final = 0.1  # [s] between two looks at whether a job was cancelled or takes too long
CANCEL_GRACE: Final = 3.0  # [s] after which a cancelled job that reports nothing is ended with its process


class LocalExecutor:
    """Works on jobs in one process, which is killed with a job that does not end.

    Args:
        limits: of each job.
        progress: receives the reports of the process, on a thread of its own: key of the job, fraction, sentence.
    """

    def __init__(self, limits: Limits, progress: Reports) -> None:
        self._limits = limits
        # In memory that the process shares, without a lock: a process that is killed with one would keep it for ever.
        self._cancel = CONTEXT.RawValue(ctypes.c_bool, False)
        self._pool = KillablePool(worker.init_worker, self._cancel, limits.memory, on_report=progress.put)

    def begin(self) -> None:
        """Begin the process, which loads what jobs need, and return at once."""
        with suppress(BrokenProcessPool):  # told to stop already
            self._pool.submit(worker.begin)

    def renew(self) -> None:
        """Forget that the job before was cancelled."""
        self._cancel.value = False

    def cancel(self) -> None:
        """Cancel the job under way, or the next one."""
        self._cancel.value = True

    def close(self) -> None:
        """Stop at once, even in the middle of a job; no other is begun."""
        self._cancel.value = True
        self._pool.close()

    def work(self, key: str, work: Work, inputs: tuple[Any, ...]) -> Any:
        """Return the outcome of a job; see `JobExecutor.work`."""
        try:
            return self._await(self._pool.submit(worker.work, key, work, inputs))
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
            if self._cancel.value:
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
