"""What runs in the process of the jobs: the work itself, which reports its progress and can be cancelled.

The service only names these functions. What they call is loaded in this process, or before it is forked
(`process_server.py`).
"""

from __future__ import annotations

import ctypes
import logging
import os
import resource
import signal
import threading
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import parent_process
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from teachpath.errors import Cancelled, TeachpathError
from teachpath.jobs.executors import Work
from teachpath.jobs.process_pipe import send
from teachpath.learning.settings import LearningSettings
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.records import Learned, LearnedPath, Plan, Scene, ShownPosture, ToolOutput, Trajectory

log: logging.Logger = logging.getLogger("teachpath")

Progress = Callable[[float, str], None]

# [s] between two reports of one sentence: each is a row in the store and a message to every page
PROGRESS_INTERVAL = 0.25
NICENESS = 10  # of the process, so that the control loop and the service go first

_reports: Connection | None = None
_cancel: ctypes.c_bool | None = None
_memory_limit = 0  # bytes beside what the process has taken before its first job; 0: none, or set already


def init_worker(reports: Connection, cancel: ctypes.c_bool, memory_limit: int) -> None:
    """Prepare this process: it reports to `reports`, is cancelled by `cancel`, and ends with its parent."""
    global _reports, _cancel
    _reports, _cancel = reports, cancel
    init_limited(memory_limit)


def init_limited(memory_limit: int) -> None:
    """Prepare this process: it ends with its parent, lets others go first, and knows its limit of memory [bytes].

    What it writes is for its user alone.
    """
    global _memory_limit
    _memory_limit = memory_limit
    os.umask(0o077)
    exit_with_parent()
    lower_priority()


def lower_priority() -> None:
    """Let the control loop and the service go first.

    Linux may share time between sessions before it looks at the niceness of a process (autogroups). There, a worker in
    the session of the service would use up the time of the service; so it begins a session of its own.
    """
    os.nice(NICENESS)
    with suppress(OSError):  # it leads a session already
        os.setsid()


def exit_with_parent() -> None:
    """End this process with its parent; ignore Ctrl-C, which the parent handles."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_exit_with_parent, name="parent", daemon=True).start()


def _exit_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
    os._exit(1)


def begin() -> None:
    """Do nothing: with its first call this process begins."""


def work(key: str, work: Work, inputs: tuple[Any, ...]) -> Any:
    """Take all steps of the work for job `key`.

    It may report its progress as often as it likes, and is cancelled there. Only reports that a person could see
    are passed on.
    """
    reported, due = "", 0.0
    limit_memory()

    def progress(fraction: float, sentence: str) -> None:
        """Report changes of the sentence, and else at intervals; raises Cancelled."""
        nonlocal reported, due
        if _cancel is not None and _cancel.value:
            raise Cancelled("cancelled by the operator")
        now = time.monotonic()
        if _reports is not None and (sentence != reported or now >= due or fraction >= 1.0):
            send(_reports, (key, fraction, sentence))
            reported, due = sentence, now + PROGRESS_INTERVAL

    begun = time.monotonic()
    try:
        loaded = work.load(*inputs) if work.load else inputs
        made = work.function(*loaded, progress=progress)
        if work.conclude:
            made = work.conclude(made, *inputs)
    except (TeachpathError, MemoryError, OSError):
        raise  # a refusal, which the service tells
    except Exception:
        log.exception("%s failed; please report this fault of teachpath", key)
        raise
    log.info("%s took %.2f s of its process", key, time.monotonic() - begun)
    return made


def call(function: Callable[..., Any], *inputs: Any, progress: Progress) -> Any:
    """Return `function(*inputs)`: a step of a job that reports nothing."""
    del progress
    return function(*inputs)


def limit_memory() -> None:
    """Limit what this process may take from now on, where the system tells what it has taken; libraries do not count.

    Python and numpy raise MemoryError at the limit.
    """
    global _memory_limit
    status = Path("/proc/self/status")
    if not _memory_limit or not status.exists():
        return
    taken = int(status.read_text().partition("VmData:")[2].split()[0]) * 1024
    limit, _memory_limit = taken + _memory_limit, 0
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))


def learn_paths(demonstrations: dict[str, Trajectory], settings: LearningSettings, *, progress: Progress) -> Learned:
    """Cluster, select and fit."""
    from teachpath.learning.learn import learn

    return learn(demonstrations, settings, progress=progress)


def recut_run(
    learned: Learned,
    demonstrations: dict[str, Trajectory],
    threshold: float | None,
    clusters: int | None,
    *,
    progress: Progress,
) -> Learned:
    """Cut a run's dendrogram elsewhere, select and fit."""
    from teachpath.learning.relearn import relearn

    return relearn(learned, demonstrations, threshold=threshold, clusters=clusters, progress=progress)


def plan_path(
    path: LearnedPath,
    scene: Scene,
    settings: MotionSettings,
    arm: Arm,
    shown: ShownPosture | None,
    output: ToolOutput | None,
    *,
    progress: Progress,
) -> Plan:
    """Plan one path, near to the joints that were shown, with an output that is on along it."""
    from teachpath.motion.planning.plan import plan

    progress(0.1, f"planning path {path.id}")
    plan_id = f"plan-{uuid.uuid4().hex[:12]}"
    return plan(path, scene, settings, arm=arm, plan_id=plan_id, shown=shown, output=output)
