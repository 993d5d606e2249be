"""Kinematics and dynamics against published numbers, and against an arm of another construction."""

from collections.abc import Sequence

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.kinematics import inverse_kinematics, jacobian, link_frames, tool_pose
from teachpath.motion.arm.mjcf import physical_inertia, write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import (
    GRIPPER_COM,
    GRIPPER_INERTIA,
    GRIPPER_MASS,
    VARIANTS,
)
from teachpath.motion.collision.builtin_scenes import empty_scene
from tests.unit.motion.arm.screws import Body, Screws

ARM = Arm.of_variant()
NOMINAL = np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])  # `qn` of the toolbox
UNIT_VECTOR, NO_LOAD = np.ones(6), np.zeros(6)
# Printed with four decimals, and taken from ones with four more.
PRINTED_TOLERANCE = 5.1e-5

every_arm = pytest.mark.parametrize("arm", [Arm.of_variant(name) for name in VARIANTS], ids=list(VARIANTS))


class Bare:
    """The arm in MuJoCo with exactly the published masses, without our gripper, contacts and joint stops."""

    def __init__(self) -> None:
        self.model = model = mujoco.MjModel.from_xml_string(write_mjcf(empty_scene(), ARM))
        for number, link in enumerate(ARM.links, start=1):
            model.body_mass[model.body(f"link{number}").id] = link.mass
            model.body_inertia[model.body(f"link{number}").id] = link.inertia
        model.body_mass[model.body("gripper").id] = 0.0
        model.body_inertia[model.body("gripper").id] = 0.0
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.data = mujoco.MjData(model)

    def torques(
        self, q: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, gravity: float = 9.81
    ) -> np.ndarray:
        """Inverse dynamics with viscous friction, and Coulomb's for turning forward as the toolbox has it."""
        self.model.opt.gravity[2] = -gravity
        self.data.qpos[:], self.data.qvel[:], self.data.qacc[:] = q, velocity, acceleration
        mujoco.mj_inverse(self.model, self.data)
        coulomb = np.array([abs(link.gear) * link.coulomb[0] for link in ARM.links])
        return np.array(self.data.qfrc_inverse) + coulomb * (velocity > 0)


# P. Corke, J. Haviland: Robotics Toolbox for Python, its tests of rne, which were made with the one for MATLAB.
@pytest.mark.parametrize(
    ("velocity", "acceleration", "gravity", "published"),
    [
        (NO_LOAD, NO_LOAD, 9.81, [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0]),
        (NO_LOAD, UNIT_VECTOR, 9.81, [3.35311, 36.0025, 7.42596, 0.190043, 0.203441, 0.194133]),
        (UNIT_VECTOR, UNIT_VECTOR, 9.81, [32.4952, 60.867, 17.7436, 1.45452, 1.29911, 0.713781]),
        (UNIT_VECTOR, NO_LOAD, 9.81, [29.1421, 56.5044, 16.3528, 1.26448, 1.12392, 0.519648]),
        (UNIT_VECTOR, UNIT_VECTOR, 0.0, [32.4952, 29.2271, 11.7085, 1.45452, 1.27086, 0.713781]),
        (NO_LOAD, np.array([1.0, 2, 3, 1, 2, 3]), 0.0, [3.1500, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823]),
    ],
)
def test_inverse_dynamics_is_the_published_one(
    velocity: np.ndarray, acceleration: np.ndarray, gravity: float, published: Sequence[float]
) -> None:
    torques = Bare().torques(NOMINAL, velocity, acceleration, gravity)
    np.testing.assert_allclose(torques, published, atol=1e-4)


def test_inertia_matrix_is_the_published_one() -> None:
    # P. Corke: Robotics, Vision and Control, 2nd ed., Springer 2017, section 9.2, with the motors.
    bare = Bare()
    columns = [bare.torques(NOMINAL, NO_LOAD, unit, 0.0) for unit in np.eye(6)]
    published = np.diag([3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941])
    for row, column, value in ((0, 1, -0.4044), (0, 2, 0.1006), (0, 3, -0.0025), (1, 2, 0.3509), (1, 4, 0.0024)):
        published[row, column] = published[column, row] = value
    published[2, 4] = published[4, 2] = 0.0015
    np.testing.assert_allclose(columns, published, atol=PRINTED_TOLERANCE)


def test_gravity_load_elsewhere_is_the_published_one() -> None:
    # P. Corke: Robotics Toolbox for MATLAB, gravload([1 2 3 4 5 6]).
    torques = Bare().torques(np.arange(1.0, 7.0), NO_LOAD, NO_LOAD)
    np.testing.assert_allclose(torques, [0.0, -7.9683, 8.4581, -0.0197, 0.0027, 0.0], atol=PRINTED_TOLERANCE)


