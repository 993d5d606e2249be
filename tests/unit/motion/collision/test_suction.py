"""A suction cup takes flat faces that it touches wholly, and its plans keep it above the object."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused, UnusableInput
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.collision.grasp import grasp_fault, tool_offset_of
from teachpath.motion.planning.assessment import assess
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Shape
from teachpath.simulator.arm import SimulatedArm
from teachpath.simulator.settings import SimulatorSettings
from tests.unit.motion.ways import MIDDLE, way

SETTINGS = MotionSettings(gripper="suction")
ARM = Arm.of_settings(SETTINGS)
BOX = Shape("box", "box", (0.04, 0.06, 0.08), (0.0, 0.0, 0.0))
CAN_SHAPE = Shape("can", "cylinder", (0.02, 0.1), (0.0, 0.0, 0.0))


def pose(
    x: float = 0.0, y: float = 0.0, gap: float = 0.0, *, half: float = 0.04, turn: np.ndarray | None = None
) -> np.ndarray:
    """Of an object to the gripper, upside down under it, `gap` from the lip to its face [m]."""
    found = np.diag([1.0, -1.0, -1.0, 1.0])
    found[:3, 3] = x, y, ARM.tool_length + gap + half
    if turn is not None:
        found[:3, :3] = turn @ found[:3, :3]
    return found


def lean(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.004, 0.014), (-0.004, -0.014)])
def test_a_face_that_the_lip_touches_wholly_is_taken(place: tuple[float, float]) -> None:
    assert grasp_fault(BOX, pose(*place), ARM, margin=0.001) == ""


def test_a_box_is_taken_by_any_face_and_a_cylinder_by_its_end() -> None:
    on_its_side = pose(half=0.03, turn=lean(np.pi / 2))
    assert grasp_fault(BOX, on_its_side, ARM) == ""
    assert grasp_fault(CAN_SHAPE, pose(half=0.05), ARM) == ""
    assert "round side" in grasp_fault(CAN_SHAPE, pose(half=0.02, turn=lean(np.pi / 2)), ARM)


@pytest.mark.parametrize(
    ("shape", "where", "said"),
    [
        (BOX, pose(0.008), "over the edge of box by 3"),
        (BOX, pose(y=0.02), "over the edge of box by 5"),
        (CAN_SHAPE, pose(0.01, half=0.05), "over the edge of can by 5"),
        (BOX, pose(gap=0.01), "ends 1 cm above the face"),
        (BOX, pose(gap=-0.01), "ends 1 cm below the face"),
        (BOX, pose(turn=lean(0.1)), "turned by 6 deg"),
        (Shape("ball", "sphere", (0.03,), (0.0, 0.0, 0.0)), pose(half=0.03), "is a sphere"),
    ],
)
def test_what_it_does_not_take_is_said_with_how_much_is_lacking(shape: Shape, where: np.ndarray, said: str) -> None:
    assert said in grasp_fault(shape, where, ARM)


def test_a_plan_keeps_the_cup_on_the_object_and_the_simulated_cup_takes_it_there() -> None:
    scene = paper_scene()
    carried, path = scene.carried, way(MIDDLE)
    assert carried is not None
    assert assess(path.curve, scene, SETTINGS).failure is None
    made = plan(path, scene, SETTINGS)
    tools = tool_pose(made.joints[[0, -1]], ARM)
    above = tools[:, :3, 3] - path.curve(np.array([0.0, 1.0]))
    np.testing.assert_allclose(above, [[0.0, 0.0, carried.size[2] / 2]] * 2, atol=1e-6)
    assert tool_offset_of(scene, ARM) == pytest.approx(carried.size[2] / 2)
    simulated = SimulatedArm(scene, ARM, SimulatorSettings(), made.joints[0].tolist())
    assert simulated.grasp()
    assert simulated.gripper_opening is None
    away = SimulatedArm(scene, ARM, SimulatorSettings(), made.above_start.tolist())
    assert not away.grasp()


def test_an_object_that_is_too_small_for_the_cup_is_refused_with_the_reason() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    thin = replace(scene, carried=replace(scene.carried, size=(0.02, 0.02, scene.carried.size[2])))
    with pytest.raises(PathRefused, match="suction cup sticks out over the edge"):
        plan(way(MIDDLE), thin, SETTINGS)


def test_an_arm_without_a_gripper_carries_nothing_and_is_as_heavy_as_its_payload() -> None:
    bare = MotionSettings(gripper="none")
    with pytest.raises(UnusableInput, match=r"motion\.gripper is none"):
        plan(way(MIDDLE), paper_scene(), bare)
    simulated = SimulatedArm(
        replace(paper_scene(), carried=None), Arm.of_settings(bare), SimulatorSettings(), bare.home
    )
    assert not simulated.grasp()
