"""Plans for an arm that a user's model describes, judged by MuJoCo from the model itself."""

from dataclasses import replace
from itertools import pairwise

import mujoco
import numpy as np
import pytest

import teachpath
from teachpath.errors import PathRefused, UnusableInput
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Plan, SerialArm, Shape

HEIGHT = 0.5  # [m] of the table, on which the arm stands
RATE = 250.0
SETTINGS = MotionSettings()


def arched(*points: tuple[float, float, float]) -> Curve:
    return Curve(3, np.array([0.0] * 4 + [1.0] * 4), np.array(points), np.ones(4))


ARCH = arched((0.45, -0.3, 0.65), (0.5, -0.1, 0.75), (0.5, 0.1, 0.7), (0.45, 0.3, 0.65))


@pytest.fixture(scope="module", params=["six-axis", "seven-axis"])
def example(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def arm(example: str) -> SerialArm:
    return teachpath.read_arm(example, base=((0.0, 0.0, HEIGHT), (1.0, 0.0, 0.0, 0.0)))


@pytest.fixture(scope="module")
def plan(arm: SerialArm) -> Plan:
    return teachpath.plan(ARCH, arm=arm)


@pytest.fixture(scope="module")
def setpoints(plan: Plan, arm: SerialArm) -> np.ndarray:
    return teachpath.setpoints(plan, RATE, arm=arm)[1]


def test_the_tool_follows_the_path_and_points_down(setpoints: np.ndarray, example: str) -> None:
    spec = mujoco.MjSpec.from_file(str(EXAMPLES[example]))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    curve = ARCH(np.linspace(0.0, 1.0, 5001))
    for q in setpoints:
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        place, turn = (
            (data.site_xpos[0], data.site_xmat[0])
            if model.nsite
            else (data.body("tool0").xpos, data.body("tool0").xmat)
        )
        off = np.linalg.norm(curve - place - [0.0, 0.0, HEIGHT], axis=1).min()
        assert off < SETTINGS.path_tolerance
        np.testing.assert_allclose(turn.reshape(3, 3)[:, 2], [0.0, 0.0, -1.0], atol=1e-4)
    end = curve[-1] - [0.0, 0.0, HEIGHT]
    np.testing.assert_allclose(place, end, atol=1e-4)


def test_setpoints_keep_the_limits_by_differences(setpoints: np.ndarray, arm: SerialArm) -> None:
    motion = setpoints
    for joint, column in zip(arm.joints, setpoints.T, strict=True):
        assert joint.lower.value <= column.min() <= column.max() <= joint.upper.value
    for kind in ("speed", "acceleration", "jerk"):
        motion = np.diff(motion, axis=0) * RATE
        limits = [getattr(joint, kind).value for joint in arm.joints]
        assert np.all(np.abs(motion) <= limits)


def test_the_certificate_says_what_it_is_of_and_is_of_no_other_arm(plan: Plan, arm: SerialArm) -> None:
    said = plan.certificate.branch
    assert f"{arm.name} ({arm.hash[:12]}) solution" in said
    unsaid = {"six_axis": "acceleration, jerk", "seven_axis": "speed, acceleration, jerk"}
    assert said.endswith(f"limits by default: {unsaid[arm.name]}")
    assert plan.certificate.clearance.value >= SETTINGS.clearance_min
    assert plan.certificate.torque_use.value <= 1.0
    for name in ("position_use", "velocity_use", "acceleration_use", "jerk_use", "torque_use"):
        assert getattr(plan.certificate, name).place.split(" at ")[0] in [joint.name for joint in arm.joints]
    for other in (replace(arm, payload_mass=0.1), None):
        with pytest.raises(PathRefused, match="is for another arm"):
            teachpath.setpoints(plan, arm=other)


def test_clearances_change_no_faster_than_the_lever_arms_allow(setpoints: np.ndarray, arm: SerialArm) -> None:
    model = CollisionModel(empty_scene(), Arm.of_model(arm, SETTINGS))
    levers = model.lever_arms()
    rows = model.clearances(setpoints[::5])
    for (q, a), (r, b) in pairwise(zip(setpoints[::5], rows, strict=True)):
        assert abs(a.distance - b.distance) <= 2.0 * np.abs(r - q) @ levers + 1e-9


def test_what_is_not_planned_for_is_refused(arm: SerialArm) -> None:
    block = Shape("block", "box", (0.04, 0.04, 0.04), (0.45, -0.3, 0.65))
    with pytest.raises(UnusableInput, match="has no gripper that is known here, and scene empty has block to carry"):
        teachpath.plan(ARCH, replace(empty_scene(), carried=block), arm=arm)
    far = arched((1.5, -0.3, 0.65), (1.5, -0.1, 0.7), (1.5, 0.1, 0.7), (1.5, 0.3, 0.65))
    with pytest.raises(PathRefused, match=f"no configuration of {arm.name} was found that brings the tool nearer than"):
        teachpath.plan(far, arm=arm)
    low = arched((0.45, -0.3, 0.65), (0.5, -0.1, 0.42), (0.5, 0.1, 0.42), (0.45, 0.3, 0.65))
    with pytest.raises(PathRefused, match="table"):
        teachpath.plan(low, arm=arm)
