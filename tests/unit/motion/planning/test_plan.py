from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.io.documents import decode, encode
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.paths.tool_path import ArcLength
from teachpath.motion.planning.certificate import largest_limit_uses, plan_trajectory
from teachpath.motion.planning.digest import digest, verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.refusals import describe
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Plan, Shape
from tests.unit.motion.ways import FAR_X, MIDDLE, NEAR_X, clamped, learned, way

ARM = Arm.of_variant()
TILTED_TOOL = MotionSettings(
    tool_position=(0.05, -0.04, 0.16),
    tool_orientation=(np.cos(0.2), 0.6 * np.sin(0.2), 0.8 * np.sin(0.2), 0.0),  # joint 6 alone does not roll it
)


@pytest.fixture(scope="module")
def middle() -> Plan:
    return plan(way(MIDDLE), paper_scene())


@pytest.mark.parametrize("degree", [3, 5])
@pytest.mark.parametrize("x", [NEAR_X, MIDDLE, FAR_X])
def test_the_three_ways_of_the_paper_keep_every_limit_and_the_path(x: float, degree: int) -> None:
    path = way(x, degree=degree)
    made = plan(path, paper_scene())
    setpoints = plan_trajectory(made).setpoints(250.0)
    q, s = setpoints[:, :6], setpoints[:, 6]
    assert np.all((q >= ARM.limits.lower) & (q <= ARM.limits.upper))
    for order, limit in ((1, ARM.limits.speed), (2, ARM.limits.acceleration), (3, ARM.limits.jerk)):
        assert np.all(np.abs(np.diff(q, order, axis=0)) * 250.0**order <= limit)
    wanted = path.curve(ArcLength(path.curve).parameters(s))
    poses = tool_pose(q, ARM)
    assert np.linalg.norm(poses[:, :3, 3] - wanted, axis=1).max() < 1e-4
    np.testing.assert_allclose(poses[:, :3, 2], np.tile([0, 0, -1], (len(s), 1)), atol=1e-4)
    assert made.certificate.clearance.value >= MotionSettings().clearance_min
    assert plan_trajectory(made).duration == made.duration


def test_the_certificate_agrees_with_setpoints_differenced_again(middle: Plan) -> None:
    certificate = middle.certificate
    written = certificate.position_use, certificate.velocity_use, certificate.acceleration_use, certificate.jerk_use
    assert written == largest_limit_uses(plan_trajectory(middle).setpoints(250.0), 250.0, ARM.limits)


def test_a_plan_survives_json_and_any_change_of_it_is_noticed(middle: Plan) -> None:
    back = decode(Plan, encode(middle))
    verify(back, ARM)
    bent = back.joints.copy()
    bent[10, 2] += 1e-9
    assert middle.scene.carried is not None
    moved = replace(middle.scene, obstacles=middle.scene.obstacles[:-1])
    for changed in (
        replace(back, joints=bent),
        replace(back, scene=moved),
        replace(back, squared_rates=back.squared_rates * 1.01),
        replace(back, limits=back.limits * 1.01),
        replace(back, duration=back.duration * 0.99),
        replace(back, path_version=2),
        replace(back, above_goal=back.above_goal + 1e-9),
    ):
        with pytest.raises(PathRefused, match="changed since it was certified"):
            verify(changed, ARM)
    assert digest(back, ARM) == middle.certificate.digest


def test_a_path_through_an_obstacle_is_refused_by_name_and_place() -> None:
    with pytest.raises(PathRefused, match=r"into box, has to stay .* mm away, at s = 0\.\d+ m .*control point \d of 9"):
        plan(way(0.48), paper_scene())
    with pytest.raises(PathRefused, match="into cylinder, has to stay"):
        plan(way(0.67), paper_scene())


