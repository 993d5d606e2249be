"""What a review package holds: a run as the REST API would answer about it, and the arm as the view would draw it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from urllib.parse import quote

import numpy as np

from teachpath.errors import NotFound, PathRefused
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.rows import Run
from teachpath.io.store.store import Store
from teachpath.learning.clustering.cuts import dendrogram
from teachpath.live.preview.preview import Preview
from teachpath.motion.arm.description import describe_arm
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.motion_preview import preview_motion
from teachpath.motion.settings import MotionSettings
from teachpath.records import Demonstration, LearnedPath, MotionPreview, Plan, Scene, Trajectory
from teachpath_proto.keys import Keys

POINTS = 150  # of a demonstration, as many as the page asks for
CLUSTERS = 30  # that a listed cut of the dendrogram leaves at most, as in the API


@dataclass(frozen=True, eq=False)
class Review:
    """A run with all that is needed to look at it.

    Attributes:
        answers: records by the path of the REST API, below `/api/v1`, that answers with them.
        arm: the view's commands that draw the arm and the object at rest, one batch.
    """

    run: Run
    answers: Mapping[str, object]
    arm: bytes

    def count(self, kind: str) -> int:
        """Return how many answers there are whose path ends so, e.g. `motion`."""
        return sum(path.endswith(f"/{kind}") for path in self.answers)


def review_of(
    store: Store,
    what: str,
    *,
    scene: Callable[[str], Scene],
    trajectory: Callable[[Demonstration], Trajectory],
    motion: MotionSettings,
    arm: Arm,
    robot: str,
    dwell: float,
) -> Review:
    """Gather a review.

    Args:
        what: id of a run, or a task, whose newest run is meant.
        scene: gives the scene of a name.
        trajectory: gives the object's trajectory of a demonstration.
        motion: settings for the arm's home and its ways there.
        arm: that the plans are for.
        robot: name of the arm.
        dwell: how long the gripper takes [s].

    Raises:
        NotFound: no such run or task, or nothing was learned of the task yet.
    """
    run = _run(store, what)
    task = store.task(run.task)
    surroundings = scene(task.scene)
    answers: dict[str, object] = {
        "tasks": [task],
        "scenes": [surroundings],
        "executions": [],
        "robot": describe_arm(arm, name=robot, home=motion.home),
        _path("tasks", task.name, "runs"): [run.summary],
        _path("tasks", task.name, "runs", run.id): run,
        _path("tasks", task.name, "runs", run.id, "dendrogram"): dendrogram(run.learned, CLUSTERS),
    }
    answers |= _demonstrations(store, run, trajectory)
    answers |= _paths(store, run, lambda plan: preview_motion(plan, motion, arm, dwell=dwell))
    return Review(run, answers, _drawn(arm, surroundings, motion))


def _run(store: Store, what: str) -> Run:
    if what not in {task.name for task in store.tasks()}:
        return store.run(what)
    run = store.newest_run(what)
    if run is None:
        raise NotFound(f"nothing was learned of task {what} yet; learn it first: teachpath learn {what}")
    return run


def _demonstrations(store: Store, run: Run, trajectory: Callable[[Demonstration], Trajectory]) -> dict[str, object]:
    used = set(run.learned.demonstrations)
    kept = [demonstration for demonstration in store.demonstrations(run.task) if demonstration.id in used]
    answers: dict[str, object] = {_path("tasks", run.task, "demonstrations"): kept}
    for demonstration in kept:
        answers[_path("demonstrations", demonstration.id, "trajectory")] = trajectory(demonstration).thinned(POINTS)
    return answers


def _paths(store: Store, run: Run, motion: Callable[[Plan], MotionPreview]) -> dict[str, object]:
    answers: dict[str, object] = {}
    plans = set()
    for path in [store.path(learned.id) for learned in run.learned.paths]:
        plan = _plan(store, path)
        answers |= {_path("paths", path.id): path, _path("paths", path.id, "plans"): [plan] if plan else []}
        if plan is None:
            continue
        plans.add(plan.id)
        answers[_path("plans", plan.id)] = plan
        with suppress(PathRefused):  # a plan for another arm: its certificate is shown, its motion is not
            answers[_path("plans", plan.id, "motion")] = motion(plan)
    jobs = [job for job in reversed(store.jobs(task=run.task)) if job.outcome in plans]
    return answers | {_path("tasks", run.task, "jobs"): jobs}


def _plan(store: Store, path: LearnedPath) -> Plan | None:
    return next((plan for plan in store.plans(path.id) if plan.path_version == path.version), None)


def _drawn(arm: Arm, scene: Scene, motion: MotionSettings) -> bytes:
    home = np.array(motion.home)
    preview = Preview(MemoryBus(), Keys(), visual_solids(arm), arm=arm, robot="", home=home, statuses=list)
    preview.show_object(scene.carried)
    return preview.connect(lambda: None).pop() or b""


def _path(*pieces: str) -> str:
    return "/".join(quote(piece, safe="!~*'()") for piece in pieces)  # as encodeURIComponent has it
