import mujoco
import numpy as np
import pytest

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.motion.arm.poses import pose_matrix
from teachpath.motion.arm.serial_kinematics import serial_jacobian, serial_link_frames, serial_tool_pose
from teachpath.records import SerialArm

BASE = ((0.1, -0.2, 0.3), (0.5, 0.5, -0.5, 0.5))


@pytest.fixture(params=EXAMPLES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def arm(name: str) -> SerialArm:
    return read_arm(EXAMPLES[name])


def random_configurations(arm: SerialArm, count: int) -> np.ndarray:
    lower, upper = ([getattr(joint, side).value for joint in arm.joints] for side in ("lower", "upper"))
    return np.random.default_rng(6).uniform(lower, upper, (count, len(arm.joints)))


def test_forward_kinematics_agrees_with_mujoco(name: str, arm: SerialArm) -> None:
    spec = mujoco.MjSpec.from_file(str(EXAMPLES[name]))
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    tool = data.body("tool0") if name == "six-axis" else data.site("tool0")
    configurations = random_configurations(arm, 300)
    poses, frames = serial_tool_pose(configurations, arm), serial_link_frames(configurations, arm)
    for q, pose, links in zip(configurations, poses, frames, strict=True):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(pose[:3, 3], tool.xpos, atol=1e-12)
        np.testing.assert_allclose(pose[:3, :3].ravel(), tool.xmat, atol=1e-12)
        np.testing.assert_allclose(links[:, :3, 3], data.xpos[model.jnt_bodyid], atol=1e-12)


def test_the_jacobian_is_the_derivative_of_the_tools_pose(arm: SerialArm) -> None:
    step = 1e-6
    for q in random_configurations(arm, 20):
        jacobian = serial_jacobian(q, arm)
        for joint, along in enumerate(step * np.eye(len(q))):
            before, now, after = (serial_tool_pose(q + k * along, arm) for k in (-1, 0, 1))
            change = (after - before) / (2 * step)
            turning = change[:3, :3] @ now[:3, :3].T
            np.testing.assert_allclose(change[:3, 3], jacobian[:3, joint], atol=1e-8)
            np.testing.assert_allclose([turning[2, 1], turning[0, 2], turning[1, 0]], jacobian[3:, joint], atol=1e-8)


def test_a_base_moves_the_whole_arm(name: str, arm: SerialArm) -> None:
    q = random_configurations(arm, 5)
    moved = serial_tool_pose(q, read_arm(EXAMPLES[name], base=BASE))
    np.testing.assert_allclose(moved, pose_matrix(BASE) @ serial_tool_pose(q, arm), atol=1e-12)
