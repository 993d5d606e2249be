import itertools
from dataclasses import replace

import numpy as np
import pytest

from teachpath.io.meshes import convex_hull
from teachpath.motion.arm.geometry import FINGER_END, ROD_RADIUS
from teachpath.motion.arm.kinematics import downward_poses, inverse_kinematics, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.collision.collision_model import MAX_DISTANCE, Clearance, CollisionModel, Load
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.joint_moves import placed_load
from teachpath.records import Scene, Shape, ToolPose
from tests.unit.motion.collision.solids import Surface

ARM = Arm.of_variant()

HOME = np.array(MotionSettings().home)


def over(x: float, y: float, z: float) -> np.ndarray:
    """A configuration with the tool pointing down at a place, elbow up."""
    return inverse_kinematics(downward_poses(np.array([[x, y, z]]), 0.0), ARM).joints[:, 1]


def test_the_distance_of_the_fingers_to_a_table_is_the_gap_below_them() -> None:
    table = Shape("table", "box", (0.9, 1.2, 0.04), (0.6, 0.0, 0.48))
    for gap in (0.01, 0.03):
        tip = 0.135 - 0.13  # of the fingers below the grasp point
        least = CollisionModel(Scene("s", (table,)), ARM).clearances(over(0.5, 0.1, 0.5 + tip + gap))[0]
        assert least.distance == pytest.approx(gap, abs=1e-6)
        assert least.other_body == "table"
        assert "finger" in least.body


@pytest.mark.parametrize("length", [0.05, 0.135, 0.136, 0.3])
def test_a_tool_that_ends_beyond_the_fingers_is_measured_to_its_end(length: float) -> None:
    arm = replace(ARM, tool_length=length)
    pose = tool_pose(HOME, arm)
    reach = max(length, FINGER_END) - length  # of the fingers beyond the tool centre point
    end = pose[:3, 3] + reach * pose[:3, 2]
    ball = Shape("ball", "sphere", (0.01,), tuple((end + 0.03 * pose[:3, 2]).tolist()))
    model = CollisionModel(Scene("s", (ball,)), arm)
    least = model.clearances(HOME)[0]
    if length > FINGER_END:
        assert least.distance == pytest.approx(0.02, abs=1e-6)
        assert {least.body, least.other_body} == {"tool", "ball"}
    else:
        assert "finger" in least.body
    assert model.lever_arms()[5] >= length


def test_what_holds_the_tool_keeps_away_from_what_is_beside_it() -> None:
    arm = replace(ARM, tool_length=0.3)
    pose = tool_pose(HOME, arm)
    beside = pose[:3, 3] - 0.08 * pose[:3, 2] + 0.03 * pose[:3, 1]
    for which, least in ((arm, 0.03 - ROD_RADIUS - 0.01), (ARM, 0.03)):  # without it only the fingers are near
        ball = Scene("s", (Shape("ball", "sphere", (0.01,), tuple(beside.tolist())),))
        distance = CollisionModel(ball, which).clearances(HOME)[0].distance
        assert distance == pytest.approx(least, abs=1e-6) if which is arm else distance > least


def test_a_place_is_free_in_the_middle_and_struck_at_its_worst() -> None:
    post = Shape("post", "cylinder", (0.02, 0.3), (0.5, 0.0, 0.65))
    model = CollisionModel(Scene("s", (post,)), ARM)
    q = np.concatenate([over(0.5, y, 0.7) for y in (-0.3, -0.15, 0.0, 0.15)])
    distances = [row.distance for row in model.clearances(q)]
    assert int(np.argmin(distances)) == 2
    assert distances[2] < 0 < 0.05 < distances[0]


def test_the_arm_at_home_is_clear_of_itself() -> None:
    assert CollisionModel(Scene("s"), ARM).clearances(HOME)[0].distance > 0.02


def test_a_folded_arm_meets_itself() -> None:
    least = CollisionModel(Scene("s"), ARM).clearances(over(0.15, -0.05, 0.4))[0]
    assert least.distance < 0.0
    assert {least.body, least.other_body} & {"pedestal", "trunk", "shoulder", "upper arm"}


def test_the_block_may_touch_the_table_it_stands_on_but_not_what_is_beside_it() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    q = over(*scene.carried.position)
    upright = np.eye(4)
    upright[:3, 3] = scene.carried.position
    load = Load(grasp_pose=np.linalg.inv(tool_pose(q[0], ARM)) @ upright)
    model = CollisionModel(scene, ARM)
    assert model.support_distances(q, load)[0].distance == pytest.approx(0.0, abs=1e-6)
    assert model.clearances(q, load=load)[0].distance > 0.01
    assert model.finger_distances(q, Load(position=scene.carried.position))[0].distance > 0.005
    (beside,) = model.clearances(over(0.445 - 0.02 - 0.002, 0.0, 0.6), load=load)  # the box's face is at x = 0.445
    assert beside.distance == pytest.approx(0.002, abs=1e-6)
    assert (beside.body, beside.other_body) == ("block", "box")


