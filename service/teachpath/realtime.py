"""Real-time scheduling of what paces an arm and of what brings its setpoints, or the next best where it is refused."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

EXECUTOR_PRIORITY: Final = 50  # of SCHED_FIFO, 1 to 99
SIMULATOR_PRIORITY: Final = 40
MESSAGE_PRIORITY: Final = 30  # of threads that carry messages: they may not delay the loops that they serve
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


def set_inherited_fifo(priority: int) -> None:
    """Run this thread, and what it starts later, before all ordinary ones."""
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))


@contextmanager
def realtime_threads(wanted: bool = True, *, fifo: Callable[[int], None] = set_inherited_fifo) -> Iterator[None]:
    """Run the threads that this one starts meanwhile, and those that they start, before all ordinary ones.

    It is for the threads of a session on the bus. A setpoint passes through several of them in three processes; on a
    busy machine each would wait for its turn, and the arm come to rest. Where the system refuses real-time scheduling
    they are ordinary threads, as `request_realtime` says for the loops.

    Args:
        wanted: whether to ask for it.
        fifo: asks for it.
    """
    try:
        before = os.sched_getscheduler(0), os.sched_getparam(0)
        if wanted:
            fifo(MESSAGE_PRIORITY)
    except (AttributeError, OSError):
        wanted = False
    try:
        yield
    finally:
        if wanted:
            os.sched_setscheduler(0, *before)
