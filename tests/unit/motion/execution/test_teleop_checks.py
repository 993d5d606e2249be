"""What a live hand's motion is checked for: none that passes comes nearer than it may, between setpoints too."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel, Load, grasped_load
from teachpath.motion.execution.teleop_checks import TORQUE_STRIDES, MotionCheck, SweptCheck, TorqueCheck
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.constant_jerk import ConstantJerkMotion
from teachpath.records import Scene, Shape
from tests.unit.motion.arm.test_held_object import grasp
from tests.unit.motion.collision.test_boundaries import over

ARM = Arm.of_variant()
SETTINGS = MotionSettings()
HOME = np.array(SETTINGS.home)
DT = 0.004


def swing(begin: np.ndarray, end: np.ndarray, periods: int) -> ConstantJerkMotion:
    """Return a motion from rest to rest, whatever limits it breaks."""
    phase = 2 * np.pi * np.arange(periods + 1) / periods
    return ConstantJerkMotion.near(
        np.array([begin, *np.zeros((2, 6))]), np.sin(phase)[:, None] * (end - begin), end, DT
    )


def corner(rng: np.random.Generator, q: np.ndarray) -> Shape:
    """Return a thin post, turned at random, whose edges are near to where the tool is."""
    place = tool_pose(q, ARM)[:3, 3] + rng.normal(0.0, 0.08, 3)
    turn = rng.normal(size=4)
    size = (0.01, 0.01, 0.3)
    return Shape("post", "box", size, tuple(place), 0, tuple(turn / np.linalg.norm(turn)))


def judge(motion: ConstantJerkMotion, model: CollisionModel, load: Load | None = None) -> str:
    """Check a motion to its end; return what it says."""
    check, said = SweptCheck(motion, model, load, SETTINGS), ""
    while not (said or check.is_done):
        said = check.advance(5)
    return said


def dense(motion: ConstantJerkMotion) -> np.ndarray:
    """Return configurations (n, 6) of a motion, between its setpoints too."""
    return densely(motion)[0]


def densely(motion: ConstantJerkMotion) -> np.ndarray:
    """Return positions, velocities and accelerations (3, n, 6) of a motion, between its setpoints too."""
    t, jerk = DT * np.linspace(0.0, 1.0, 4, endpoint=False)[:, None], motion.jerks[:, None]
    p, v, a = np.moveaxis(motion.states[:-1, :, None], 1, 0)
    rows = (p + v * t + a * t**2 / 2 + jerk * t**3 / 6, v + a * t + jerk * t**2 / 2, a + jerk * t)
    return np.array([row.reshape(-1, 6) for row in rows])


def test_a_motion_that_is_proved_comes_no_nearer_to_a_sharp_corner_than_it_may() -> None:
    rng, proved = np.random.default_rng(5), 0
    for _ in range(80):
        ends = HOME + rng.uniform(-0.25, 0.25, (2, 6))
        model = CollisionModel(Scene("post", (corner(rng, ends.mean(axis=0)),)), ARM)
        motion = swing(*ends, periods=int(rng.integers(30, 90)))
        said = judge(motion, model)
        least = min(row.distance for row in model.clearances(dense(motion), gripper_open=True))
        assert said == "" or least < 0.05, said
        assert least >= SETTINGS.clearance_min or "would come within" in said
        proved += not said
    assert proved > 10


def test_an_arm_that_stands_nearer_than_the_guard_may_go_away_and_no_nearer() -> None:
    plate = Shape("plate", "box", (0.2, 0.2, 0.01), tuple(tool_pose(HOME, ARM)[:3, 3] - np.array([0.0, 0.0, 0.03])), 0)
    near = CollisionModel(Scene("low", (plate,)), ARM).clearances(HOME[None], gripper_open=True)[0].distance
    x, y, z = plate.position
    plate = replace(plate, position=(x, y, z + near - 0.008))
    model = CollisionModel(Scene("low", (plate,)), ARM)
    assert model.clearances(HOME[None], gripper_open=True)[0].distance == pytest.approx(0.008, abs=1e-4)
    for way in (0.03, -0.03):
        end = HOME + np.array([0.0, way, 0.0, 0.0, 0.0, 0.0])
        said = judge(swing(HOME, end, 60), model)
        rises = tool_pose(end, ARM)[2, 3] > tool_pose(HOME, ARM)[2, 3]
        assert (said == "") == rises, (way, said)


def test_a_held_object_is_pressed_no_deeper_into_what_it_stood_on_than_it_may_between_setpoints_either() -> None:
    tall = Shape("block", "box", (0.06, 0.06, 0.1), (0.5, 0.1, 0.05))
    model = CollisionModel(Scene("s", carried=tall), ARM)
    begin = over(*tall.position)[0]
    load = grasped_load(model, begin)
    assert load is not None
    rng, proved, pressed = np.random.default_rng(3), 0, 0
    for _ in range(60):
        end = over(*(tall.position + rng.uniform([-0.05, -0.05, -0.004], [0.05, 0.05, 0.01])))[0]
        motion = swing(begin, end, int(rng.integers(10, 90)))
        said = judge(motion, model, load)
        lowest = min(row.distance for row in model.support_distances(dense(motion), load))
        assert lowest >= -SETTINGS.contact_tolerance or "into what it stood on" in said
        proved, pressed = proved + (not said), pressed + ("into what it stood on" in said)
    assert min(proved, pressed) > 5


def weakness(check: TorqueCheck, motion: ConstantJerkMotion) -> str:
    """Return what the last bound says, unless one proves the motion."""
    said = [check(motion, stride) for stride in TORQUE_STRIDES]
    return said[-1] if all(said) else ""


def test_what_is_proved_for_the_motors_holds_with_the_object_however_it_is_held_and_without_it() -> None:
    chest = Shape("chest", "box", (0.3, 0.3, 0.3), (0.5, 0.1, 0.15), mass=7.0)
    heavy, none = (
        TorqueCheck(CollisionModel(Scene("s", carried=chest), ARM)),
        TorqueCheck(CollisionModel(Scene("s"), ARM)),
    )
    grasps, rng, proved, refused = np.random.default_rng(4), np.random.default_rng(11), 0, 0
    cases = (Dynamics(ARM), *(Dynamics(ARM, chest, grasp(grasps)) for _ in range(12)))
    for _ in range(40):
        motion = swing(*(HOME + rng.uniform(-0.25, 0.25, (2, 6))), periods=int(rng.integers(40, 125)))
        said = weakness(heavy, motion)
        use = max(float(np.max(np.abs(each.torques(*densely(motion))) / ARM.limits.torque)) for each in cases)
        assert said == "" or use > 0.6, (said, use)  # no motion is refused that is easy
        assert said or use <= 1.0
        proved += not said
        refused += weakness(none, motion) == "" and said.startswith("the motor of joint")
    assert min(proved, refused) > 5


def test_a_motion_passes_where_both_motors_and_scene_let_it_pass_in_slices_too() -> None:
    chest = Shape("chest", "box", (0.3, 0.3, 0.3), (0.5, 0.1, 0.15))  # 8 kg
    rng, outcomes = np.random.default_rng(7), set()
    for _ in range(25):
        ends = HOME + rng.uniform(-0.25, 0.25, (2, 6))
        model = CollisionModel(Scene("post", (corner(rng, ends.mean(axis=0)),), carried=chest), ARM)
        motion, torques = swing(*ends, periods=int(rng.integers(40, 125))), TorqueCheck(model)
        check, said = MotionCheck(motion, torques, SweptCheck(motion, model, None, SETTINGS)), ""
        while not (said or check.is_done):
            said = check.advance(5)
        weak, near = weakness(torques, motion), judge(motion, model)
        assert bool(said) == bool(weak or near)
        assert said == weak or (near and not said.startswith("the motor"))
        outcomes.add((bool(weak), bool(near)))
    assert len(outcomes) == 4
