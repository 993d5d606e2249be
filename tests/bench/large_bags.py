"""Large bags: how much memory the import of one takes, how long, and how often it tells how far it is.

`python -m tests.bench.large_bags [MEGABYTES] [STORAGE ...]` writes a bag of 1,000 MB of pictures with poses between
them in each storage, and reads it. It ends with 1 where reading takes over 300 MB, or another motion comes out.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.readers.registry import read_motions
from tests.bench.damaged_files import apart
from tests.unit.io.readers.bags import POSE, SECOND, STORAGES, TEXT, Messages, bag_file

MOST_MEMORY = 300.0  # [MB]
RATE, PICTURE = 100, 1_000_000  # [Hz] of poses; bytes of what lies between two of them
Result = tuple[float, float, int, str]  # time [s], memory [MB], shares told, what went wrong


def main(megabytes: int, storages: list[str]) -> int:
    """Write and read a bag in each storage, print a line for each, and return the status to end with."""
    good = True
    print(f"{'storage':8} {'MB':>6} {'seconds':>8} {'memory [MB]':>12} {'told':>6}")
    for storage in storages:
        with tempfile.TemporaryDirectory() as folder:
            file = bag_file(Path(folder), storage, _messages(storage, megabytes))
            size = file.stat().st_size / 1e6
            seconds, memory, told, fault = apart(partial(_read, file, megabytes))
        print(f"{storage:8} {size:6.0f} {seconds:8.1f} {memory:12.0f} {told:6} {fault}", flush=True)
        good &= not fault and memory <= MOST_MEMORY
    return 0 if good else 1


def _messages(storage: str, count: int) -> Iterator[tuple[str, str, int, object]]:
    messages, turn = Messages(storage), np.array([0.0, 0.0, 0.0, 1.0])
    for number in range(count):
        stamp = SECOND + number * SECOND // RATE
        pose = messages.make(POSE, stamp, np.array([_place(number), 0.2, 0.5]), turn, "world")
        yield "/hand", POSE, stamp, pose
        yield "/camera", TEXT, stamp, messages.text(chr(65 + number % 26) * PICTURE)


def _place(number: int) -> float:
    return 0.3 + 0.1 * float(np.sin(0.01 * number))


def _read(file: Path, count: int) -> Result:
    before, start, shares = _memory(), time.monotonic(), list[float]()
    with file.open("rb") as stream:
        beginning = stream.read(1000)
    found = read_motions(beginning, file.name, "", ReadOptions(), ImportSettings(), file=file, progress=shares.append)
    (track,) = found.tracks
    same = np.allclose(track.positions[:, 0], [_place(number) for number in range(count)])
    return time.monotonic() - start, _memory() - before, len(shares), "" if same else "another motion"


def _memory() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000.0


if __name__ == "__main__":
    sys.exit(main(int((sys.argv[1:] or ["1000"])[0]), sys.argv[2:] or list(STORAGES)))
