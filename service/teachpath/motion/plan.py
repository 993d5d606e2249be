"""From a learned path to a plan the arm can execute, with its certificate, or to the reason why not."""

from __future__ import annotations

import uuid
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from teachpath.errors import PathRefused, UnusableSettings
from teachpath.motion.branches import Candidate, candidates, cost, least_wrong, usable
from teachpath.motion.certificate import digest, largest_use, limit_uses
from teachpath.motion.failure import collision_failure, in_words, kinematic_failure, start_failure
from teachpath.motion.joints import ARM, JointPath, Limits
from teachpath.motion.kinematics import inverse, tool_pose
from teachpath.motion.moves import approach, check_free, left_behind, retreat
from teachpath.motion.proof import FINEST, Sweep, least
from teachpath.motion.puma560 import LOWER, TORQUE, UPPER, Array
from teachpath.motion.remedy import influences
from teachpath.motion.route import Route, route
from teachpath.motion.scene import Clearance, CollisionModel, Load, grasp_of
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing import timed
from teachpath.motion.torque import Dynamics
from teachpath.motion.track import paced
from teachpath.nurbs import Curve
from teachpath.records import Certificate, Extreme, Failure, LearnedPath, Plan, Scene

NEAR_FINGERS: Final = 0.001  # m, that open fingers stay away from the object between them
# A branch and roll that keeps more clearance is worth so much per metre, up to what is enough.
GAIN: Final = 20.0
ENOUGH: Final = 0.02  # m
EVERY: Final = 8  # instant of a track is looked at for its torques
SLOWER: Final = 4  # times that a path is timed at most, each time with lower limits of acceleration
LESS: Final = 0.97  # of the acceleration that the torques leave, because a slower path has other torques
LEAST_LEFT: Final = 0.05  # of the limits of acceleration with which a path is still worth following


@dataclass(frozen=True, eq=False)
class _Job:
    """What stays the same while branches are tried."""

    path: LearnedPath
    scene: Scene
    settings: MotionSettings
    way: Route
    model: CollisionModel


def plan(path: LearnedPath, scene: Scene, settings: MotionSettings | None = None) -> Plan:
    """Plan the pick and place along a path: the centre of the carried object follows it, the tool points down.

    The arm goes from its home to above the start, down, closes the gripper, follows the path, opens the gripper, goes
    up and home. Without a carried object it follows the path with the gripper closed.

    Args:
        path: what to follow.
        scene: what stands around.
        settings: what may be used of the arm; the defaults when None.

    Returns:
        A plan with its certificate.

    Raises:
        PathRefused: the arm cannot; the sentence says why, where, and which control point to move.
        UnusableSettings: the arm's home is outside the joint limits.
    """
    settings = settings or MotionSettings()
    _home_within_limits(settings)
    way = route(path.curve, settings, turn=_turn(path, settings))
    _refuse(start_failure(way, scene, settings))
    every = candidates(way, settings)
    fit = [candidate for candidate in every if usable(candidate, settings)]
    if not fit:
        _refuse(kinematic_failure(way, least_wrong(every), settings))
    job = _Job(path, scene, settings, way, CollisionModel(scene))
    refused: PathRefused | None = None
    free: list[tuple[float, Candidate]] = []
    for candidate in sorted(fit, key=lambda c: cost(c, settings)):
        try:
            clearance = _path_clearance(job, candidate)
            free.append((cost(candidate, settings) - GAIN * min(clearance.value, ENOUGH), candidate))
            if clearance.value >= ENOUGH:
                break  # all that follow cost more
        except PathRefused as error:
            refused = refused or error
    for _, candidate in sorted(free, key=lambda trial: trial[0]):
        try:
            return _certified(job, candidate)
        except PathRefused as error:
            refused = refused or error
    assert refused is not None
    raise refused


def _home_within_limits(settings: MotionSettings) -> None:
    for joint, angle in enumerate(settings.home):
        if not LOWER[joint] <= angle <= UPPER[joint]:
            limits = f"{LOWER[joint]:.3f} to {UPPER[joint]:.3f}"
            raise UnusableSettings(f"motion.home puts joint {joint + 1} to {angle:.3f} rad, limits {limits}")


