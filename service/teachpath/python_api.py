"""What `import teachpath` offers: from arrays to learned paths, certified plans and their setpoints."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.learning.learn import learn as learn_trajectories
from teachpath.learning.settings import LearningSettings, Progress, no_progress
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan as plan_path
from teachpath.motion.planning.signature import certified_arm
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Array, Learned, LearnedPath, Plan, Scene, SerialArm
from teachpath.trajectories import to_trajectories


def learn(
    demonstrations: Mapping[str, Any] | Iterable[Any],
    settings: LearningSettings | None = None,
    *,
    times: Any = None,
    dt: float | None = None,
    progress: Progress = no_progress,
) -> Learned:
    """Learn a path for every way in which a task was demonstrated.

        learned = teachpath.learn([first, second, third], dt=0.01)
        learned.paths[0].curve(0.5)  # (3,) [m], halfway

    Args:
        demonstrations: a list, or a mapping from names. Each is an array or rows (n, 3) of the object's positions x, y,
            z [m, world], or (n, 7) with unit quaternions w, x, y, z; or a table with these columns (x, y, z, qw, qx,
            qy, qz) and perhaps t [s], such as a data frame; or a `Trajectory`.
        settings: the defaults when None.
        times: (n,) [s] of each demonstration.
        dt: time between two samples [s] instead; 0.02 when there are no times at all.
        progress: told the fraction done and a sentence; what it raises passes through.

    Returns:
        Clusters with the scores of their demonstrations, and one path (a NURBS) each.

    Raises:
        UnusableInput: a demonstration has a wrong shape, unit, order or value.
        LearningFailed: no path can be learned from them.
    """
    trajectories = to_trajectories(demonstrations, times=times, dt=dt)
    return learn_trajectories(trajectories, settings or LearningSettings(), progress=progress)


def plan(
    path: LearnedPath | Curve,
    scene: Scene | None = None,
    settings: MotionSettings | None = None,
    *,
    arm: Arm | SerialArm | None = None,
) -> Plan:
    """Plan how the arm follows a path, and certify that it can.

    The tool points down. Where the scene has an object to carry, the arm picks it up at the start of the path.
    The plan is not signed: a station executes plans alone that it made itself, so plan the path there to move its arm.

    Args:
        path: a learned path, or a curve of positions [m, world].
        scene: what stands around; None: a table, and nothing on it.
        settings: the defaults when None.
        arm: the published one that the settings name when None; or one that `read_arm` read. That has no
            gripper, and waits in the middle of its joints' ranges unless `settings.home` says otherwise.

    Returns:
        The plan with its certificate: how much of every limit it uses, and where.

    Raises:
        PathRefused: the arm cannot follow it; `failure` says where, why, and which control point to move.
        UnusableInput: it is no path in space, or plans are not made for that arm.
    """
    plan_id = f"plan-{uuid.uuid4().hex[:12]}"
    return plan_path(_learned_path(path), scene or empty_scene(), settings, arm=_arm(arm, settings), plan_id=plan_id)


def setpoints(
    plan: Plan, rate: float = 250.0, *, settings: MotionSettings | None = None, arm: Arm | SerialArm | None = None
) -> tuple[Array, Array]:
    """Return the times (n,) [s] and the joints (n, joints) [rad] of a plan's motion along its path, at full speed.

    The last one is the first at or behind the end, where the arm rests.

    Args:
        plan: certified.
        rate: setpoints a second [Hz].
        settings: with which it was planned; where it is not signed, they name the arm. The defaults when None.
        arm: that the plan is for; when None the one that its signature or the settings name.

    Raises:
        PathRefused: the plan has changed since it was certified, or is for another arm.
        UnusableInput: the rate is outside 1 to 10000.
    """
    if not 1.0 <= rate <= 10_000.0:
        raise UnusableInput(f"a rate of {rate:g} Hz is outside 1 to 10000")
    given = _arm(arm, settings)
    verify(plan, given or certified_arm(plan) or Arm.of_settings(settings or MotionSettings()))
    trajectory = plan_trajectory(plan)
    count = int(np.ceil(trajectory.duration * rate)) + 1
    times = np.arange(count) / rate
    return times, trajectory(times)[:, :-1]


def _arm(arm: Arm | SerialArm | None, settings: MotionSettings | None) -> Arm | None:
    return Arm.of_model(arm, settings or MotionSettings()) if isinstance(arm, SerialArm) else arm


def _learned_path(path: Any) -> LearnedPath:
    if isinstance(path, LearnedPath):
        return path
    if isinstance(path, Curve):
        return LearnedPath(id="path", run="", cluster=1, version=1, curve=path, fit=None)
    if isinstance(path, Learned):
        raise UnusableInput(f"these are {len(path.paths)} paths; plan one of them, e.g. learned.paths[0]")
    raise UnusableInput(
        f"a path is a LearnedPath or a Curve, not {type(path).__name__}; make one: learn([points]).paths[0]"
    )
