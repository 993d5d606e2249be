"""A process of its own for short work on files, limited in memory and time."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from teachpath.errors import OverLimit, Unreachable
from teachpath.jobs import worker
from teachpath.jobs.pool import KillablePool
from teachpath.jobs.settings import JobSettings

T = TypeVar("T")


class LimitedProcess:
    """Calls one function after another in a process of its own, which begins with the first call.

    Args:
        settings: the limits are those of files.
        task: what it does, for its refusals.
        part: its name in lists of processes.
    """

    def __init__(self, settings: JobSettings, task: str = "reading the recording", *, part: str = "reader") -> None:
        self._settings, self._task = settings, task
        self._pool = KillablePool(worker.init_limited, settings.max_file_memory, part=part)

    def call(self, function: Callable[..., T], *arguments: Any) -> T:
        """Return what a function returns; blocks, so call it on a thread.

        Raises:
            OverLimit: it takes too much memory, or too much time with those before it.
            Unreachable: its process died or was ended.
            TeachpathError: as the function.
        """
        duration, memory = self._settings.max_file_duration, self._settings.max_file_memory
        try:
            result: T = self._pool.submit(_call, function, arguments).result(duration)
        except TimeoutError:
            self._pool.kill()
            raise OverLimit(
                f"{self._task} takes over {duration:g} s, the limit (jobs.max_file_duration); make it smaller, or "
                "raise the setting"
            ) from None
        except MemoryError:
            self._pool.kill()
            raise OverLimit(
                f"{self._task} needs over {memory} bytes of memory, the limit (jobs.max_file_memory); raise it"
            ) from None
        except (BrokenProcessPool, CancelledError):
            self._pool.kill()
            raise Unreachable(f"{self._task}: its process died or was ended; try again") from None
        return result

    def stop(self) -> None:
        """End the process, even in the middle of a call; no other starts."""
        self._pool.close()


def _call(function: Callable[..., T], arguments: tuple[Any, ...]) -> T:
    worker.limit_memory()
    return function(*arguments)
