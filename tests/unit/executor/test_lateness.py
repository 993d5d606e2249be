"""Executor and player together, in a time of their own: whatever comes late, the arm stays on its path and goes on."""

from collections.abc import Callable

import numpy as np
import pytest

from teachpath.io import wire
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.records import JointState, Plan, Setpoint
from teachpath_client.driver import PlayerState, SetpointPlayer
from tests.unit.executor.executors import EPOCH, HOME, KEYS, Bench

ARM = Arm.of_variant()
DELAY = 0.03
OFF_PATH = 1e-5  # m
ROUNDING = 1.0 + 1e-6
BETWEEN = 1.1  # use of the jerk limit by differences between setpoints, where the player interpolates
STEP_NS = 1_000_000
Arrivals = Callable[[int], list[float]]  # of a cycle: after how many seconds each of its copies comes


def at_once(cycle: int) -> list[float]:
    return [0.0]


class PlayedBench(Bench):
    """An executor whose setpoints come late, doubled or not at all to an arm that plays them."""

    def __init__(self, arrivals: Arrivals = at_once) -> None:
        super().__init__()
        self._arrivals = arrivals
        self._coming: list[tuple[float, int, Setpoint]] = []
        self._heard = 0
        self.player = SetpointPlayer(HOME, delay=DELAY)
        self.played: list[np.ndarray] = []

    def sleep(self, duration: float) -> None:
        end = self.now + round(duration * 1e9) + self.oversleep.pop(len(self.setpoints), 0)
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
        self.bus.publish(KEYS.state("puma560"), wire.encode_state(self.joint_state()))

    def joint_state(self) -> JointState:
        player, newest = self.player, self.player.last_reached
        return JointState(
            stamp_ns=EPOCH + self.now,
            cycle=newest.cycle if newest else 0,
            position=player.target.position,
            velocity=player.target.velocity,
            torque=np.zeros(6),
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


@pytest.fixture(scope="module")
def path(middle: Plan) -> np.ndarray:
    """The tool's way (n, 3) when nothing is late [m]."""
    return tool_pose(PlayedBench().run_whole(middle), ARM)[:, :3, 3]


def off_path(played: np.ndarray, path: np.ndarray) -> float:
    """The largest distance of the tool from the way [m], seen as chords."""
    chords, worst = np.diff(path, axis=0), 0.0
    for tool in tool_pose(played[::10], ARM)[:, :3, 3]:
        ahead = tool - path[:-1]
        share = np.einsum("ij,ij->i", ahead, chords) / np.maximum(np.sum(chords**2, axis=1), 1e-24)
        distance = np.linalg.norm(ahead - np.clip(share, 0.0, 1.0)[:, None] * chords, axis=1)
        worst = max(worst, float(distance.min()))
    return worst


def largest_uses(played: np.ndarray) -> list[float]:
    """The largest use of speed, acceleration and jerk limits by differences at the setpoints' period."""
    rows = played[::4]
    limits = ((1, ARM.limits.speed), (2, ARM.limits.acceleration), (3, ARM.limits.jerk))
    return [float((np.abs(np.diff(rows, k, axis=0)) * 250.0**k / limit).max()) for k, limit in limits]


def is_within_limits(played: np.ndarray) -> bool:
    speed, acceleration, jerk = largest_uses(played)
    return max(speed, acceleration) <= ROUNDING and jerk <= BETWEEN


def test_undisturbed_the_player_adds_nothing(middle: Plan, path: np.ndarray) -> None:
    bench = PlayedBench()
    played = bench.run_whole(middle)
    assert off_path(played, path) <= OFF_PATH
    assert is_within_limits(played), largest_uses(played)
    assert (bench.player.stops, bench.player.late, bench.player.missed) == (0, 0, 0)


@pytest.mark.parametrize("seed", range(12))
def test_an_executor_that_oversleeps_stays_on_the_path_and_goes_on(middle: Plan, path: np.ndarray, seed: int) -> None:
    rng = np.random.default_rng(seed)
    bench = PlayedBench()
    bench.oversleep = {
        int(k): int(1e9 * s) for k, s in zip(rng.integers(10, 1100, 8), rng.uniform(0.02, 0.5, 8), strict=True)
    }
    played = bench.run_whole(middle)
    assert off_path(played, path) <= OFF_PATH
    assert is_within_limits(played), largest_uses(played)
    np.testing.assert_allclose(tool_pose(played[-1:], ARM)[0, :3, 3], path[-1], atol=1e-9)
    assert not any(status.state == "faulted" for status in bench.statuses)


@pytest.mark.parametrize("seed", range(4))
def test_setpoints_that_are_lost_doubled_or_late_leave_the_arm_on_its_path(
    middle: Plan, path: np.ndarray, seed: int
) -> None:
    rng = np.random.default_rng(seed)

    def arrivals(cycle: int) -> list[float]:
        if rng.random() < 0.05:
            return []
        late = [float(rng.uniform(0.0, 0.012))] if rng.random() < 0.95 else [float(rng.uniform(0.05, 0.3))]
        return late + ([late[0] + 0.01] if rng.random() < 0.1 else [])

    bench = PlayedBench(arrivals)
    played = bench.run_whole(middle)
    assert off_path(played, path) <= OFF_PATH
    assert is_within_limits(played), largest_uses(played)
    assert bench.player.missed > 0


def played_until_gone(plan: Plan, gone: int) -> np.ndarray:
    """Play setpoints until one; none that is later is ever heard."""
    bench = PlayedBench(lambda cycle: [0.0] if cycle < gone else [])
    bench.start(plan)
    bench.when(lambda: len(bench.setpoints) >= gone, lambda: None)
    until: list[int] = []
    bench.when(lambda: until.append(bench.now) or bench.player.at_rest, lambda: None)
    bench.when(lambda: bench.now > until[-1] + 10**9, bench.stop.set)
    bench.run()
    return np.array(bench.played)


def test_an_executor_that_is_gone_leaves_the_arm_at_rest_on_its_path(middle: Plan, path: np.ndarray) -> None:
    for gone in np.random.default_rng(5).integers(10, 1100, 10):
        played = played_until_gone(middle, int(gone))
        assert off_path(played, path) <= OFF_PATH
        assert is_within_limits(played), largest_uses(played)
        np.testing.assert_array_equal(played[-1], played[-500])


def test_a_stop_while_the_arm_comes_to_rest_ends_there(middle: Plan, path: np.ndarray) -> None:
    bench = PlayedBench()
    bench.start(middle)
    bench.when(
        lambda: bench.state == "following" and bench.statuses[-1].progress > 0.2,
        lambda: bench.oversleep.update({len(bench.setpoints) + 1: 300_000_000}),
    )
    bench.when(lambda: bench.player.stops == 1, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].progress < 1.0
    assert off_path(np.array(bench.played), path) <= OFF_PATH
    assert is_within_limits(np.array(bench.played))


def test_an_arm_that_rests_in_a_segment_that_is_over_is_taken_up_there(middle: Plan, path: np.ndarray) -> None:
    for begin in range(20, 1200, 90):  # its setpoints get lost for a while, and the program goes on without it
        bench = PlayedBench(lambda cycle, begin=begin: [] if begin <= cycle < begin + 40 else [0.0])
        played = bench.run_whole(middle)
        assert off_path(played, path) <= OFF_PATH
        assert is_within_limits(played), largest_uses(played)
        np.testing.assert_allclose(tool_pose(played[-1:], ARM)[0, :3, 3], path[-1], atol=1e-9)
