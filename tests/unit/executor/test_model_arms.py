"""An arm from a user's model: the executor moves it and the simulated arm follows, in a time of their own."""

import re
from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.documents import encode
from teachpath.motion.analysis.log_check import SetpointLog, check_log
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import TOOL_LENGTH
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.planning.model_arms import with_home
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.signature import sign_plan, verify_signature
from teachpath.motion.settings import MotionSettings
from teachpath.records import Calibration, LearnedPath, Plan, Scene, TeleopRequest
from tests.unit.executor.executors import EPOCH, KEY, MOTION, Bench
from tests.unit.executor.played_setpoints import MovedBench, largest_uses
from tests.unit.motion.ways import MIDDLE, clamped, learned, way

BASE = ((0.0, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))  # at the table's edge, as high as its top
MAX_ERROR = 3e-4  # [m] of the simulated tool
SHORT_PATH = learned(clamped(np.array([[0.45, -0.1, 0.65], [0.5, -0.05, 0.7], [0.5, 0.05, 0.7], [0.45, 0.1, 0.65]])))


def light(gripper_length: float = 0.0, example: str = "six-axis") -> tuple[Arm, MotionSettings]:
    model = read_arm(example, name="light", base=BASE, gripper_length=gripper_length)
    motion = replace(MOTION, arm="light")
    arm = Arm.of_model(model, motion)
    return arm, with_home(motion, arm)


def planned(path: LearnedPath, scene: Scene, arm: Arm, motion: MotionSettings) -> Plan:
    return sign_plan(plan(path, scene, motion, arm=arm), arm, motion, KEY, issued_ns=EPOCH)


@pytest.fixture(scope="module")
def carrying() -> Plan:
    return planned(way(MIDDLE), paper_scene(), *light(TOOL_LENGTH))


def check_motion(bench: MovedBench, arm: Arm, path: LearnedPath) -> None:
    """Check limits by differences, the path of the setpoints, and how near to them the simulated arm is."""
    assert bench.states() == ["idle", "approaching", "following", "ended"]
    sent = np.array([setpoint.position for setpoint in bench.setpoints])
    assert max(largest_uses(np.repeat(sent, 4, axis=0), arm)) <= 1.0 + 1e-6
    assert bench.statuses[-1].limit_use <= 1.0 + 1e-6
    log = SetpointLog(np.arange(len(sent)) / 250.0, sent, np.array([s.on_path for s in bench.setpoints]))
    assert check_log(log, path.curve, arm).faults == ()
    # A step ends a millisecond behind the target that it followed.
    is_at, should = (tool_pose(np.array(q), arm)[:, :3, 3] for q in (bench.positions[:-1], bench.played[1:]))
    off = float(np.linalg.norm(is_at - should, axis=1).max())
    assert off <= MAX_ERROR
    assert np.all(np.abs(bench.torques) <= arm.limits.torque)


def test_it_carries_an_object_with_the_gripper_on_its_flange(carrying: Plan) -> None:
    arm, motion = light(TOOL_LENGTH)
    bench = MovedBench(carrying, motion=motion, arm=arm)
    bench.run_whole(carrying)
    check_motion(bench, arm, way(MIDDLE))
    goal = way(MIDDLE).curve(np.ones(1))[0]
    np.testing.assert_allclose(bench.object_positions[-1], goal, atol=2e-3)


@pytest.mark.parametrize("example", ["six-axis", "seven-axis"])
def test_without_a_gripper_its_tool_follows_the_path(example: str) -> None:
    arm, motion = light(example=example)
    moved = planned(SHORT_PATH, empty_scene(), arm, motion)
    bench = MovedBench(moved, motion=motion, arm=arm)
    bench.run_whole(moved)
    check_motion(bench, arm, SHORT_PATH)


def test_the_driver_of_an_arm_with_other_joints_is_not_heard(caplog: pytest.LogCaptureFixture) -> None:
    arm, motion = light(example="seven-axis")
    bench = Bench(motion=motion, arm=arm, position=np.zeros(6))
    bench.when(lambda: bench.now > 0, bench.stop.set)
    bench.run()
    assert "a joint state has 6 joints, and this station's arm 7: is it the driver of another arm?" in caplog.text


def test_a_plan_is_of_one_version_of_an_arm(carrying: Plan) -> None:
    arm, motion = light(TOOL_LENGTH)
    signature = carrying.certificate.signature
    assert signature is not None
    assert signature.arm == arm.identity
    bare, _ = light()
    refusal = rf"holds for the {re.escape(arm.identity)} .* and this arm is the {re.escape(bare.identity)}"
    with pytest.raises(PathRefused, match=refusal):
        verify_signature(carrying, bare, motion, KEY, EPOCH)


def test_a_hand_does_not_lead_it_out_of_a_singular_pose() -> None:
    arm, motion = light()  # which waits stretched up
    bench = Bench(motion=motion, arm=arm, position=np.array(motion.home))
    request = encode(TeleopRequest("glove", Calibration("identity"), "empty"))
    refused = []

    def order() -> None:
        with pytest.raises(PathRefused, match=r"light rests in a singular pose .* say another home"):
            bench.command("teleoperate", teleop=request)
        refused.append(True)
        bench.stop.set()

    bench.when(lambda: bench.now > 0, order)
    bench.run()
    assert refused