def _certified(job: _Job, candidate: Candidate) -> Plan:
    settings, way = job.settings, job.way
    joints, pace, limits, torque = _within_torques(job, candidate)
    _tool_on_path(way, joints, settings)
    clearance = _path_clearance(job, candidate, joints)
    start, goal = joints.joints[0], joints.joints[-1]
    above_start = _above(way.positions[0], start, candidate, settings, "start")
    above_goal = _above(way.positions[-1], goal, candidate, settings, "goal")
    _moves_clear(job, joints, above_start, above_goal)
    singular_s = float(way.lengths[int(np.argmin(candidate.singular))])
    track = paced(joints, pace, limits)
    position, velocity, acceleration, jerk = limit_uses(track.setpoints(settings.rate), settings.rate)
    worst = max((velocity, acceleration, jerk), key=lambda extreme: extreme.value)
    if worst.value > settings.path_share:
        raise PathRefused(
            f"a limit is used to {100 * worst.value:.1f} % by {worst.place}, at most "
            f"{100 * settings.path_share:.1f} %; smooth the path there"
        )
    drawn = Plan(
        id=f"plan-{uuid.uuid4().hex[:12]}",
        path=job.path.id,
        path_version=job.path.version,
        scene=job.scene,
        lengths=joints.lengths,
        joints=joints.joints,
        pace=pace,
        limits=np.stack([limits.speed, limits.acceleration, limits.jerk]),
        above_start=above_start,
        above_goal=above_goal,
        duration=track.duration,
        certificate=Certificate(
            digest="",
            branch=candidate.branch,
            position_use=position,
            velocity_use=velocity,
            acceleration_use=acceleration,
            jerk_use=jerk,
            torque_use=torque,
            least_singular=Extreme(candidate.conditioned, f"s = {singular_s:.3f} m", singular_s),
            clearance=clearance,
        ),
    )
    return replace(drawn, certificate=replace(drawn.certificate, digest=digest(drawn)))


def _within_torques(job: _Job, candidate: Candidate) -> tuple[JointPath, Array, Limits, Extreme]:
    """Time the path; where the limits of acceleration would ask too much of a motor, with lower ones."""
    settings, limits = job.settings, ARM.scaled(*[job.settings.path_share] * 3)
    dynamics = Dynamics(job.scene.carried)
    for _ in range(SLOWER):
        joints, pace = timed(job.way, candidate, limits, rate=settings.rate)
        rows = paced(joints, pace, limits).table[::EVERY]
        q, velocity = rows[:, 0, :6], rows[:, 1, :6]
        worst = largest_use(dynamics.largest(q, velocity, limits.acceleration), rows[:, 0, 6], TORQUE)
        if worst.value <= 1.0:
            return joints, pace, limits, worst
        left = dynamics.share_left(q, velocity, limits.acceleration)
        if left < LEAST_LEFT:
            break
        limits = limits.scaled(1.0, LESS * left, 1.0)
    raise PathRefused(
        f"the motors would have to give {100 * worst.value:.0f} % of their torque at {worst.place}; carry less, or "
        "bring the path nearer to the robot there"
    )


def _tool_on_path(way: Route, joints: JointPath, settings: MotionSettings) -> None:
    samples = joints.dense()
    reached = joints(samples)
    wanted = way.curve(way.arc.parameters(reached[:, 6]))
    off = np.linalg.norm(tool_pose(reached[:, :6])[:, :3, 3] - wanted, axis=1)
    worst = int(np.argmax(off))
    if off[worst] > settings.path_tolerance:
        node = int(np.argmin(np.abs(way.lengths - reached[worst, 6])))
        raise PathRefused(
            f"the path bends too sharply to be followed within its tolerance {way.place(node)}; "
            f"move control point {int(np.argmax(influences(way.curve, float(way.parameters[node])))) + 1}"
        )


