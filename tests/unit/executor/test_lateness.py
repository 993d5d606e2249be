"""Executor and player together, in a time of their own: whatever comes late, the arm stays on its path and goes on."""

import numpy as np
import pytest

from teachpath.motion.analysis.log_check import SetpointLog, check_log
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.records import Plan
from tests.unit.executor.played_setpoints import ARM, PlayedBench, largest_uses, off_path

OFF_PATH = 1e-5  # m
ROUNDING = 1.0 + 1e-6


@pytest.fixture(scope="module")
def path(middle: Plan) -> np.ndarray:
    """The tool's way (n, 3) when nothing is late [m]."""
    return tool_pose(PlayedBench().run_whole(middle), ARM)[:, :3, 3]


def is_within_limits(played: np.ndarray) -> bool:
    """Tell whether differences keep all limits, at whatever moment of a period the arm's clock began."""
    return max(max(largest_uses(played[phase:])) for phase in range(4)) <= ROUNDING


def faults_of_its_log(bench: PlayedBench) -> tuple[str, ...]:
    """Judge what was sent, which begins anew wherever the arm came to rest by itself."""
    sent = bench.setpoints
    times, positions = np.array([s.nominal_ns for s in sent]) / 1e9, np.array([s.position for s in sent])
    restarts = tuple(row for row, setpoint in enumerate(sent) if row and setpoint.from_rest)
    assert len(restarts) == bench.player.stops
    return check_log(SetpointLog(times - times[0], positions, restarts=restarts), None, ARM).faults


def test_undisturbed_the_player_adds_nothing(middle: Plan, path: np.ndarray) -> None:
    bench = PlayedBench()
    played = bench.run_whole(middle)
    assert off_path(played, path) <= OFF_PATH
    assert is_within_limits(played), largest_uses(played)
    assert (bench.player.stops, bench.player.late, bench.player.missed) == (0, 0, 0)


@pytest.mark.parametrize(("every", "lost"), [(5, 1), (7, 2)])
def test_setpoints_that_are_lost_leave_the_motion_within_its_limits(
    middle: Plan, path: np.ndarray, every: int, lost: int
) -> None:
    bench = PlayedBench(lambda cycle: [] if 0 < cycle % every <= lost else [0.0])
    played = bench.run_whole(middle)
    assert off_path(played, path) <= OFF_PATH
    assert is_within_limits(played), largest_uses(played)
    assert bench.player.stops == 0
    assert bench.player.missed > 100


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
    assert faults_of_its_log(bench) == ()


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
    assert faults_of_its_log(bench) == ()


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


@pytest.mark.parametrize("lost", [0, 30])
def test_an_arm_told_to_step_goes_no_farther_by_itself_when_setpoints_are_lost(
    middle: Plan, path: np.ndarray, lost: int
) -> None:
    gap, held = [10**9], []
    bench = PlayedBench(lambda cycle: [] if gap[0] <= cycle < gap[0] + 40 else [0.0])

    def step(behind: int) -> None:
        gap[0] = len(bench.setpoints) + behind
        bench.command("step", length=0.05)

    def settled() -> bool:
        return all(status.state == "held" for status in bench.statuses[-5:])

    bench.start(middle)
    bench.when(lambda: bench.state == "following" and bench.statuses[-1].progress > 0.1, lambda: bench.command("hold"))
    for behind in (lost, 10**9):
        bench.when(settled, lambda: held.append(bench.statuses[-1]))
        bench.when(lambda: True, lambda behind=behind: step(behind))  # type: ignore[misc]
        bench.when(lambda: bench.state == "following", lambda: None)
    bench.when(settled, lambda: held.append(bench.statuses[-1]))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended" and bench.player.at_rest, bench.stop.set)
    bench.run()
    begin, cut, again = (status.length for status in held)
    assert begin - 1e-9 <= cut <= begin + 0.05 + 1e-6
    assert again == pytest.approx(cut + 0.05, abs=1e-6)
    assert f"rests at s = {cut:.3f} m, short of its end: step again, or resume" in held[1].reason
    assert off_path(np.array(bench.played), path) <= OFF_PATH
    assert is_within_limits(np.array(bench.played))
