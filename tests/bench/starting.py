"""What a start of a station costs: the processor time of each of its processes, `python -m tests.bench.starting`.

Beside it stands, measured between the starts, a Python that loads three of its libraries.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from statistics import median

from tests.bench.report import Figure, against, machine, print_report
from tests.system.processes import Service, family
from tests.waiting import HANG

SETTLING_TIME = 5.0  # [s] after which nothing of a start is under way any more
LIBRARIES = "import numpy, scipy, fastapi"
# Words of a process's command line or [name], the first that fit; others are those of jobs and their helpers.
NAMES = {
    " serve ": "service",
    "executor --attached": "executor",
    "[executor]": "executor",
    "simulator --attached": "simulator",
    "[simulator]": "simulator",
}


def measure(*, starts: int) -> list[Figure]:
    """Return the processor time of so many starts, until the arm can be moved and five seconds later."""
    times: dict[str, list[float]] = defaultdict(list)
    libraries = []
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        for number in range(starts):
            libraries.append(_libraries())
            with Service(Path(folder) / f"{number}" / "data") as service:
                service.station.wait_for_arm(timeout=HANG)
                times["all, when the arm is ready"].append(sum(_seconds(service).values()))
                time.sleep(SETTLING_TIME)
                each = _seconds(service)
                times[f"all, {SETTLING_TIME:g} s later"].append(sum(each.values()))
                for name, seconds in each.items():
                    times[name].append(seconds)
    beside = median(libraries)
    return [
        against(f"start of a station, processor: {name}", seconds, "s", name=LIBRARIES, value=beside)
        for name, seconds in times.items()
    ]


def _seconds(service: Service) -> dict[str, float]:
    """Return the processor time [s] of each part of a service, with those that have ended and been waited for."""
    parts: dict[str, float] = defaultdict(float)
    for pid, command in family(service.family):
        try:
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:  # it has just ended
            continue
        name = next((name for words, name in NAMES.items() if words in command), "process server, workers")
        parts[name] += sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
    return parts


def _libraries() -> float:
    def used() -> float:
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime

    before = used()
    subprocess.run([sys.executable, "-c", LIBRARIES], check=True)
    return used() - before


if __name__ == "__main__":
    print(machine())
    print_report("What a start costs", measure(starts=3))
