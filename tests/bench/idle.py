"""What a station at rest costs: the processor time of each of its processes while nobody asks for anything."""

import os
import time
from pathlib import Path

from tests.bench.report import Figure, against

SETTLED = 3.0  # [s] until a station that has just begun is at rest
SECONDS = 10.0  # [s] of each measurement
REPEATS = 2


def measure() -> list[Figure]:
    """Return the share of a core that this process (it serves) and each of its children use at rest."""
    time.sleep(SETTLED)
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
    """Return the workers by name: `python -m teachpath <name> --attached`."""
    found = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_text().split("\0")
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue  # it has just ended
        if parent == os.getpid() and "teachpath" in words:
            found[words[words.index("teachpath") + 1]] = int(folder.name)
    return found


def _seconds(pid: int) -> float:
    """Return the processor time that a process has used, its threads together [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
