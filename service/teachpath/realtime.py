"""Real-time scheduling of the thread that paces an arm, or the next best where the system refuses it."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Final

EXECUTOR_PRIORITY: Final = 50  # of SCHED_FIFO, 1 to 99
SIMULATOR_PRIORITY: Final = 40
NICE: Final = -10  # niceness where real-time scheduling is refused; that of others is 0, and lower goes first
ADVICE: Final = "allow it by `USER - rtprio {0}` in /etc/security/limits.conf, or by LimitRTPRIO={0} in a systemd unit"


def set_fifo(priority: int) -> None:
    """Run this thread before all ordinary ones; what it starts later is ordinary again."""
    os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(priority))


def set_nice(nice: int) -> None:
    """Set the niceness of this thread, on Linux of it alone."""
    os.setpriority(os.PRIO_PROCESS, 0, nice)


def request_realtime(
    priority: int, *, fifo: Callable[[int], None] = set_fifo, nice: Callable[[int], None] = set_nice
) -> str:
    """Ask the system to run this thread before all ordinary ones, else before most; return in words what it granted.

    Args:
        priority: of SCHED_FIFO.
        fifo: asks for it.
        nice: asks for a niceness.
    """
    try:
        fifo(priority)
    except (AttributeError, OSError) as error:
        refused, advice = f"no real-time scheduling ({error})", ADVICE.format(priority)
    else:
        return f"real-time scheduling SCHED_FIFO {priority}"
    try:
        nice(NICE)
    except (AttributeError, OSError):
        return f"{refused}: the loop shares the processor, watch its lateness; {advice}"
    return f"{refused}, but nice {NICE}: watch the loop's lateness; {advice}"
