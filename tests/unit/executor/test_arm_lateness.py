"""Executor, player and the simulated arm together, in a time of their own: what the arm does stays on its path, too."""

import numpy as np
import pytest

from teachpath.records import Plan
from tests.unit.executor.played_setpoints import ARM, MovedBench, off_path
from tests.unit.executor.test_lateness import path

__all__ = ["path"]  # the fixture

OFF_PATH = 3e-4  # m


def stays_on_the_path(bench: MovedBench, path: np.ndarray) -> None:
    assert off_path(np.array(bench.positions), path) <= OFF_PATH
    assert np.all(np.abs(bench.velocities) <= ARM.limits.speed)
    assert np.all(np.abs(bench.torques) < ARM.limits.torque)  # where it stands at one, it lags behind


def test_undisturbed_the_arm_follows_its_path(middle: Plan, path: np.ndarray) -> None:
    bench = MovedBench(middle)
    bench.run_whole(middle)
    stays_on_the_path(bench, path)


@pytest.mark.parametrize("seed", range(4))
def test_an_arm_whose_executor_oversleeps_rests_on_its_path_and_goes_on(
    middle: Plan, path: np.ndarray, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    bench = MovedBench(middle)
    bench.oversleep = {
        int(k): int(1e9 * s) for k, s in zip(rng.integers(10, 1100, 8), rng.uniform(0.02, 0.5, 8), strict=True)
    }
    bench.run_whole(middle)
    assert bench.player.stops > 0
    stays_on_the_path(bench, path)


@pytest.mark.parametrize("begin", range(150, 1150, 200))
def test_an_arm_whose_setpoints_end_rests_on_its_path(middle: Plan, path: np.ndarray, begin: int) -> None:
    bench = MovedBench(middle, lambda cycle: [0.0] if cycle < begin else [])
    bench.start(middle)
    bench.when(lambda: len(bench.positions) > 4 * begin + 2000, bench.stop.set)
    bench.run()
    assert bench.player.at_rest
    stays_on_the_path(bench, path)
