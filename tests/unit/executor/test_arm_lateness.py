"""Executor, player and the simulated arm together, in a time of their own: what the arm does stays on its path, too."""

import numpy as np
import pytest

from teachpath.records import Plan
from teachpath.simulator.arm import SimulatedArm
from teachpath.simulator.settings import SimulatorSettings
from tests.unit.executor.executors import HOME
from tests.unit.executor.test_lateness import ARM, Arrivals, PlayedBench, at_once, off_path, path

__all__ = ["path"]  # the fixture

OFF_PATH = 3e-4  # m


class MovedBench(PlayedBench):
    """An executor whose setpoints move the simulated arm, one step a millisecond."""

    def __init__(self, plan: Plan, arrivals: Arrivals = at_once) -> None:
        super().__init__(arrivals)
        self._arm = SimulatedArm(plan.scene, ARM, SimulatorSettings(), HOME)
        self._closed = False
        self.positions: list[np.ndarray] = []
        self.velocities: list[np.ndarray] = []

    def _play_on(self) -> None:
        super()._play_on()
        target, reached = self.player.target, self.player.last_reached
        closed = reached is not None and reached.gripper_closed
        if closed and not self._closed:
            assert self._arm.grasp()
        elif self._closed and not closed:
            self._arm.release()
        self._closed = closed
        self._arm.step(target.position, target.velocity, target.acceleration)
        self.positions.append(self._arm.position)
        self.velocities.append(self._arm.velocity)


def stays_on_the_path(bench: MovedBench, path: np.ndarray) -> None:
    assert off_path(np.array(bench.positions), path) <= OFF_PATH
    assert np.all(np.abs(bench.velocities) <= ARM.limits.speed)


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