@pytest.mark.parametrize(("x", "fault"), [(0.48, "collision"), (1.5, "reach"), (0.31, "limit")])
def test_a_refusal_carries_the_record_that_its_sentence_tells(x: float, fault: str) -> None:
    path = way(x)
    with pytest.raises(PathRefused) as refused:
        plan(path, paper_scene())
    failure = refused.value.failure
    assert failure.fault == fault
    assert describe(failure) == str(refused.value)
    assert 0 <= failure.suggestion.control_point < len(path.curve.control_points)
    assert failure.interval[0] == failure.s <= failure.interval[1]


def test_a_path_out_of_reach_is_refused_with_its_place() -> None:
    with pytest.raises(PathRefused, match=r"wrist centre .* cm outside the reach at s = .* control point 5 of 9"):
        plan(way(1.5), paper_scene())
    with pytest.raises(PathRefused, match="too near to the arm's own axis at s ="):
        plan(way(-0.1), paper_scene())


def test_a_path_beyond_a_joint_limit_names_joint_and_limit() -> None:
    with pytest.raises(
        PathRefused, match=r"joint 3 needs -22[0-9.]+ deg, limit -225\.0, at s = .* control point 5 of 9"
    ):
        plan(way(0.31), paper_scene())


def test_a_path_into_the_table_is_refused() -> None:
    with pytest.raises(PathRefused, match="table"):
        plan(way(MIDDLE, height=0.505), paper_scene())


def test_a_path_that_does_not_start_at_the_object_is_refused() -> None:
    path = way(MIDDLE)
    shifted = clamped(path.curve.control_points + np.array([0.0, 0.06, 0.0]))
    with pytest.raises(PathRefused, match=r"starts 6\.0 cm from where block stands"):
        plan(learned(shifted), paper_scene())


def test_a_path_that_stands_still_or_has_no_length_is_refused() -> None:
    points = way(MIDDLE).curve.control_points
    with pytest.raises(PathRefused, match="control points coincide"):
        plan(learned(clamped(np.repeat(points[[0, 4, 8]], 4, axis=0))), empty_scene())
    with pytest.raises(PathRefused, match="is 0 mm long, the shortest followed is 1 cm"):
        plan(learned(clamped(np.repeat(points[:1], 5, axis=0))), empty_scene())


def test_without_an_object_the_path_is_simply_followed() -> None:
    made = plan(way(MIDDLE), empty_scene())
    assert made.scene.carried is None
    verify(made, ARM)


def test_the_same_path_gives_the_same_motion(middle: Plan) -> None:
    again = plan(way(MIDDLE), paper_scene())
    assert again.certificate.digest == middle.certificate.digest


def under_a_lid(height: float, *, at_goal: bool) -> tuple[np.ndarray, np.ndarray]:
    """Plan with a lid of which the underside lies at a height, and return how the tool comes to and leaves the path."""
    scene = paper_scene()
    assert scene.carried is not None
    x, y, _ = scene.carried.position
    lid = Shape("lid", "box", (0.3, 0.3, 0.02), (x - 0.05, (0.2 - y) if at_goal else (y - 0.2), height + 0.01))
    made = plan(way(MIDDLE), replace(scene, obstacles=(*scene.obstacles, lid)))
    verify(made, ARM)
    ends = np.array([made.above_start, made.joints[0], made.above_goal, made.joints[-1]])
    before, start, after, goal = tool_pose(ends, ARM)[:, :3, 3]
    return before - start, after - goal


@pytest.mark.parametrize("at_goal", [False, True])
def test_where_above_is_not_free_the_arm_comes_and_goes_from_nearer_or_from_a_side(at_goal: bool) -> None:
    lift = MotionSettings().lift
    above = {height: under_a_lid(height, at_goal=at_goal)[at_goal] for height in (1.0, 0.79, 0.78, 0.76)}
    for height, distance in ((1.0, lift), (0.79, lift / 2), (0.78, lift / 4)):
        np.testing.assert_allclose(above[height], [0.0, 0.0, distance], atol=1e-9)
    assert np.hypot(*above[0.76][:2]) > 0.02
    assert above[0.76][2] > 0.0


