"""What is proved of a distance holds between the places where it was measured."""

import numpy as np
import pytest

from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.collision.collision_model import Clearance, CollisionModel, grasped_load
from teachpath.motion.collision.continuous import MIN_STEP, ContinuousCheck, prove_distance
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, Shape
from tests.unit.motion.collision.solids import Surface
from tests.unit.motion.ways import MIDDLE, learned, wandering, way

ARM = Arm.of_variant()

LEVERS = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


def turn() -> tuple[ContinuousCheck, list[int]]:
    """One joint that turns alone, and a place to count what is measured."""
    return ContinuousCheck.along_lines(np.array([[0.0] * 6, [1.0, 0, 0, 0, 0, 0]]), LEVERS), []


@pytest.mark.parametrize("at", [0.1234, 0.5, 0.98765])
def test_a_spike_between_samples_is_found(at: float) -> None:
    sweep, asked = turn()

    def measure(q: Array) -> list[Clearance]:
        asked.append(len(q))
        return [Clearance(abs(float(x) - at), "finger", "spike") for x in q[:, 0]]

    proved = prove_distance(sweep, measure, -1.0)
    assert proved.distance <= 0.0 <= proved.nearest.distance
    assert proved.nearest.distance - proved.distance < 0.001
    assert proved.parameter == pytest.approx(at, abs=0.001)
    assert sum(asked) < 100


def test_nothing_more_is_measured_once_it_is_refused_and_little_when_all_is_far() -> None:
    for distance, asked_for in ((0.001, 0.005), (0.3, 0.005)):
        sweep, asked = turn()

        def measure(q: Array, d: float = distance, asked: list[int] = asked) -> list[Clearance]:
            asked.append(len(q))
            return [Clearance(d, "a", "b")] * len(q)

        proved = prove_distance(sweep, measure, asked_for)
        assert proved.distance <= distance
        assert sum(asked) <= 27


def test_what_is_asked_is_proved_where_it_just_holds() -> None:
    sweep, _ = turn()
    proved = prove_distance(sweep, lambda q: [Clearance(0.0052, "a", "b")] * len(q), 0.005)
    assert 0.005 <= proved.distance <= 0.0052
    assert prove_distance(sweep, lambda q: [Clearance(0.005, "a", "b")] * len(q), 0.005).distance >= 0.005 - MIN_STEP


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_bound_on_the_way_of_every_point_holds_along_a_spline(seed: int) -> None:
    made = plan(learned(wandering(seed)), empty_scene())
    joints = JointPath(np.linspace(0, 1, len(made.lengths)), made.lengths, made.joints)
    model = CollisionModel(empty_scene(), ARM)
    sweep = ContinuousCheck.along_spline(joints, model.lever_arms())
    places = np.linspace(0, 1, 300)
    bound = np.interp(places, sweep.parameters, sweep.motion_bounds)
    walked = Surface()(joints(places)[:, :6])  # (places, points, 3)
    steps = np.linalg.norm(np.diff(walked, axis=0), axis=2)  # (places - 1, corners)
    assert np.all(steps.max(axis=1) <= np.diff(bound) + 1e-9)


@pytest.mark.parametrize("scene", [paper_scene(), Scene("post", (Shape("post", "sphere", (0.03,), (0.5, 0.0, 0.5)),))])
def test_the_certified_clearance_is_below_any_that_dense_sampling_finds(scene: Scene) -> None:
    made = plan(way(MIDDLE), scene) if scene.carried else plan(learned(wandering(2)), scene)
    joints = JointPath(np.linspace(0, 1, len(made.lengths)), made.lengths, made.joints)
    q = joints(np.linspace(0, 1, 3000))[:, :6]
    model = CollisionModel(scene, ARM)
    dense = min(row.distance for row in model.clearances(q, load=grasped_load(model, q[0])))
    certified = made.certificate.clearance.value
    assert MotionSettings().clearance_min <= certified <= dense
    assert certified > 0.8 * dense
