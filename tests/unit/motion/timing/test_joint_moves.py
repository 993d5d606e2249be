import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import downward_poses, inverse_kinematics, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.paths.ik_branches import shift_within_limits
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.joint_moves import joint_waypoints, placed_load, straight_move, waypoints_home
from teachpath.motion.timing.limit_margins import limit_uses
from teachpath.records import Scene, Shape

ARM = Arm.of_variant()

SETTINGS = MotionSettings()
HOME = np.array(SETTINGS.home)


def over(x: float, y: float, z: float) -> np.ndarray:
    return shift_within_limits(
        inverse_kinematics(downward_poses(np.array([[x, y, z]]), np.pi), ARM).joints[:, 1], ARM.limits
    )[0]


LEFT_CONFIGURATION, RIGHT_CONFIGURATION = over(0.55, 0.25, 0.6), over(0.55, -0.25, 0.6)


def scene_with(*shapes: Shape) -> CollisionModel:
    return CollisionModel(Scene("test", shapes), ARM)


def block_at(q: np.ndarray) -> Shape:
    x, y, z = (float(v) for v in tool_pose(q, ARM)[:3, 3])
    return Shape("post", "box", (0.03, 0.03, 0.03), (x, y, z))


@pytest.mark.parametrize("share", [1e-8, 1e-4, 0.1, 1.0])
def test_a_straight_run_keeps_the_limits_and_ends_where_it_should(share: float) -> None:
    goal = LEFT_CONFIGURATION + share * (RIGHT_CONFIGURATION - LEFT_CONFIGURATION)
    track = straight_move(LEFT_CONFIGURATION, goal, ARM.limits.motion, arm=ARM, margins=(1.0, 1.0, 1.0))
    np.testing.assert_allclose(track.table[[0, -1], 0, :6], [LEFT_CONFIGURATION, goal], rtol=0, atol=1e-12)
    setpoints = track.setpoints(250.0)
    assert max(use.max() for use in limit_uses(setpoints, ARM.limits.motion, 250.0)) <= 1.0 + 1e-6
    along = (
        (setpoints[:, :6] - LEFT_CONFIGURATION) @ (goal - LEFT_CONFIGURATION) / np.sum((goal - LEFT_CONFIGURATION) ** 2)
    )
    np.testing.assert_allclose(
        setpoints[:, :6], LEFT_CONFIGURATION + along[:, None] * (goal - LEFT_CONFIGURATION), rtol=0, atol=1e-12
    )


def test_a_free_way_is_straight() -> None:
    assert len(joint_waypoints(scene_with(), LEFT_CONFIGURATION, RIGHT_CONFIGURATION, SETTINGS)) == 2


def test_a_blocked_way_goes_over_the_home() -> None:
    stops = joint_waypoints(
        scene_with(block_at((LEFT_CONFIGURATION + RIGHT_CONFIGURATION) / 2)),
        LEFT_CONFIGURATION,
        RIGHT_CONFIGURATION,
        SETTINGS,
    )
    assert len(stops) == 3
    np.testing.assert_array_equal(stops[1], HOME)


def test_without_any_free_way_it_is_refused_by_name() -> None:
    with pytest.raises(PathRefused, match=r"on the way to the path's start: .* into post"):
        joint_waypoints(scene_with(block_at(RIGHT_CONFIGURATION)), LEFT_CONFIGURATION, RIGHT_CONFIGURATION, SETTINGS)


def test_the_way_home_must_be_free() -> None:
    goal = over(0.55, 0.25, 0.52)
    start = over(0.55, -0.25, 0.52)
    assert len(waypoints_home(scene_with(), start, goal, LEFT_CONFIGURATION, SETTINGS)) == 2
    with pytest.raises(PathRefused, match=r"on the way home from the goal: .* into post"):
        waypoints_home(scene_with(block_at((LEFT_CONFIGURATION + HOME) / 2)), start, goal, LEFT_CONFIGURATION, SETTINGS)


def test_the_object_is_left_where_the_path_brought_it() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    load = placed_load(CollisionModel(scene, ARM), over(0.58, -0.28, 0.52), over(0.60, 0.20, 0.54))
    assert load is not None
    moved = np.array(load.position) - np.array(scene.carried.position)
    np.testing.assert_allclose(moved, [0.02, 0.48, 0.02], atol=1e-9)
    assert placed_load(CollisionModel(Scene("empty"), ARM), LEFT_CONFIGURATION, RIGHT_CONFIGURATION) is None