@pytest.mark.parametrize("tool", [None, ToolPose((0.1, -0.2, -0.1), (0.5, 0.5, -0.5, 0.5))])
def test_no_moving_point_is_farther_from_an_axis_than_its_lever(tool: ToolPose | None) -> None:
    arm = replace(ARM, tool=tool)
    surface, levers = Surface(arm), CollisionModel(paper_scene(), arm).lever_arms()
    q = np.random.default_rng(5).uniform(ARM.limits.lower, ARM.limits.upper, (60, 6))
    longest = np.zeros(6)
    for joint in range(6):
        step = np.zeros(6)
        step[joint] = 1e-6
        for one, other in zip(surface(q), surface(q + step), strict=True):
            longest[joint] = max(longest[joint], float(np.linalg.norm(other - one, axis=1).max() / 1e-6))
    assert np.all(longest <= levers + 1e-6)
    assert np.all(longest > 0.35 * levers)


BALL = Shape("ball", "sphere", (0.05,), (0.5, 0.0, 0.75))
CUBE = tuple((x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0))


TURNED_ORIENTATION = (np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8))


@pytest.mark.parametrize(
    ("shape", "distance"),
    [
        # A finger's edge is 7 cm before and 2 cm beside the middle of the shape.
        (BALL, np.hypot(0.07, 0.02) - 0.05),
        (Shape("box", "box", (0.1, 0.1, 0.1), BALL.position), 0.02),
        (
            Shape("turned", "box", (0.1, 0.1, 0.1), BALL.position, orientation=TURNED_ORIENTATION),
            (0.09 - np.sqrt(0.005)) / np.sqrt(2),
        ),
        (Shape("mesh", "mesh", (0.05,), BALL.position, vertices=CUBE), 0.02),
    ],
)
def test_every_kind_of_shape_is_met_where_it_is(shape: Shape, distance: float) -> None:
    model = CollisionModel(Scene("s", (shape,)), ARM)
    (least,) = model.clearances(over(0.5 - 0.07 - 0.011, 0.0, 0.75))
    assert least.other_body == shape.name
    assert least.distance == pytest.approx(distance, abs=2e-5)


def test_the_object_stands_turned_where_a_turned_tool_left_it() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    start, goal = over(*scene.carried.position)[0], over(0.6, 0.2, 0.6)[0]
    load = placed_load(CollisionModel(scene, ARM), start, goal + np.array([0, 0, 0, 0, 0, 0.5]))
    assert load is not None
    assert load.rotation is not None
    assert np.arctan2(load.rotation[1, 0], load.rotation[0, 0]) == pytest.approx(-0.5, abs=1e-9)


def test_nothing_near_is_far() -> None:
    assert CollisionModel(Scene("s"), ARM).clearances(over(0.5, 0.0, 0.8))[0].distance <= MAX_DISTANCE


@pytest.mark.parametrize(
    ("distance", "least", "sentence"),
    [
        (0.002, 0.005, "block comes within 2 mm of box, least allowed 5 mm"),
        (-0.012, 0.005, "block goes 1.2 cm into box, has to stay 5 mm away"),
        (-0.012, -0.003, "block goes 1.2 cm into box, at most 3 mm are allowed"),
    ],
)
def test_what_is_too_near_is_said_without_a_negative_number(distance: float, least: float, sentence: str) -> None:
    assert Clearance(distance, "block", "box").describe_violation(distance, least) == sentence


def test_the_hand_reaches_between_the_pieces_of_a_mesh_and_not_into_its_hull() -> None:
    q = over(0.5, 0.1, 0.6)
    walls = [Shape(f"wall {x}", "box", (0.02, 0.06, 0.2), (x, 0.1, 0.55)) for x in (0.43, 0.57)]
    hulls = [
        convex_hull(list(itertools.product((x - 0.01, x + 0.01), (0.07, 0.13), (0.45, 0.65))), "wall")
        for x in (0.43, 0.57)
    ]
    trough = Shape("trough", "mesh", (1.0,), (0.0, 0.0, 0.0), vertices=(*hulls[0], *hulls[1]), pieces=(12, 12))

    def least(scene: Scene) -> Clearance:
        return CollisionModel(scene, ARM).clearances(q)[0]

    apart = least(Scene("s", tuple(walls)))
    assert (apart.body.endswith("finger"), apart.distance) == (True, pytest.approx(0.049, abs=1e-6))
    for scene, name in (
        (Scene("s", (trough,)), "trough"),
        (Scene("s", keep_out=(trough,)), "the keep-out zone trough"),
    ):
        pieces = least(scene)
        assert (pieces.other_body, pieces.distance) == (name, pytest.approx(apart.distance, abs=1e-6))
    assert least(Scene("s", (replace(trough, pieces=()),))).distance < 0.0
