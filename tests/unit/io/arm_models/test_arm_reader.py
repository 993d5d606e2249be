"""What a user's model says of an arm, and what is refused with the way out."""

import struct
from itertools import product
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from teachpath.errors import UnusableInput
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.links import bounding_corners
from teachpath.motion.arm.poses import pose_matrix
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.records import LimitSource
from tests.unit.io.arm_models.models import SEVEN_AXIS, SIX_AXIS, changed, limits

ELBOW = '<limit lower="-2.8" upper="2.8" velocity="2.5" effort="120"/>'
CYLINDER = '<cylinder radius="0.045" length="0.4"/>'  # of the forearm
SLIDE = '<joint name="{0}" type="prismatic"><parent link="tool0"/><child link="{0}"/><axis xyz="0 1 0"/>{1}</joint>'
FINGER = (
    '<link name="{0}"><inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/>'
    "</inertial></link>" + SLIDE
)
RANGE = '<limit lower="0" upper="0.04" velocity="0.1" effort="10"/>'
FINGERS = FINGER.format("left", RANGE) + FINGER.format("right", RANGE + '<mimic joint="left"/>')
SECOND_ARM = (
    '<body name="other" pos="0 1 0"><joint name="other" axis="0 0 1" range="-1 1"/><geom size="0.1" mass="1"/></body>'
)
TIED_LINKS = '<equality><connect body1="link2" body2="link4" anchor="0 0 0"/></equality></mujoco>'


@pytest.mark.parametrize(
    ("example", "changes", "sentence"),
    [
        (
            SIX_AXIS,
            [("<robot ", '<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:arm/></robot><robot ')],
            "expanded",
        ),
        (SIX_AXIS, [("<robot ", "<sdf ")], "is no XML"),
        (SEVEN_AXIS, [("<mujoco ", "<sdf "), ("</mujoco>", "</sdf>")], "begins with <sdf>; a URDF begins with <robot>"),
        (SIX_AXIS, [(CYLINDER, '<mesh filename="arm.stl"/>')], "the mesh arm.stl is missing"),
        (SIX_AXIS, [(CYLINDER, '<mesh filename="package://my_arm/arm.stl"/>')], "put the package my_arm there"),
        (
            SIX_AXIS,
            [(ELBOW, ELBOW.replace('velocity="2.5"', 'velocity="0"'))],
            "forearm_joint has the limit velocity 0",
        ),
        (SIX_AXIS, [(ELBOW, ELBOW.replace('effort="120"', 'effort="-1"'))], "forearm_joint has the limit effort -1"),
        (
            SIX_AXIS,
            [('forearm_joint" type="revolute"', 'forearm_joint" type="continuous"')],
            "forearm_joint is continuous",
        ),
        (SIX_AXIS, [(ELBOW, f'{ELBOW}<mimic joint="upper_arm_joint"/>')], "forearm_joint mimics upper_arm_joint"),
        (
            SIX_AXIS,
            [('forearm_joint" type="revolute"', 'forearm_joint" type="prismatic"')],
            "forearm_joint is a slide joint",
        ),
        (SIX_AXIS, [('wrist_3_joint" type="revolute"', 'wrist_3_joint" type="fixed"')], "the arm has 5 joints"),
        (
            SIX_AXIS,
            [('<child link="tool0"/>', '<child link="wrist_1_link"/>')],
            "both move wrist_1_link: a closed loop",
        ),
        (SIX_AXIS, [('<mass value="2.8"/>', '<mass value="0"/>')], "give the link an <inertial>"),
        (SEVEN_AXIS, [('axis="0 -1 0" range', 'axis="0 -1 0" ref="0.3" range')], "joint4 has ref 0.3"),
        (
            SEVEN_AXIS,
            [(' range="-1.7 1.7"', "")],
            r"joint2 is continuous, .*write lower and upper \[rad\] of \[joints.joint2\]",
        ),
        (SEVEN_AXIS, [("</mujoco>", TIED_LINKS)], "link2 and link4 are tied together"),
        (SEVEN_AXIS, [("</worldbody>", f"{SECOND_ARM}</worldbody>")], "2 arms, which end in link7, other; name one"),
        (SEVEN_AXIS, [("<worldbody>", "<worldbody/><other>"), ("</worldbody>", "</other>")], "MuJoCo cannot use"),
    ],
)
def test_a_model_that_cannot_be_used_is_refused_with_the_way_out(
    tmp_path: Path, example: Path, changes: list[tuple[str, str]], sentence: str
) -> None:
    with pytest.raises(UnusableInput, match=sentence):
        read_arm(changed(tmp_path, example, *changes))


