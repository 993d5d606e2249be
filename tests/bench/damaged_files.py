"""Damaged files of every format: how many are read, refused or worse, how long the slowest takes, and how much memory.

`python -m tests.bench.damaged_files COUNT [FORMAT ...]` tries COUNT files of each. It ends with 1 where a file takes
over 2 s or 500 MB, or ends in anything but motions or a sentence. Some libraries end their process at some files, which
are counted: an import reads in a process of its own and says that it died (tests/unit/jobs/test_limited_process.py).
"""

from __future__ import annotations

import multiprocessing
import resource
import signal
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NoReturn

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.readers.registry import read_motions
from tests.unit.io.readers.bags import STORAGES, write_bag
from tests.unit.io.readers.test_bags import motion
from tests.unit.io.readers.test_damage import damaged
from tests.unit.io.readers.test_formats import ARRAYS, FILES, mat
from tests.unit.io.readers.test_hdf5 import markers, robomimic
from tests.unit.io.readers.test_lerobot import COLUMNS, NAME, frames


@dataclass(frozen=True)
class Outcome:
    """What became of one file: whether it was read, its time [s], memory of the process [MB], what went wrong."""

    read: bool
    seconds: float
    memory: float
    fault: str


@dataclass(frozen=True)
class Result:
    """What became of all files: how many were read, refused or ended their process; the slowest [s], memory [MB]."""

    read: int = 0
    refused: int = 0
    died: int = 0
    slowest: float = 0.0
    memory: float = 0.0
    fault: str = ""

    @property
    def tried(self) -> int:
        """How many files."""
        return self.read + self.refused + self.died

    def with_outcome(self, outcome: Outcome) -> Result:
        """Return the result with one more file."""
        return replace(
            self,
            read=self.read + outcome.read,
            refused=self.refused + (not outcome.read),
            slowest=max(self.slowest, outcome.seconds),
            memory=max(self.memory, outcome.memory),
            fault=self.fault or outcome.fault,
        )


TIME_LIMIT, MEMORY_LIMIT = 2.0, 500.0  # [s], [MB]
HANG = 30  # [s]


def main(count: int, chosen: list[str]) -> int:
    """Try so many files of each format, print a line for each, and return the status to end with."""
    files = {kind: (kind, name, content) for kind, (name, content) in FILES.items()}
    files["mat, plain"] = ("mat", "f.mat", mat(compressed=False, **ARRAYS))
    files["lerobot"] = ("lerobot", NAME, frames())
    files["hdf5"], files["c3d"] = ("hdf5", "f.hdf5", robomimic()), ("c3d", "f.c3d", markers(["LWRA"]))
    with tempfile.TemporaryDirectory() as folder:
        for storage in STORAGES:
            place = Path(folder) / storage
            place.mkdir()
            files[f"rosbag {storage}"] = ("rosbag", "f.bag", write_bag(place, storage, motion(storage)))
    good = True
    print(f"{'format':14} {'read':>6} {'refused':>8} {'died':>6} {'slowest [s]':>12} {'memory [MB]':>12}")
    for label, (kind, name, content) in files.items():
        if not chosen or label in chosen:
            all_of = try_all(kind, name, content, count)
            print(
                f"{label:14} {all_of.read:6} {all_of.refused:8} {all_of.died:6} {all_of.slowest:12.2f} "
                f"{all_of.memory:12.0f} {all_of.fault}",
                flush=True,
            )
            good &= not all_of.fault and all_of.slowest <= TIME_LIMIT and all_of.memory <= MEMORY_LIMIT
    return 0 if good else 1


def try_all(kind: str, name: str, content: bytes, count: int) -> Result:
    """Try so many damaged files in processes of their own, a new one after each that a file has ended."""
    total = Result()
    while total.tried < count:
        near, far = multiprocessing.get_context("fork").Pipe(duplex=False)
        work = partial(_try, far, kind, name, content, range(total.tried, count))
        process = multiprocessing.get_context("fork").Process(target=work)
        process.start()
        far.close()
        with suppress(EOFError):
            while True:
                total = total.with_outcome(near.recv())
        process.join()
        if total.fault:
            break
        if total.tried < count:
            total = replace(total, died=total.died + 1)
    return total


def _try(far: Connection, kind: str, name: str, content: bytes, numbers: range) -> None:
    """Read damaged files and send the outcome of each."""
    before = _memory()
    options = ReadOptions(columns=COLUMNS if kind == "lerobot" else "")
    signal.signal(signal.SIGALRM, _hangs)
    for number in numbers:
        broken = damaged(content, np.random.default_rng([number, len(content)]))
        start, read, fault = time.process_time(), False, ""
        signal.alarm(HANG)
        try:
            read_motions(broken, name, kind, options, ImportSettings())
            read = True
        except UnusableInput:
            pass
        except BaseException as error:
            fault = f"file {number}: {type(error).__name__}: {error}"[:120]
        finally:
            signal.alarm(0)
        far.send(Outcome(read, time.process_time() - start, _memory() - before, fault))


def _memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000.0


def _hangs(*_: object) -> NoReturn:
    raise TimeoutError(f"over {HANG} s")


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2:]))
