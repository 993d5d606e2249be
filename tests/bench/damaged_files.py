"""Damaged files of every format: how many are read, refused or worse, how long the slowest takes, and how much memory.

`python -m tests.bench.damaged_files COUNT [FORMAT ...]` tries COUNT files of each. It ends with 1 where a file takes
over 2 s or 500 MB, or ends in anything but motions or a sentence.
"""

from __future__ import annotations

import multiprocessing
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NoReturn

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

Result = tuple[int, int, float, float, str]  # read, refused, slowest [s], memory [MB], what went wrong
TIME_LIMIT, MOST_MEMORY = 2.0, 500.0  # [s], [MB]
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
    print(f"{'format':14} {'read':>6} {'refused':>8} {'slowest [s]':>12} {'memory [MB]':>12}")
    for label, (kind, name, content) in files.items():
        if not chosen or label in chosen:
            read, refused, slowest, memory, fault = apart(partial(_try, kind, name, content, count))
            print(f"{label:14} {read:6} {refused:8} {slowest:12.2f} {memory:12.0f} {fault}", flush=True)
            good &= not fault and slowest <= TIME_LIMIT and memory <= MOST_MEMORY
    return 0 if good else 1


def apart(work: Callable[[], Any]) -> Any:
    """Run in a process of its own, whose memory is measured; that dies with what it tried to read."""
    near, far = multiprocessing.get_context("fork").Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=_send, args=(far, work))
    process.start()
    far.close()
    try:
        return near.recv()
    except EOFError:
        return 0, 0, float("nan"), float("nan"), "the process died"
    finally:
        process.join()


def _send(far: Connection, work: Callable[[], object]) -> None:
    far.send(work())


def _try(kind: str, name: str, content: bytes, count: int) -> Result:
    read = refused = 0
    slowest, before = 0.0, _memory()
    options = ReadOptions(columns=COLUMNS if kind == "lerobot" else "")
    signal.signal(signal.SIGALRM, _hangs)
    for number in range(count):
        broken = damaged(content, np.random.default_rng([number, len(content)]))
        start = time.process_time()
        signal.alarm(HANG)
        try:
            read_motions(broken, name, kind, options, ImportSettings())
            read += 1
        except UnusableInput:
            refused += 1
        except BaseException as error:
            return read, refused, slowest, _memory() - before, f"file {number}: {type(error).__name__}: {error}"[:120]
        finally:
            signal.alarm(0)
        slowest = max(slowest, time.process_time() - start)
    return read, refused, slowest, _memory() - before, ""


def _memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000.0


def _hangs(*_: object) -> NoReturn:
    raise TimeoutError(f"over {HANG} s")


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2:]))
