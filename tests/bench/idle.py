"""What a station at rest costs: the processor time of each of its processes while nobody asks for anything."""

import os
import time
from pathlib import Path

from tests.bench.report import Figure, against

SETTLING_TIME = 3.0  # [s] until a station that has just begun is at rest
SECONDS = 10.0  # [s] of each measurement
REPEATS = 2
PROCESS_NAMES = ("executor", "simulator")


def measure() -> list[Figure]:
    """Return the share of a core that this process (it serves) and each of its children use at rest."""
    time.sleep(SETTLING_TIME)
    processes = {"service": os.getpid(), **_children()}
    shares: dict[str, list[float]] = {name: [] for name in processes}
    for _ in range(REPEATS):
        before, began = {name: _seconds(pid) for name, pid in processes.items()}, time.monotonic()
        time.sleep(SECONDS)
        took = time.monotonic() - began
        for name, pid in processes.items():
            shares[name].append(100 * (_seconds(pid) - before[name]) / took)
    return [
        against(f"station at rest: {name}", values, "% of a core", name="a core", value=100.0)
        for name, values in shares.items()
    ]


def _children() -> dict[str, int]:
    """Return executor and simulated arm by name; they are forked from a child of this process."""
    names, parents = {}, {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            names[int(folder.name)] = (folder / "comm").read_text().strip()
            parents[int(folder.name)] = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue  # it has just ended
    return {
        name: pid
        for pid, name in names.items()
        if name in PROCESS_NAMES and parents.get(parents.get(pid, 0)) == os.getpid()
    }


def _seconds(pid: int) -> float:
    """Return the processor time that a process has used, its threads together [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