def test_inertia_that_no_body_has_is_refused_with_its_link(tmp_path: Path) -> None:
    impossible = changed(
        tmp_path, SIX_AXIS, ('<mass value="2.8"/>\n      <inertia ixx="', '<mass value="2.8"/>\n<inertia ixx="9')
    )
    with pytest.raises(
        UnusableInput, match=r"forearm_link has principal moments of inertia .* write those of the real"
    ):
        read_arm(impossible)


def test_a_model_without_joints_is_refused(tmp_path: Path) -> None:
    empty = tmp_path / "empty.urdf"
    empty.write_text('<robot name="r"><link name="base"/></robot>')
    with pytest.raises(UnusableInput, match="has no joints"):
        read_arm(empty)
    with pytest.raises(UnusableInput, match=r"cannot read the model .*: No such file"):
        read_arm(tmp_path / "nowhere.urdf")


def test_limits_say_who_gave_them(tmp_path: Path) -> None:
    arm = read_arm(
        SIX_AXIS, limits=limits(tmp_path, "acceleration = 5\n[joints.forearm_joint]\nspeed = 1.25\nupper = 2.0")
    )
    elbow = arm.joints[2]
    assert (elbow.lower.value, elbow.lower.source) == (-2.8, LimitSource.MODEL)
    assert (elbow.upper.value, elbow.upper.source) == (2.0, LimitSource.OPERATOR)
    assert (elbow.speed.value, elbow.speed.source) == (1.25, LimitSource.OPERATOR)
    assert [joint.acceleration.value for joint in arm.joints] == [5.0] * 6
    assert {joint.jerk.source for joint in arm.joints} == {LimitSource.DEFAULT}
    assert (arm.joints[3].torque.value, arm.joints[3].torque.source) == (28.0, LimitSource.MODEL)


def test_where_nobody_says_a_torque_the_joint_holds_the_arm_stretched_out(tmp_path: Path) -> None:
    silent = changed(tmp_path, SIX_AXIS, (' effort="120"', ""))
    arm = read_arm(silent)
    far, moment = 0.0, 0.0
    for link in arm.links[2:]:
        far += 0.0 if link is arm.links[2] else float(np.linalg.norm(link.pose[0]))
        moment += link.mass * (far + float(np.linalg.norm(link.center)))
    assert arm.joints[2].torque.source is LimitSource.DEFAULT
    assert arm.joints[2].torque.value == pytest.approx(9.81 * moment)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("speed = 0", "speed of shoulder_joint is 0; write a number above zero"),
        ("speed = [1, 2]", "speed has 2 values; write 6"),
        ("speed = 'fast'", "is 'fast'; write a number"),
        ("sped = 1", "there is no 'sped'; known: speed, acceleration"),
        ("[joints.elbow]\nspeed = 1", "there is no 'elbow'; known: shoulder_joint, "),
        ("[joints.forearm_joint]\nlower = 3.0", "forearm_joint may turn from 3 to 2.8 rad"),
        ("[payload]\nmass = -1", "payload.mass is -1 kg"),
        ("speed = ", "is no TOML"),
    ],
)
def test_limits_that_no_arm_can_have_are_refused(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(UnusableInput, match=sentence):
        read_arm(SIX_AXIS, limits=limits(tmp_path, text))


def test_fingers_at_the_end_are_held_and_said(tmp_path: Path) -> None:
    arm = read_arm(changed(tmp_path, SIX_AXIS, ("</robot>", f"{FINGERS}</robot>")))
    assert arm.held == ("left", "right")
    assert len(arm.links) == 6
    assert arm.links[-1].mass == pytest.approx(0.3 + 0.2)


def test_one_of_two_arms_is_named_by_its_tool(tmp_path: Path) -> None:
    two = changed(tmp_path, SEVEN_AXIS, ("</worldbody>", f"{SECOND_ARM}</worldbody>"))
    arm = read_arm(two, tool="tool0")
    assert arm.held == ("other",)
    assert arm.links == read_arm(SEVEN_AXIS).links
    with pytest.raises(UnusableInput, match="no body or site 'hand' for the tool; known: base, link1"):
        read_arm(two, tool="hand")


def test_a_mesh_of_a_package_is_found_and_becomes_its_hull(tmp_path: Path) -> None:
    corners = np.array(list(product((0.0, 0.1), repeat=3)), dtype="<f4")
    triangles = [corners[[a, b, c]] for a, b, c in ((0, 1, 2), (1, 3, 2), (4, 5, 6), (5, 7, 6), (0, 4, 1), (3, 2, 7))]
    records = b"".join(bytes(12) + triangle.tobytes() + bytes(2) for triangle in triangles)
    (tmp_path / "my_arm" / "urdf").mkdir(parents=True)
    (tmp_path / "my_arm" / "cube.stl").write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + records)
    mesh = '<mesh filename="package://my_arm/cube.stl" scale="1 1 2"/>'
    arm = read_arm(changed(tmp_path / "my_arm" / "urdf", SIX_AXIS, (CYLINDER, mesh)))
    (solid,) = arm.links[2].solids
    assert solid.kind == "mesh"
    turn = rotation_matrices(np.array([solid.orientation]))[0]
    seen = np.array(solid.vertices) @ turn.T + solid.position
    np.testing.assert_allclose(seen.min(axis=0), [0.0, 0.0, 0.2], atol=1e-6)
    np.testing.assert_allclose(seen.max(axis=0), [0.1, 0.1, 0.4], atol=1e-6)


