import mujoco
import numpy as np
import pytest

from teachpath.motion.arm.kinematics import (
    BRANCH_NAMES,
    LinkLengths,
    describe_reach,
    downward_poses,
    inverse_kinematics,
    jacobian,
    link_frames,
    min_singular_value,
    tool_pose,
)
from teachpath.motion.arm.mjcf import write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene

ARM = Arm.of_variant()
LENGTHS = LinkLengths.of_arm(ARM)


@pytest.fixture(scope="module")
def configurations() -> np.ndarray:
    return np.random.default_rng(560).uniform(ARM.limits.lower, ARM.limits.upper, (300, 6))


def product_of_screws(q: np.ndarray) -> np.ndarray:
    """The tool's pose from four elementary matrices a link, multiplied in order."""

    def turn(axis: int, angle: float) -> np.ndarray:
        a, b = [i for i in range(3) if i != axis]
        m = np.eye(4)
        sign = -1.0 if axis == 1 else 1.0
        m[a, a] = m[b, b] = np.cos(angle)
        m[a, b], m[b, a] = -sign * np.sin(angle), sign * np.sin(angle)
        return m

    def shift(axis: int, distance: float) -> np.ndarray:
        m = np.eye(4)
        m[axis, 3] = distance
        return m

    pose = np.eye(4)
    for link, angle in zip(ARM.links, q, strict=True):
        pose = pose @ turn(2, angle) @ shift(2, link.d) @ shift(0, link.a) @ turn(0, link.alpha)
    return pose @ shift(2, ARM.tool_length)


def test_forward_kinematics_is_the_product_of_elementary_screws(configurations: np.ndarray) -> None:
    for q, pose in zip(configurations, tool_pose(configurations, ARM), strict=True):
        np.testing.assert_allclose(pose, product_of_screws(q), atol=1e-12)


def test_forward_kinematics_agrees_with_mujoco(configurations: np.ndarray) -> None:
    model = mujoco.MjModel.from_xml_string(write_mjcf(paper_scene(), ARM))
    data = mujoco.MjData(model)
    for q in configurations[:50]:
        data.qpos[:6] = q
        mujoco.mj_forward(model, data)
        frames = link_frames(q, ARM)
        for link in range(1, 7):
            body = data.body(f"link{link}")
            np.testing.assert_allclose(body.xpos, frames[link, :3, 3], atol=1e-12)
            np.testing.assert_allclose(body.xmat.reshape(3, 3), frames[link, :3, :3], atol=1e-12)
        tip = body.xpos + ARM.tool_length * body.xmat.reshape(3, 3)[:, 2]
        np.testing.assert_allclose(tip, tool_pose(q, ARM)[:3, 3], atol=1e-12)


def test_all_eight_branches_reach_the_pose_and_one_is_the_configuration(configurations: np.ndarray) -> None:
    poses = tool_pose(configurations, ARM)
    solutions = inverse_kinematics(poses, ARM)
    assert solutions.reach_excess.max() <= 0
    assert solutions.joints.shape == (len(poses), len(BRANCH_NAMES), 6)
    np.testing.assert_allclose(tool_pose(solutions.joints, ARM), np.repeat(poses[:, None], 8, axis=1), atol=1e-10)
    off = np.abs(np.exp(1j * solutions.joints) - np.exp(1j * configurations[:, None])).max(axis=2)
    assert off.min(axis=1).max() < 1e-9


def test_the_branches_are_what_their_names_say(configurations: np.ndarray) -> None:
    joints = inverse_kinematics(tool_pose(configurations, ARM), ARM).joints
    frames = link_frames(joints, ARM)
    shoulder, elbow, wrist = (frames[..., i, :3, 3] for i in (1, 2, 4))
    ahead = np.einsum("...i,...i", wrist - shoulder, frames[..., 1, :3, 0])
    higher = np.cross(wrist - shoulder, elbow - shoulder)
    bends = np.einsum("...i,...i", higher, frames[..., 1, :3, 2])
    for index, name in enumerate(BRANCH_NAMES):
        side, bend, flip = name.split()
        assert np.all(ahead[:, index] > 0) == (side == "righty")
        # The elbow is up when it lies above the line from shoulder to wrist, seen from the arm's own side.
        up = bends[:, index] * np.sign(ahead[:, index])
        assert np.all(up > 0) == (bend == "up")
        assert np.all(joints[:, index, 4] <= 0) == (flip == "flip")


def test_jacobian_is_the_derivative_of_the_tool_pose(configurations: np.ndarray) -> None:
    h = 1e-6
    for q in configurations[:40]:
        numeric = np.zeros((6, 6))
        for joint in range(6):
            step = np.zeros(6)
            step[joint] = h
            high, low = tool_pose(q + step, ARM), tool_pose(q - step, ARM)
            numeric[:3, joint] = (high[:3, 3] - low[:3, 3]) / (2 * h)
            spin = (high[:3, :3] - low[:3, :3]) @ tool_pose(q, ARM)[:3, :3].T / (2 * h)
            numeric[3:, joint] = spin[2, 1], spin[0, 2], spin[1, 0]
        np.testing.assert_allclose(jacobian(q, ARM), numeric, atol=1e-8)


def test_a_pose_out_of_reach_says_by_how_much() -> None:
    too_far = 0.03
    height = LENGTHS.shoulder_height + LENGTHS.wrist_in_tool[2]
    at = np.hypot(LENGTHS.upper_arm + LENGTHS.forearm + too_far, LENGTHS.shoulder_offset)
    solutions = inverse_kinematics(downward_poses(np.array([[at, 0.0, height]]), 0.0), ARM)
    np.testing.assert_allclose(solutions.reach_excess, too_far, atol=1e-12)
    assert solutions.beyond_outer_reach[0]
    assert describe_reach(too_far, True, 0.41) == "wrist centre 3.0 cm outside the reach at s = 0.410 m"


def test_a_pose_at_the_arms_own_axis_is_too_near() -> None:
    solutions = inverse_kinematics(downward_poses(np.array([[0.05, 0.0, 0.9]]), 0.0), ARM)
    assert solutions.reach_excess[0, 0] == pytest.approx(LENGTHS.shoulder_offset - 0.05)
    assert not solutions.beyond_outer_reach[0]


def test_at_a_singular_wrist_joint_four_stays_where_it_was() -> None:
    q = np.array([0.3, 0.9, -2.0, 0.7, 0.0, 0.4])
    joints = inverse_kinematics(tool_pose(q, ARM)[None], ARM, previous_q4=0.7).joints[0]
    np.testing.assert_allclose(joints[0], q, atol=1e-9)
    assert min_singular_value(q, ARM) < 1e-9


def test_downward_tools_point_down_and_turn_about_the_vertical() -> None:
    for roll in np.linspace(-3, 3, 7):
        pose = downward_poses(np.array([0.1, 0.2, 0.3]), roll)
        np.testing.assert_allclose(pose[:3, 2], [0, 0, -1])
        np.testing.assert_allclose(np.linalg.det(pose[:3, :3]), 1.0)
        np.testing.assert_allclose(pose[:3, 0], [np.cos(roll), np.sin(roll), 0])