def _above(position: Array, q: Array, candidate: Candidate, settings: MotionSettings, what: str) -> Array:
    """Find the configuration above an end of the path, on the same branch as configuration `q` there."""
    lifted = position + np.array([0.0, 0.0, settings.lift])
    pose = tool_pose(q)
    pose[:3, 3] = lifted
    solutions = inverse(pose[None], q4_before=float(q[3]))
    turned = solutions.joints[0] + 2 * np.pi * np.round((q - solutions.joints[0]) / (2 * np.pi))
    best = turned[int(np.argmin(np.abs(turned - q).max(axis=1)))]
    if solutions.excess[0, 0] > 0 or np.any(best < LOWER) or np.any(best > UPPER):
        raise PathRefused(
            f"the arm cannot reach {100 * settings.lift:.0f} cm above the {what} of the path; lower motion.lift"
        )
    return np.asarray(best, dtype=np.float64)


def _path_clearance(job: _Job, candidate: Candidate, joints: JointPath | None = None) -> Extreme:
    """Prove the clearance along the path; without `joints` along straight lines between a candidate's nodes."""
    load, model = grasp_of(job.scene, candidate.joints[0]), job.model
    levers = model.levers(load)
    sweep = Sweep.through(candidate.joints, levers) if joints is None else Sweep.along(joints, levers)

    def measure(q: Array) -> list[Clearance]:
        return model.clearances(q, load=load)

    proved = least(sweep, measure, job.settings.clearance_min)
    if proved.distance < job.settings.clearance_min:
        _too_near(job, candidate, job.settings.clearance_min, measure)
    if load is not None and joints is not None:
        deepest = least(sweep, lambda q: model.supports(q, load), -job.settings.contact_tolerance)
        if deepest.distance < -job.settings.contact_tolerance:
            _too_near(job, candidate, -job.settings.contact_tolerance, lambda q: model.supports(q, load))
    share = (proved.place - sweep.places[0]) / (sweep.places[-1] - sweep.places[0])
    s = float(job.way.lengths[round(share * (len(job.way.lengths) - 1))] if joints is None else joints(proved.place)[6])
    near = proved.measured
    return Extreme(proved.distance, f"{near.part} to {near.other} at s = {s:.3f} m" if near.part else "far", s)


def _too_near(job: _Job, candidate: Candidate, asked: float, measure: Callable[[Array], list[Clearance]]) -> None:
    nodes = np.arange(len(candidate.joints))
    rows = measure(candidate.joints)
    # What was proved may be less than what is measured at the nodes: then the least of them is the place to tell.
    asked = max(asked, min(row.distance for row in rows) + FINEST)
    _refuse(
        collision_failure(
            job.way, candidate, nodes, rows, asked, lambda q: np.array([row.distance for row in measure(q)])
        )
    )


def _turn(path: LearnedPath, settings: MotionSettings) -> Curve | None:
    return path.orientation if settings.orientation == "demonstrated" else None


def _refuse(failure: Failure | None) -> None:
    if failure is not None:
        raise PathRefused(in_words(failure))


def _moves_clear(job: _Job, joints: JointPath, above_start: Array, above_goal: Array) -> None:
    model, settings, start, goal = job.model, job.settings, joints.joints[0], joints.joints[-1]
    carried = job.scene.carried
    before = Load(placed=carried.position) if carried else None
    behind = left_behind(job.scene, start, goal)
    gripper_open = carried is not None
    approach(model, np.array(settings.home), above_start, settings, load=before, gripper_open=gripper_open)
    for load, low, high, what in ((before, start, above_start, "start"), (behind, goal, above_goal, "goal")):
        stops = np.stack([low, high])
        check_free(model, stops, settings, load=load, gripper_open=gripper_open, what=f"above the {what}")
        if load is None:
            continue
        fingers = least(Sweep.through(stops, model.levers()), partial(model.straddles, load=load), NEAR_FINGERS)
        if fingers.distance < NEAR_FINGERS:
            raise PathRefused(f"the open fingers would hit the object at the {what}; is the path centred on it?")
    retreat(model, start, goal, above_goal, settings)