def test_what_bounds_a_hull_of_many_corners_holds_all_of_them_and_little_more() -> None:
    points = np.random.default_rng(9).normal(size=(3000, 3))
    ends = np.where(points[:, :1] > 0, 0.2, -0.2) * [1.0, 0.0, 0.0]
    round_rod = 0.05 * points / np.linalg.norm(points, axis=1)[:, None] + ends
    hull = ConvexHull(round_rod)
    bound = ConvexHull(bounding_corners(round_rod, hull))
    assert len(bound.vertices) <= 240
    assert np.all(bound.equations[:, :3] @ round_rod.T + bound.equations[:, 3:] <= 0.0)
    assert hull.volume < bound.volume < 1.1 * hull.volume


@pytest.mark.parametrize("example", [SIX_AXIS, SEVEN_AXIS])
def test_mass_and_inertia_are_those_of_mujoco(example: Path) -> None:
    """The arm's mass matrix follows from masses, centres and inertia alone, joint by joint behind each other."""
    spec = mujoco.MjSpec.from_file(str(example))
    model = spec.compile()
    arm = read_arm(example)
    for link, body in zip(arm.links, model.jnt_bodyid, strict=True):
        assert link.mass == pytest.approx(model.body_mass[body])
        np.testing.assert_allclose(link.center, model.body_ipos[body], atol=1e-12)
        xx, yy, zz, xy, xz, yz = link.inertia
        moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        np.testing.assert_allclose(moments, np.sort(model.body_inertia[body]), rtol=1e-9)


def test_arms_that_compute_the_same_have_one_hash(tmp_path: Path) -> None:
    arm = read_arm(SIX_AXIS)
    assert arm.hash == read_arm(SIX_AXIS, name="another").hash
    assert arm.hash != read_arm(SIX_AXIS, base=((0.0, 0.0, 0.1), (1.0, 0.0, 0.0, 0.0))).hash
    assert arm.hash != read_arm(SIX_AXIS, limits=limits(tmp_path, "[payload]\nmass = 0.5")).hash


def test_a_gripper_is_mounted_on_the_tools_frame() -> None:
    bare, hand = read_arm("six-axis"), read_arm("six-axis", gripper_length=0.13)
    ahead = pose_matrix(bare.tool) @ [0.0, 0.0, 0.13, 1.0]
    np.testing.assert_allclose(hand.tool[0], ahead[:3], atol=1e-15)
    assert hand.tool[1] == bare.tool[1]
    assert hand.hash != bare.hash
    with pytest.raises(UnusableInput, match=r"a gripper of 0.7 m is outside 0.05 to 0.5"):
        read_arm("six-axis", gripper_length=0.7)
