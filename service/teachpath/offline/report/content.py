"""What a review package tells: a run, what it was learned from, its paths as they are now, and their newest plans."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from teachpath.errors import NotFound, PathRefused
from teachpath.io.store.store import Run, Store
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.motion_preview import preview_motion
from teachpath.motion.settings import MotionSettings
from teachpath.records import Demonstration, LearnedPath, MotionPreview, Plan, Scene, Trajectory


@dataclass(frozen=True, eq=False)
class Review:
    """A run with all that is needed to look at it.

    Attributes:
        demonstrations: those that the run was made of and that are still there, in their order.
        trajectories: theirs, by id.
        paths: in their newest versions.
        plans: the newest of each path's present version, by path.
        motions: what the arm would do, by path.
        arm: that does it.
    """

    run: Run
    scene: Scene
    demonstrations: tuple[Demonstration, ...]
    trajectories: dict[str, Trajectory]
    paths: tuple[LearnedPath, ...]
    plans: dict[str, Plan]
    motions: dict[str, MotionPreview]
    arm: Arm

    def number(self, demonstration: str) -> int:
        """Return the number of a demonstration within its task; 0 when it is gone."""
        return next((d.number for d in self.demonstrations if d.id == demonstration), 0)


def review_of(
    store: Store,
    what: str,
    *,
    scene: Callable[[str], Scene],
    trajectory: Callable[[Demonstration], Trajectory],
    motion: MotionSettings,
    arm: Arm,
    dwell: float,
) -> Review:
    """Gather a review.

    Args:
        what: id of a run, or a task, whose newest run is meant.
        scene: gives the scene of a name.
        trajectory: gives the object's trajectory of a demonstration.
        motion: settings for the arm's home and its ways there.
        arm: that the plans are for.
        dwell: how long the gripper takes [s].

    Raises:
        NotFound: no such run or task, or nothing was learned of the task yet.
    """
    run = _run(store, what)
    used = set(run.learned.demonstrations)
    demonstrations = tuple(d for d in store.demonstrations(run.task) if d.id in used)
    paths = tuple(store.path(path.id) for path in run.learned.paths)
    plans = {path.id: plan for path in paths if (plan := _plan(store, path)) is not None}
    motions = {}
    for path, plan in plans.items():
        try:
            motions[path] = preview_motion(plan, motion, arm, dwell=dwell)
        except PathRefused:
            continue  # a plan under other settings: its certificate is shown, its motion is not
    return Review(
        run,
        scene(store.task(run.task).scene),
        demonstrations,
        {d.id: trajectory(d) for d in demonstrations},
        paths,
        plans,
        motions,
        arm,
    )


def _run(store: Store, what: str) -> Run:
    if what not in {task.name for task in store.tasks()}:
        return store.run(what)
    runs = store.runs(what)
    if not runs:
        raise NotFound(f"nothing was learned of task {what} yet; learn it first: teachpath learn {what}")
    return runs[0]


def _plan(store: Store, path: LearnedPath) -> Plan | None:
    return next((plan for plan in store.plans(path.id) if plan.path_version == path.version), None)