def test_the_other_end_of_the_path_is_left_as_it_is() -> None:
    np.testing.assert_allclose(under_a_lid(0.76, at_goal=False)[1], [0.0, 0.0, MotionSettings().lift], atol=1e-9)


@pytest.mark.parametrize("settings", [MotionSettings(), TILTED_TOOL], ids=["on the axis", "tilted"])
def test_the_tool_rolls_along_the_path_where_no_one_roll_leads_through(settings: MotionSettings) -> None:
    corner = [
        [0.42, -0.2],
        [0.5, -0.2],
        [0.58, -0.2],
        [0.64, -0.2],
        [0.64, -0.14],
        [0.64, -0.06],
        [0.64, 0.02],
        [0.64, 0.1],
    ]
    curve = clamped(np.column_stack([corner, np.full(8, 0.6)]), degree=5)
    # Two gates, too narrow for the broad side of the gripper, one across x and one across y.
    gates = [(0.5, -0.2 - 0.05), (0.5, -0.2 + 0.05), (0.64 - 0.05, 0.0), (0.64 + 0.05, 0.0)]
    posts = tuple(Shape(f"post {k}", "cylinder", (0.01, 0.2), (x, y, 0.6)) for k, (x, y) in enumerate(gates))
    scene = empty_scene()
    one, other = (replace(scene, obstacles=(*scene.obstacles, *some)) for some in (posts[:2], posts[2:]))
    both = replace(scene, obstacles=(*scene.obstacles, *posts))
    assert {"rolling" in plan(learned(curve), single, settings).certificate.branch for single in (one, other)} == {
        False
    }
    made = plan(learned(curve), both, settings)
    assert "rolling" in made.certificate.branch
    assert made.certificate.clearance.value >= MotionSettings().clearance_min
    setpoints = plan_trajectory(made).setpoints(250.0)
    poses = tool_pose(setpoints[:, :6], Arm.of_settings(settings))
    wanted = curve(ArcLength(curve).parameters(setpoints[:, 6]))
    assert np.linalg.norm(poses[:, :3, 3] - wanted, axis=1).max() < 1e-4
    assert np.degrees(np.arccos(np.clip(poses[:, :3, 0] @ poses[0, :3, 0], -1, 1))).max() > 45.0


def test_an_end_that_the_arm_cannot_come_to_is_refused() -> None:
    in_the_way = Shape(
        "crate", "box", (0.04, 0.04, 0.04), tuple(tool_pose(np.array(MotionSettings().home), ARM)[:3, 3])
    )
    scene = empty_scene()
    aside = np.linspace([0.45, -0.5, 0.65], [0.5, -0.35, 0.65], 6)
    with pytest.raises(PathRefused, match=r"into crate.*none of \d+ ways to the start of the path is free"):
        plan(learned(clamped(aside, degree=5)), replace(scene, obstacles=(*scene.obstacles, in_the_way)))


def test_a_demonstrated_turn_is_followed_by_the_tool_when_it_is_asked_for() -> None:
    curve = way(MIDDLE, degree=5).curve
    angles = np.linspace(0.0, 0.3, len(curve.control_points))
    turns = np.column_stack([np.cos(angles / 2), 0 * angles, np.sin(angles / 2), 0 * angles])
    path = replace(learned(curve), orientation=Curve(curve.degree, curve.knots, turns, curve.weights))
    made = plan(path, empty_scene(), MotionSettings(orientation="demonstrated"))
    first, last = tool_pose(made.joints[[0, -1]], ARM)[:, :3, :3]
    c, s = np.cos(0.3), np.sin(0.3)
    np.testing.assert_allclose(last @ first.T, [[c, 0, s], [0, 1, 0], [-s, 0, c]], atol=1e-6)
    np.testing.assert_allclose(first[:, 2], [0, 0, -1], atol=1e-9)
    fixed = plan(path, empty_scene())
    np.testing.assert_allclose(tool_pose(fixed.joints, ARM)[:, 2, 2], -1.0, atol=1e-9)
