"""A process that works on one call after another, and can be killed in the middle of one."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import Connection
from typing import Any, TypeVar

from teachpath.jobs.process_pipe import ProcessPipe, log_to_service
from teachpath.logs import continue_request, relay, request_number
from teachpath.process_server import CONTEXT, process_start

T = TypeVar("T")


class KillablePool:
    """Runs calls in a process of its own, in their order; the process starts with the first call.

    Only work without side effects belongs here: what a killed process was at is lost. What it logs stands in the log of
    the service, under the number of the request that its call belongs to.

    Args:
        initializer: called first in every new process; with `on_report`, its first argument is where it sends reports.
        initargs: its other arguments.
        part: of the station, in the log.
        on_report: called with what the process sends, on a thread of its own; None: it reports nothing.
    """

    def __init__(
        self,
        initializer: Callable[..., object],
        *initargs: Any,
        part: str = "worker",
        on_report: Callable[[Any], object] | None = None,
    ) -> None:
        self._initializer = initializer
        self._initargs = initargs
        self._part = part
        self._on_report = on_report
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
            pipes: list[ProcessPipe] = []
            if self._executor is None:
                pipes = self._open_pipes()
                writers = [pipe.writer for pipe in pipes]
                initargs = (writers[0], self._part, self._initializer, (*writers[1:], *self._initargs))
                self._executor = ProcessPoolExecutor(1, CONTEXT, _init_process, initargs)
            try:
                with process_start():
                    return self._executor.submit(_call, request_number(), function, arguments)
            finally:
                for pipe in pipes:  # the process has begun with its first call
                    pipe.leave_writer()

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

    def _open_pipes(self) -> list[ProcessPipe]:
        log = ProcessPipe(f"log of {self._part}", relay)
        return [log, ProcessPipe(f"reports of {self._part}", self._on_report)] if self._on_report else [log]


def _init_process(writer: Connection, part: str, initializer: Callable[..., object], initargs: tuple[Any, ...]) -> None:
    log_to_service(writer, part)
    initializer(*initargs)


def _call(number: str, function: Callable[..., T], arguments: tuple[Any, ...]) -> T:
    continue_request(number)
    return function(*arguments)