def test_pose_and_jacobian_are_the_published_ones() -> None:
    # The same book, section 7.2: the wrist centre from the shoulder; the toolbox's tests: manipulabilities.
    frame = link_frames(NOMINAL, ARM)[6]
    wrist = frame[:3, 3] - ARM.links[5].d * frame[:3, 2] - [0.0, 0.0, ARM.links[0].d]
    np.testing.assert_allclose(wrist, [0.5963, -0.1501, -0.01435], atol=PRINTED_TOLERANCE)
    np.testing.assert_allclose(frame[:3, :3], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-12)
    at_tool = jacobian(NOMINAL, ARM)
    hand = (ARM.links[5].d + ARM.tool_length) * frame[:3, 2]
    at_wrist = at_tool[:3] - np.cross(at_tool[3:].T, hand).T
    volumes = [np.sqrt(np.linalg.det(j @ j.T)) for j in (at_tool, at_wrist, at_tool[3:])]
    np.testing.assert_allclose(volumes, [0.0786, 0.111181, 2.44949], atol=PRINTED_TOLERANCE)


@pytest.fixture(scope="module")
def configurations() -> np.ndarray:
    return np.random.default_rng(1994).uniform(ARM.limits.lower, ARM.limits.upper, (100, 6))


def screws_of(arm: Arm) -> Screws:
    rows = arm.links
    return Screws(
        height=rows[0].d,
        upper=rows[1].a,
        offset=rows[2].d,
        elbow=rows[2].a,
        forearm=rows[3].d,
        hand=rows[5].d + arm.tool_length,
    )


@every_arm
def test_pose_and_jacobian_are_those_of_the_screws(arm: Arm, configurations: np.ndarray) -> None:
    other = screws_of(arm)
    for q in configurations[:40]:
        np.testing.assert_allclose(tool_pose(q, arm), other.tool_pose(q), atol=1e-12)
        np.testing.assert_allclose(jacobian(q, arm), other.jacobian(q), atol=1e-12)


@every_arm
def test_inverse_dynamics_is_that_of_the_screws(arm: Arm, configurations: np.ndarray) -> None:
    model = mujoco.MjModel.from_xml_string(write_mjcf(empty_scene(), arm))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, other = mujoco.MjData(model), screws_of(arm)
    bodies, zero = [], link_frames(NO_LOAD, arm)
    for number, link in enumerate(arm.links, start=1):
        solids = [(max(link.mass, 1e-3), link.com, physical_inertia(link))]
        if number == 6:
            solids.append((GRIPPER_MASS, GRIPPER_COM, np.array(GRIPPER_INERTIA)))
        for mass, com, moments in solids:
            turn = zero[number, :3, :3]
            bodies.append(Body(number, mass, turn @ com + zero[number, :3, 3], turn @ np.diag(moments) @ turn.T))
    armature = np.array([link.motor_inertia * link.gear**2 for link in arm.links])
    viscous = np.array([link.viscous * link.gear**2 for link in arm.links])
    rng = np.random.default_rng(7)
    for q in configurations[:30]:
        velocity, acceleration = rng.uniform(-3, 3, 6), rng.uniform(-20, 20, 6)
        data.qpos[:], data.qvel[:], data.qacc[:] = q, velocity, acceleration
        mujoco.mj_inverse(model, data)
        torques = other.torques(q, velocity, acceleration, bodies, armature) + viscous * velocity
        np.testing.assert_allclose(data.qfrc_inverse, torques, atol=1e-9)


def test_the_eight_branches_are_all_that_there_are() -> None:
    """Newton's method on the screws, from anywhere, finds nothing that the closed form has not."""
    other, rng = screws_of(ARM), np.random.default_rng(8)
    pose = tool_pose(np.array([0.4, 0.7, -2.2, 0.9, 1.1, -0.5]), ARM)
    known, found = inverse_kinematics(pose[None], ARM).joints[0], set()
    for _ in range(100):
        answer = _newton(other, pose, rng.uniform(-np.pi, np.pi, 6))
        if answer is not None:
            distance = np.abs(np.exp(1j * known) - np.exp(1j * answer)).max(axis=1)
            assert distance.min() < 1e-8
            found.add(int(distance.argmin()))
    assert found == set(range(8))


def _newton(arm: Screws, pose: np.ndarray, q: np.ndarray) -> np.ndarray | None:
    """Return joints that bring the tool to a pose, or None where it gets stuck on its way from `q`."""
    for _ in range(30):
        here = arm.tool_pose(q)
        turn = Rotation.from_matrix(pose[:3, :3] @ here[:3, :3].T).as_rotvec()
        off = np.concatenate([pose[:3, 3] - here[:3, 3], turn])
        if np.abs(off).max() < 1e-12:
            return q
        step = np.linalg.lstsq(arm.jacobian(q), off)[0]
        q = q + step * min(1.0, 0.5 / np.abs(step).max())
    return None
