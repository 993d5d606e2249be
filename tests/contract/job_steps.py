"""Steps of jobs for tests of executors; they import little, for every process of a job imports them."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from teachpath.errors import LearningFailed
from tests.waiting import HANG

Progress = Callable[[float, str], None]


def add(*numbers: int, progress: Progress) -> int:
    for share in (0.25, 0.5, 1.0):
        progress(share, f"{share:.0%} of the sum")
    return sum(numbers)


def negated(*numbers: int) -> tuple[int, ...]:
    return tuple(-number for number in numbers)


def with_process(made: int, *numbers: int) -> tuple[int, tuple[int, ...], int]:
    return made, numbers, os.getpid()


def tell(word: str, *, progress: Progress) -> str:
    return word


def refuse(*_: object, progress: Progress) -> None:
    raise LearningFailed("too few", "demonstration-7")


def fault(*, progress: Progress) -> None:
    raise ZeroDivisionError("boom")


def die_once(been: Path, *, progress: Progress) -> str:
    if not been.exists():
        been.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return "alive"


def die(*_: object, progress: Progress) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def linger(*_: object, progress: Progress) -> None:
    while True:
        progress(0.5, "waiting")
        time.sleep(0.01)


def hang(begun: Path, *, progress: Progress) -> None:
    write_whole(begun, str(os.getpid()))
    time.sleep(HANG)


def write_whole(file: Path, text: str) -> None:
    """Write a file that is there only with its content."""
    part = file.with_suffix(f".{os.getpid()}")
    part.write_text(text)
    part.replace(file)


def wait_once(been: Path, released: Path, *, progress: Progress) -> str:
    first = not been.exists()
    write_whole(been, str(os.getpid()))
    while first and not released.exists():
        time.sleep(0.01)
    return "first" if first else "again"


def devour(*, progress: Progress) -> int:
    return len(bytearray(2**30))
