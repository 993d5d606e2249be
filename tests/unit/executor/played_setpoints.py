"""Executors whose setpoints come late, doubled or not at all to an arm that plays them, in a time of their own."""

from collections.abc import Callable

import numpy as np

from teachpath.io import wire
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.records import JointState, Plan, Setpoint
from teachpath.simulator.arm import SimulatedArm
from teachpath.simulator.settings import SimulatorSettings
from teachpath_client.driver import PlayerState, SetpointPlayer
from tests.unit.executor.executors import EPOCH, KEYS, MOTION, Bench

ARM = Arm.of_variant()
DELAY = 0.03
STEP_NS = 1_000_000
Arrivals = Callable[[int], list[float]]  # of a cycle: after how many seconds each of its copies comes


def at_once(cycle: int) -> list[float]:
    return [0.0]


class PlayedBench(Bench):
    """An executor whose setpoints come late, doubled or not at all to an arm that plays them.

    While it oversleeps it hears nothing, as a process that was stopped.
    """

    def __init__(
        self, arrivals: Arrivals = at_once, motion: MotionSettings | None = None, arm: Arm | None = None
    ) -> None:
        super().__init__(motion=motion, arm=arm)
        self._arrivals = arrivals
        self._coming: list[tuple[float, int, Setpoint]] = []
        self._heard = 0
        self._hears = True
        self.player = SetpointPlayer(np.array((motion or MOTION).home), delay=DELAY)
        self.played: list[np.ndarray] = []

    def sleep(self, duration: float) -> None:
        overslept = self.oversleep.pop(len(self.setpoints), 0)
        end, self._hears = self.now + round(duration * 1e9) + overslept, not overslept
        assert end < 60e9, f"stuck before step {self.todo[:1]} in {self.statuses[-1]}"
        while self.now < end:
            self.now += min(STEP_NS, end - self.now)
            self._play_on()
        if self.todo and self.todo[0][0]():
            self.todo.pop(0)[1]()

    def _play_on(self) -> None:
        for setpoint in self.setpoints[self._heard :]:
            self._coming += [
                (self.now + 1e9 * late, setpoint.cycle, setpoint) for late in self._arrivals(setpoint.cycle)
            ]
        self._heard = len(self.setpoints)
        due = [one for one in self._coming if one[0] <= self.now]
        self._coming = [one for one in self._coming if one[0] > self.now]
        for _, _, setpoint in sorted(due, key=lambda one: one[:2]):
            self.player.add(setpoint, EPOCH + self.now)
        self.player.advance(STEP_NS / 1e9, EPOCH + self.now)
        self.played.append(self.player.target.position)
        if self._hears:
            self.bus.publish(KEYS.state("puma560"), wire.encode_state(self.joint_state()))

    def joint_state(self) -> JointState:
        player, newest = self.player, self.player.last_reached
        return JointState(
            stamp_ns=EPOCH + self.now,
            cycle=newest.cycle if newest else 0,
            position=player.target.position,
            velocity=player.target.velocity,
            torque=np.zeros(len(player.target.position)),
            tracking_error=0.0,
            missed=player.missed,
            holding=player.state in (PlayerState.STOPPING, PlayerState.STOPPED),
            gripper_closed=bool(newest and newest.gripper_closed),
            object_position=(0.0, 0.0, 0.0),
            object_orientation=(1.0, 0.0, 0.0, 0.0),
            execution=newest.execution if newest else "",
            stopped=player.state is PlayerState.STOPPED,
        )

    def run_whole(self, plan: Plan) -> np.ndarray:
        """Run a plan to its end; returns what was played (n, 6), one row a millisecond [rad]."""
        self.start(plan)
        self.when(lambda: self.state == "ended" and self.player.at_rest, self.stop.set)
        self.run()
        return np.array(self.played)


class MovedBench(PlayedBench):
    """An executor whose setpoints move the simulated arm, one step a millisecond."""

    def __init__(
        self,
        plan: Plan,
        arrivals: Arrivals = at_once,
        motion: MotionSettings | None = None,
        arm: Arm | None = None,
    ) -> None:
        super().__init__(arrivals, motion, arm)
        motion = motion or MOTION
        self._arm = SimulatedArm(plan.scene, arm or Arm.of_settings(motion), SimulatorSettings(), motion.home)
        self._closed = False
        self._empty_handed = plan.scene.carried is None
        self.positions: list[np.ndarray] = []
        self.velocities: list[np.ndarray] = []
        self.torques: list[np.ndarray] = []
        self.object_positions: list[np.ndarray] = []

    def _play_on(self) -> None:
        super()._play_on()
        target, reached = self.player.target, self.player.last_reached
        closed = reached is not None and reached.gripper_closed
        if closed and not self._closed:
            assert self._arm.grasp() or self._empty_handed
        elif self._closed and not closed:
            self._arm.release()
        self._closed = closed
        self._arm.step(target.position, target.velocity, target.acceleration)
        self.positions.append(self._arm.position)
        self.velocities.append(self._arm.velocity)
        self.torques.append(self._arm.torque)
        self.object_positions.append(np.array(self._arm.object_pose[0]))


def off_path(played: np.ndarray, path: np.ndarray, arm: Arm = ARM) -> float:
    """The largest distance of the tool from the way [m], seen as chords."""
    chords, worst = np.diff(path, axis=0), 0.0
    for tool in tool_pose(played[::10], arm)[:, :3, 3]:
        ahead = tool - path[:-1]
        share = np.einsum("ij,ij->i", ahead, chords) / np.maximum(np.sum(chords**2, axis=1), 1e-24)
        distance = np.linalg.norm(ahead - np.clip(share, 0.0, 1.0)[:, None] * chords, axis=1)
        worst = max(worst, float(distance.min()))
    return worst


def largest_uses(played: np.ndarray, arm: Arm = ARM) -> list[float]:
    """The largest use of speed, acceleration and jerk limits by differences at the setpoints' period."""
    rows = played[::4]
    limits = ((1, arm.limits.speed), (2, arm.limits.acceleration), (3, arm.limits.jerk))
    return [float((np.abs(np.diff(rows, k, axis=0)) * 250.0**k / limit).max()) for k, limit in limits]
