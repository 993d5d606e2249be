"""The gripper mirrors a live hand: it takes the object, keeps it through the clutch, and puts it down."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.executor.teleop.gripper import GripperFollower
from teachpath.motion.arm.kinematics import downward_poses, inverse_kinematics, tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.records import Calibration, JointState, TeleopRequest
from tests.unit.executor.executors import within_limits
from tests.unit.executor.teleop.hand_bench import CLUTCH, Held
from tests.unit.recording.hands import CLOSED_HAND, OPEN_HAND, sample

ARM = Arm.of_variant()

SCENE = paper_scene()
BLOCK = np.array(SCENE.carried.position) if SCENE.carried else np.zeros(3)
REACH = 0.03


def above(height: float) -> np.ndarray:
    """A configuration within its limits with the tool straight down over the block."""
    q = inverse_kinematics(downward_poses((BLOCK + height * np.eye(3)[2])[None], np.pi), ARM).joints[0, 1]
    return np.where(q < ARM.limits.lower, q + 2 * np.pi, np.where(q > ARM.limits.upper, q - 2 * np.pi, q))


class Picking(Held):
    """A bench whose arm carries the block as the simulated one does."""

    def __init__(self) -> None:
        super().__init__()
        self.position = above(0.07)
        self.block = BLOCK.copy()
        self.carried: np.ndarray | None = None  # the block, seen from the tool

    def joint_state(self) -> JointState:
        state, tool = super().joint_state(), tool_pose(self.position, ARM)
        if state.gripper_closed and self.carried is None and np.linalg.norm(self.block - tool[:3, 3]) < REACH:
            self.carried = self.block - tool[:3, 3]
        elif not state.gripper_closed:
            self.carried = None
        if self.carried is not None:
            self.block = tool[:3, 3] + self.carried
        x, y, z = self.block.tolist()
        return replace(state, object_position=(x, y, z))

    def go(self, *by: float, buttons: int = CLUTCH, seconds: float = 0.8) -> None:
        """Move the hand that far and wait until the arm is there."""

        def move() -> None:
            self.hand, self.buttons = self.hand + np.array(by), buttons

        self.when(lambda: True, move)
        self.after(seconds)


def test_the_block_is_taken_carried_through_the_clutch_and_put_down() -> None:
    bench, seen = Picking(), dict[str, np.ndarray]()

    def see(name: str) -> None:
        bench.when(lambda: True, lambda: seen.update({name: bench.block.copy()}))

    bench.teleoperate(TeleopRequest("glove", Calibration("identity"), SCENE.name))
    bench.when(lambda: bench.state == "following", lambda: None)
    bench.go(0.0, 0.0, -0.06)
    bench.go(0.0, 0.0, 0.0, buttons=CLUTCH | 1, seconds=0.3)
    bench.go(0.0, 0.0, 0.1, buttons=CLUTCH | 1)
    see("lifted")
    bench.go(0.0, 0.0, -0.3, buttons=0, seconds=0.5)  # nothing moves, nothing falls
    see("clutch let go")
    bench.go(0.0, 0.0, 0.0, seconds=0.3)
    bench.go(0.0, 0.06, 0.0)
    see("carried on")
    bench.go(0.0, 0.0, -0.25, seconds=1.0)
    see("pressed down")
    bench.when(lambda: True, lambda: seen.update({"why": np.array(bench.statuses[-1].activity)}))
    bench.go(0.0, 0.0, 0.0, buttons=CLUTCH | 1, seconds=0.2)
    bench.go(0.0, 0.0, 0.0, seconds=0.2)
    bench.go(0.0, 0.0, 0.25)
    see("put down")
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    np.testing.assert_allclose(seen["lifted"] - BLOCK, [0, 0, 0.1], atol=2e-3)
    np.testing.assert_allclose(seen["clutch let go"], seen["lifted"], atol=1e-9)
    np.testing.assert_allclose(seen["carried on"] - seen["lifted"], [0, 0.06, 0], atol=2e-3)
    assert -0.003 <= (seen["pressed down"] - BLOCK)[2] < 0.02
    assert "move the hand back" in str(seen["why"])
    np.testing.assert_allclose(seen["put down"], seen["pressed down"], atol=1e-9)
    assert tool_pose(bench.position, ARM)[2, 3] > seen["put down"][2] + 0.1
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize("closed", [False, True])
def test_only_a_change_of_the_hand_moves_the_gripper(closed: bool) -> None:
    grip = GripperFollower(closed)
    grip.engage(sample(1, (0.0, 0.0, 0.0), OPEN_HAND if closed else CLOSED_HAND))
    grip.follow(sample(2, (0.0, 0.0, 0.0), OPEN_HAND if closed else CLOSED_HAND))
    assert grip.closed == closed
    grip.follow(sample(3, (0.0, 0.0, 0.0), (0.5,) * 22))
    assert grip.closed == closed
    grip.follow(sample(4, (0.0, 0.0, 0.0), CLOSED_HAND if closed else OPEN_HAND))
    grip.follow(sample(5, (0.0, 0.0, 0.0), OPEN_HAND if closed else CLOSED_HAND))
    assert grip.closed != closed
