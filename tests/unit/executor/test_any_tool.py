"""A gripper off the axis of joint 6, and tilted: planned, certified, and executed with the simulated arm."""

from dataclasses import replace
from math import cos, sin

import numpy as np
import pytest
from scipy.spatial import cKDTree

from teachpath.errors import PathRefused
from teachpath.io.documents import decode, encode
from teachpath.motion.analysis.log_check import SetpointLog, check_log
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.plan_notes import arm_notes
from teachpath.motion.planning.signature import verify_signature
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan
from tests.unit.executor.executors import EPOCH, KEY, signed
from tests.unit.executor.played_setpoints import MovedBench
from tests.unit.motion.ways import MIDDLE, way

OFF_PATH = 3e-4  # m, of the arm itself
HALF = 0.2  # rad, half of the tilt
TILTED = MotionSettings(
    tool_position=(0.05, -0.04, 0.16), tool_orientation=(cos(HALF), 0.6 * sin(HALF), 0.8 * sin(HALF), 0.0)
)
ARM = Arm.of_settings(TILTED)


@pytest.fixture(scope="module")
def made() -> Plan:
    return signed(plan(way(MIDDLE), paper_scene(), TILTED), motion=TILTED)


def test_the_tool_points_down_along_the_whole_path(made: Plan) -> None:
    poses = tool_pose(made.joints, ARM)
    np.testing.assert_allclose(poses[:, :3, 2], np.tile([0.0, 0.0, -1.0], (len(poses), 1)), atol=1e-9)
    np.testing.assert_allclose(poses[[0, -1], :3, 3], way(MIDDLE).curve.control_points[[0, -1]], atol=1e-6)


def test_the_certificate_names_the_tool_and_holds_for_no_other(made: Plan) -> None:
    signature = made.certificate.signature
    assert signature is not None
    assert signature.tool == ARM.tool
    verify_signature(decode(Plan, encode(made)), ARM, TILTED, KEY, EPOCH)
    straight = MotionSettings()
    with pytest.raises(PathRefused, match=r"\(50, -40, 160\) mm from the flange, turned by 22.9183 deg.*130 mm"):
        verify_signature(made, Arm.of_settings(straight), straight, KEY, EPOCH)
    assert "a tool at (50, -40, 160) mm from the flange" in " ".join(arm_notes(ARM))
    moved = replace(TILTED, tool_position=(0.05, -0.04, 0.161))
    with pytest.raises(PathRefused, match="tool_position"):
        verify(made, Arm.of_settings(moved))


def test_the_simulated_arm_carries_the_object_along_the_path(made: Plan) -> None:
    bench = MovedBench(made, motion=TILTED)
    bench.run_whole(made)
    assert bench.states()[-1] == "ended"
    log = SetpointLog(
        np.array([s.cycle for s in bench.setpoints]) * 0.004, np.array([s.position for s in bench.setpoints])
    )
    assert check_log(log, way(MIDDLE).curve, ARM).faults == ()
    tools = cKDTree(tool_pose(np.array(bench.positions), ARM)[:, :3, 3])
    assert tools.query(way(MIDDLE).curve(np.linspace(0.0, 1.0, 500)))[0].max() <= 3 * OFF_PATH
    goal = way(MIDDLE).curve.control_points[-1]
    np.testing.assert_allclose(bench.object_positions[-1], goal, atol=2e-3)
