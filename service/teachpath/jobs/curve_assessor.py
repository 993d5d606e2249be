"""Curves that somebody edits or adapts meanwhile: assessed and computed in a process of their own, beside the jobs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeVar

from teachpath.errors import Conflict, Unreachable
from teachpath.jobs import worker
from teachpath.jobs.pool import KillablePool
from teachpath.learning.settings import LearningSettings
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Assessment, Job, LearnedPath, Scene, Trajectory

if TYPE_CHECKING:  # loaded in the process that needs it, not in the service
    from teachpath.learning.adaptation.adapt import AdaptedPath
    from teachpath.learning.adaptation.adapted_course import AdaptationModel
    from teachpath.learning.adaptation.target import Target

TIMEOUT: Final = 60.0  # [s] after which a call counts as stuck; the first one loads its libraries
LEARNING_KINDS: Final = ("learn", "recut")

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Shown:
    """What a path was learned from.

    Attributes:
        learned: the path as it was learned.
        members: demonstrations that it was learned from.
        others: further demonstrations of its run, of the same way or of others.
        settings: of its run.
    """

    learned: Curve
    members: list[Trajectory]
    others: list[Trajectory]
    settings: LearningSettings


class CurveAssessor:
    """Assesses and adapts one curve after another; of assessments that wait for one path only the newest is made.

    Its methods block, so call them on a thread. They raise Unreachable where the process died or is stuck.
    """

    def __init__(self) -> None:
        self._pool = KillablePool(_init_worker, part="assessor")
        self._lock = threading.Lock()
        self._newest: dict[str, object] = {}

    def assess(
        self, path: LearnedPath, scene: Scene, settings: MotionSettings, arm: Arm, *, curve: Curve
    ) -> Assessment:
        """Assess a curve that is to replace that of `path`.

        Raises:
            Conflict: a newer curve of the same path came while this one waited.
            PathRefused: the curve cannot be sampled.
        """
        ticket = self._newest[path.id] = object()
        with self._lock:
            if self._newest[path.id] is not ticket:
                raise Conflict(f"a newer curve of path {path.id} came meanwhile; this one was not looked at")
            return self._call(_assess, curve, scene, settings, arm, path.orientation)

    def adapt(self, path: LearnedPath, shown: Shown, target: Target) -> AdaptedPath:
        """Adapt a version of a path to other ends; raises as `learning.adaptation.adapt.adapt`."""
        with self._lock:
            return self._call(_adapt, path, shown, target)

    def adaptation_model(self, path: LearnedPath, shown: Shown) -> AdaptationModel:
        """Return what a version of a path between other ends is computed from."""
        with self._lock:
            return self._call(_adaptation_model, path, shown)

    def on_finished(self, job: Job) -> None:
        """Warm up when a job has learned paths, which somebody may edit or adapt now."""
        if job.kind in LEARNING_KINDS:
            self.warm_up()

    def warm_up(self) -> None:
        """Begin to load what the first call needs, and return at once."""
        with suppress(BrokenProcessPool):
            self._pool.submit(_load)

    def _call(self, function: Callable[..., T], *arguments: Any) -> T:
        try:
            return self._pool.submit(function, *arguments).result(timeout=TIMEOUT)
        except (BrokenProcessPool, CancelledError, TimeoutError):
            self._pool.kill()
            raise Unreachable("the process that looks at curves died or is stuck; try again") from None

    def stop(self) -> None:
        """End the process, even in the middle of an assessment; no other starts."""
        self._pool.close()


def _init_worker() -> None:
    worker.exit_with_parent()
    worker.lower_priority()


def _load() -> None:
    from teachpath.learning.adaptation.adapt import adapt
    from teachpath.motion.planning.assessment import assess

    del adapt, assess


def _adapt(path: LearnedPath, shown: Shown, target: Target) -> AdaptedPath:
    from teachpath.learning.adaptation.adapt import adapt

    return adapt(path, shown.learned, shown.members, shown.others, target, shown.settings)


def _adaptation_model(path: LearnedPath, shown: Shown) -> AdaptationModel:
    from teachpath.learning.adaptation.adapt import course_model

    model, _, places = course_model(path, shown.learned, shown.members, shown.others, shown.settings)
    return model.export(places)


def _assess(curve: Curve, scene: Scene, settings: MotionSettings, arm: Arm, orientation: Curve | None) -> Assessment:
    from teachpath.motion.planning.assessment import assess

    return assess(curve, scene, settings, arm=arm, orientation=orientation)
