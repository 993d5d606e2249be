import numpy as np
import pytest

from teachpath.motion import MotionSettings, paper_scene, plan
from teachpath.motion.kinematics import downward, inverse, tool_pose
from teachpath.motion.scene import FAR, CollisionModel, Load
from teachpath.records import Scene, Shape
from tests.unit.motion.ways import MIDDLE, way

HOME = np.array(MotionSettings().home)


def over(x: float, y: float, z: float) -> np.ndarray:
    """A configuration with the tool pointing down at a place, elbow up."""
    return inverse(downward(np.array([[x, y, z]]), 0.0)).joints[:, 1]


def test_the_distance_of_the_fingers_to_a_table_is_the_gap_below_them() -> None:
    table = Shape("table", "box", (0.9, 1.2, 0.04), (0.6, 0.0, 0.48))
    for gap in (0.01, 0.03):
        tip = 0.135 - 0.13  # of the fingers below the grasp point
        least = CollisionModel(Scene("s", (table,))).clearance(over(0.5, 0.1, 0.5 + tip + gap))
        assert least.distance == pytest.approx(gap, abs=1e-6)
        assert least.other == "table"
        assert "finger" in least.part


def test_a_place_is_free_in_the_middle_and_struck_at_its_worst() -> None:
    post = Shape("post", "cylinder", (0.02, 0.3), (0.5, 0.0, 0.65))
    model = CollisionModel(Scene("s", (post,)))
    q = np.concatenate([over(0.5, y, 0.7) for y in (-0.3, -0.15, 0.0, 0.15)])
    least = model.clearance(q)
    assert least.index == 2
    assert least.distance < 0
    assert model.clearance(q[:1]).distance > 0.05


def test_the_arm_at_home_is_clear_of_itself() -> None:
    assert CollisionModel(Scene("s")).clearance(HOME).distance > 0.02


def test_a_folded_arm_meets_itself() -> None:
    least = CollisionModel(Scene("s")).clearance(over(0.15, -0.05, 0.4))
    assert least.distance < 0.0
    assert {least.part, least.other} & {"pedestal", "trunk", "shoulder", "upper arm"}


def test_the_block_may_touch_the_table_it_stands_on_but_not_what_is_beside_it() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    q = over(*scene.carried.position)
    upright = np.eye(4)
    upright[:3, 3] = scene.carried.position
    load = Load(grasp=np.linalg.inv(tool_pose(q[0])) @ upright)
    model = CollisionModel(scene)
    assert model.support(q, load).distance == pytest.approx(0.0, abs=1e-6)
    assert model.clearance(q, load=load).distance > 0.01
    assert model.straddle(q, Load(placed=scene.carried.position)).distance > 0.005
    beside = model.clearance(over(0.445 - 0.02 - 0.002, 0.0, 0.6), load=load)  # the box's face is at x = 0.445
    assert beside.distance == pytest.approx(0.002, abs=1e-6)
    assert (beside.part, beside.other) == ("block", "box")


def test_the_clearance_of_a_plan_is_the_least_of_all_its_configurations_one_by_one() -> None:
    made = plan(way(MIDDLE), paper_scene())
    model = CollisionModel(paper_scene())
    q = made.joints[::20]
    each = [model.clearance(row).distance for row in q]
    together = model.clearance(q)
    assert together.distance == pytest.approx(min(each), abs=1e-9)
    assert together.index == int(np.argmin(each))


def test_nothing_near_is_far() -> None:
    assert CollisionModel(Scene("s")).clearance(over(0.5, 0.0, 0.8)).distance <= FAR
