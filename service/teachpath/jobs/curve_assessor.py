"""Quick looks at curves that are being edited, in a process of their own, so that nobody waits for anybody."""

from __future__ import annotations

import os
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import Final

from teachpath.errors import Conflict, Unreachable
from teachpath.jobs import worker
from teachpath.motion.arm.variants import choose
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Assessment, LearnedPath, Scene

ASSESSMENT_TIMEOUT: Final = 60.0  # s, until a look counts as stuck; the first one has to load its libraries
NICENESS: Final = 5  # added niceness, so that the control loop goes first


class CurveAssessor:
    """Looks at one curve after another; of several that wait for the same path only the newest is looked at."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._lock = threading.Lock()
        self._newest: dict[str, object] = {}

    def assess(self, path: LearnedPath, scene: Scene, settings: MotionSettings, *, curve: Curve) -> Assessment:
        """Assess a curve that is to replace that of `path`; blocks, so call it on a thread.

        Raises:
            Conflict: a newer curve of the same path came while this one waited.
            PathRefused: the curve cannot be sampled.
            Unreachable: the process died or is stuck.
        """
        ticket = self._newest[path.id] = object()
        with self._lock:
            if self._newest[path.id] is not ticket:
                raise Conflict(f"a newer curve of path {path.id} came meanwhile; this one was not looked at")
            if self._pool is None:
                self._pool = ProcessPoolExecutor(1, get_context("spawn"), initializer=_init_worker)
            try:
                found = self._pool.submit(_assess, curve, scene, settings, path.orientation)
                return found.result(timeout=ASSESSMENT_TIMEOUT)
            except (BrokenProcessPool, TimeoutError):
                self._end_process()
                raise Unreachable("the process that assesses curves died or is stuck; try again") from None

    def stop(self) -> None:
        """End the process."""
        with self._lock:
            self._end_process()

    def _end_process(self) -> None:
        pool, self._pool = self._pool, None
        if pool is None:
            return
        processes = list((pool._processes or {}).values())  # there is no public way to end one that is stuck
        pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.kill()
            process.join()


def _init_worker() -> None:
    worker.exit_with_parent()
    os.nice(NICENESS)


def _assess(curve: Curve, scene: Scene, settings: MotionSettings, turn: Curve | None) -> Assessment:
    from teachpath.motion.planning.assessment import assess  # loaded in the process that needs it, not in the service

    choose(settings.variant)
    return assess(curve, scene, settings, orientation=turn)
