from dataclasses import fields
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from teachpath.motion.drawing import drawing
from teachpath.motion.mjcf import mjcf, physical_inertia
from teachpath.motion.puma560 import ACCELERATION, LINKS, LOWER, SOURCES, SPEED, TORQUE, UPPER, Link
from teachpath.motion.scenes import paper_scene, scenes


@pytest.fixture
def bare() -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The arm with exactly the published masses and without our gripper."""
    model = mujoco.MjModel.from_xml_string(mjcf(paper_scene()))
    model.body_mass[model.body("gripper").id] = 0.0
    model.body_inertia[model.body("gripper").id] = 0.0
    for number, link in enumerate(LINKS, start=1):
        model.body_mass[model.body(f"link{number}").id] = link.mass
        model.body_inertia[model.body(f"link{number}").id] = link.inertia
    return model, mujoco.MjData(model)


def test_every_column_names_its_source() -> None:
    assert set(SOURCES) == {field.name for field in fields(Link)}


def test_gravity_load_is_the_published_one(bare: tuple[mujoco.MjModel, mujoco.MjData]) -> None:
    # P. Corke, Robotics, Vision and Control, 2nd ed., Springer 2017, section 9.1: gravload at the nominal pose.
    model, data = bare
    data.qpos[:6] = [0, np.pi / 4, np.pi, 0, np.pi / 4, 0]
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qfrc_bias[:6], [0, 31.6399, 6.0351, 0, 0.0283, 0], atol=5.1e-5)


def test_inertia_matrix_is_the_published_one(bare: tuple[mujoco.MjModel, mujoco.MjData]) -> None:
    # The same book, section 9.2: the diagonal with motors and its largest off-diagonal elements, nominal pose.
    model, data = bare
    data.qpos[:6] = [0, np.pi / 4, np.pi, 0, np.pi / 4, 0]
    mujoco.mj_forward(model, data)
    columns = []
    for joint in range(6):
        unit, column = np.zeros(model.nv), np.zeros(model.nv)
        unit[joint] = 1.0
        mujoco.mj_mulM(model, data, column, unit)
        columns.append(column[:6])
    matrix = np.array(columns)
    np.testing.assert_allclose(np.diag(matrix), [3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941], atol=5.1e-5)
    np.testing.assert_allclose(matrix[0, 1:3], [-0.4044, 0.1006], atol=5.1e-5)
    np.testing.assert_allclose(matrix[1, 2], 0.3509, atol=5.1e-5)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)


def test_the_simulated_inertia_differs_only_where_no_body_can_have_the_published_one() -> None:
    for link in LINKS:
        moments = physical_inertia(link)
        assert 2 * moments.max() <= moments.sum()
        published = np.array(link.inertia)
        if link.mass and 2 * published.max() <= published.sum():
            np.testing.assert_array_equal(moments, published)


def test_the_acceleration_box_keeps_every_torque_at_full_speed() -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(scenes()["empty"]))
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT  # neither contacts nor joint stops
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    worst = np.zeros(6)
    for _ in range(300):
        data.qpos[:6] = rng.uniform(LOWER, UPPER)
        data.qvel[:6] = SPEED * rng.choice([-1.0, 1.0], 6)
        data.qacc[:6] = ACCELERATION * rng.choice([-1.0, 1.0], 6)
        wanted = data.qacc[:6].copy()
        mujoco.mj_forward(model, data)
        data.qacc[:6] = wanted
        mujoco.mj_inverse(model, data)
        worst = np.maximum(worst, np.abs(data.qfrc_inverse[:6]) / TORQUE)
    assert worst.max() <= 1.0


def test_every_part_is_a_geom_of_its_link() -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(paper_scene()))
    for part in drawing():
        assert model.geom_bodyid[model.geom(part.name).id] == (model.body(f"link{part.link}").id if part.link else 0)
    assert len({part.name for part in drawing()}) == len(drawing())


def test_motors_are_limited_to_the_published_torques() -> None:
    model = mujoco.MjModel.from_xml_string(mjcf(paper_scene()))
    np.testing.assert_allclose(model.actuator_ctrlrange, np.column_stack([-TORQUE, TORQUE]))
    np.testing.assert_allclose(model.jnt_range[:6], np.column_stack([LOWER, UPPER]))


def test_the_parts_join_into_one_arm_in_every_configuration() -> None:
    chain = ["foot", "pedestal", "trunk", "shoulder", "upper arm", "forearm", "wrist roll", "wrist yoke", "wrist"]
    chain += ["flange", "palm", "left finger"]
    model = mujoco.MjModel.from_xml_string(mjcf(paper_scene()))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(4)
    for _ in range(20):
        data.qpos[:6] = rng.uniform(LOWER, UPPER)
        mujoco.mj_kinematics(model, data)
        for one, other in pairwise(chain):
            gap = mujoco.mj_geomDistance(model, data, model.geom(one).id, model.geom(other).id, 1.0, None)
            assert gap < 0.006, (one, other)
