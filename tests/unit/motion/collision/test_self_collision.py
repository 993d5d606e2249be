from pathlib import Path

import mujoco
import numpy as np

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.motion.arm.geometry import visual_solids
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.mjcf import write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.arm.serial_kinematics import serial_link_frames
from teachpath.motion.arm.serial_mjcf import write_serial_mjcf
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.collision.self_collision import self_collision_pairs
from teachpath.motion.settings import MotionSettings
from tests.unit.io.arm_models.models import SEVEN_AXIS, changed


def test_every_pair_of_links_is_a_neighbour_or_decided() -> None:
    for name, file in EXAMPLES.items():
        arm = read_arm(file, name=name)
        pairs = self_collision_pairs(arm)
        every = {*pairs.neighbours, *pairs.overlapping, *pairs.meeting, *pairs.separate}
        count = len(arm.links) + 1
        assert every == {(a, b) for b in range(count) for a in range(b)}
        assert pairs.checked == tuple(sorted(set(pairs.meeting) | set(pairs.separate)))


def test_solids_that_always_overlap_are_not_checked(tmp_path: Path) -> None:
    large = changed(
        tmp_path, SEVEN_AXIS, ('fromto="0 0 -0.14 0 0 -0.06" size="0.06"', 'fromto="0 0 -0.3 0 0 -0.06" size="0.1"')
    )
    pairs = self_collision_pairs(read_arm(large))
    assert (1, 3) in pairs.overlapping
    assert (1, 3) not in pairs.checked


def test_bodies_of_the_written_model_have_the_frames_of_the_links() -> None:
    for file in EXAMPLES.values():
        arm = read_arm(file, base=((0.1, 0.2, 0.3), (0.5, 0.5, 0.5, 0.5)))
        model = mujoco.MjModel.from_xml_string(write_serial_mjcf(arm))
        data = mujoco.MjData(model)
        data.qpos[:] = np.linspace(-1.0, 1.0, len(arm.links))
        mujoco.mj_kinematics(model, data)
        for number, frame in enumerate(serial_link_frames(data.qpos, arm), start=1):
            body = data.body(f"link{number}")
            np.testing.assert_allclose(body.xpos, frame[:3, 3], atol=1e-12)
            np.testing.assert_allclose(body.xmat, frame[:3, :3].ravel(), atol=1e-12)
        for number, link in enumerate(arm.links, start=1):
            assert model.body(f"link{number}").mass[0] == link.mass


def test_what_is_drawn_is_where_what_collides_is() -> None:
    model = read_arm("six-axis", base=((0.1, 0.2, 0.3), (0.6, 0.0, 0.8, 0.0)), gripper_length=0.2)
    arm = Arm.of_model(model, MotionSettings())
    compiled = mujoco.MjModel.from_xml_string(write_mjcf(empty_scene(), arm))
    data, q = mujoco.MjData(compiled), np.linspace(-1.0, 1.0, 6)
    data.qpos[:] = q
    mujoco.mj_kinematics(compiled, data)
    frames = link_frames(q, arm)
    names = {compiled.geom(number).name for number in range(compiled.ngeom)}
    collide = [solid for solid in visual_solids(arm) if solid.name in names]
    assert {solid.name for solid in collide} == {name for name in names if name != "floor" and "obstacle" not in name}
    # What is drawn besides joins links: a model's shapes alone leave gaps at its joints.
    assert all(solid.name.startswith(("rod ", "ball ")) for solid in visual_solids(arm) if solid not in collide)
    for solid in collide:
        frame, geom = frames[solid.link], data.geom(solid.name)
        np.testing.assert_allclose(frame[:3, :3] @ solid.position + frame[:3, 3], geom.xpos, atol=1e-12)
        turn = frame[:3, :3] @ rotation_matrices(np.array([solid.orientation]))[0]
        np.testing.assert_allclose(turn, geom.xmat.reshape(3, 3), atol=1e-8)
