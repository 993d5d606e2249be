"""A process that works on one call after another, and can be killed in the middle of one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any, TypeVar

T = TypeVar("T")


class KillablePool:
    """Runs calls in a process of its own, in their order; the process starts with the first call.

    Only work without side effects belongs here: what a killed process was at is lost.

    Args:
        initializer: called first in every new process.
        initargs: arguments of the initializer.
    """

    def __init__(self, initializer: Callable[..., object], *initargs: Any) -> None:
        self._initializer = initializer
        self._initargs = initargs
        self._lock = threading.Lock()
        self._executor: ProcessPoolExecutor | None = None
        self._closed = False

    def submit(self, function: Callable[..., T], *arguments: Any) -> Future[T]:
        """Queue a call.

        The future raises BrokenProcessPool when the process dies or is killed during the call, and CancelledError when
        the process is killed before the call.

        Raises:
            BrokenProcessPool: the process has died, and `kill` lets another one start; or the pool is closed.
        """
        with self._lock:
            if self._closed:
                raise BrokenProcessPool("the pool is closed")
            if self._executor is None:
                self._executor = ProcessPoolExecutor(1, get_context("spawn"), self._initializer, self._initargs)
            with _without_interrupts():
                return self._executor.submit(function, *arguments)

    def close(self) -> None:
        """Kill the process, and let no other start."""
        with self._lock:
            self._closed = True
        self.kill()

    def kill(self) -> None:
        """Kill the process and drop all calls; the next call starts another process. A second kill does nothing."""
        with self._lock:
            executor, self._executor = self._executor, None
        if executor is None:
            return
        processes = list((executor._processes or {}).values())  # Python has no public way to them before 3.14
        executor.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.kill()
            process.join()


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Let a process that starts meanwhile never see Ctrl-C, which goes to all of a terminal before it can ignore it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
