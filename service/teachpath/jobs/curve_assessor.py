"""Quick assessments of curves that are being edited, in a process of their own, so that they wait for no job."""

from __future__ import annotations

import threading
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from typing import Final

from teachpath.errors import Conflict, Unreachable
from teachpath.jobs import worker
from teachpath.jobs.pool import KillablePool
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Assessment, LearnedPath, Scene

ASSESSMENT_TIMEOUT: Final = 60.0  # [s] after which an assessment counts as stuck; the first one loads its libraries


class CurveAssessor:
    """Assesses one curve after another; of those that wait for the same path only the newest is assessed."""

    def __init__(self) -> None:
        self._pool = KillablePool(_init_worker)
        self._lock = threading.Lock()
        self._newest: dict[str, object] = {}

    def assess(
        self, path: LearnedPath, scene: Scene, settings: MotionSettings, arm: Arm, *, curve: Curve
    ) -> Assessment:
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
            try:
                assessment = self._pool.submit(_assess, curve, scene, settings, arm, path.orientation)
                return assessment.result(timeout=ASSESSMENT_TIMEOUT)
            except (BrokenProcessPool, CancelledError, TimeoutError):
                self._pool.kill()
                raise Unreachable("the process that assesses curves died or is stuck; try again") from None

    def stop(self) -> None:
        """End the process, even in the middle of an assessment; no other starts."""
        self._pool.close()


def _init_worker() -> None:
    worker.exit_with_parent()
    worker.lower_priority()


def _assess(curve: Curve, scene: Scene, settings: MotionSettings, arm: Arm, orientation: Curve | None) -> Assessment:
    from teachpath.motion.planning.assessment import assess  # loaded in the process that needs it, not in the service

    return assess(curve, scene, settings, arm=arm, orientation=orientation)
