"""What an arm does whose executor oversleeps, dies, or whose setpoints are lost, late or doubled, on random paths.

Executor, player and the simulated arm run in a time of their own, so that the figures are those of the rules and not of
this machine's punctuality.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count, islice
from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.planning.plan import plan
from teachpath.records import Fit, LearnedPath, Plan
from tests.bench.report import Figure, against
from tests.plan_checker.random_cases import random_case
from tests.unit.executor.executors import signed
from tests.unit.executor.played_setpoints import ARM, Arrivals, MovedBench, PlayedBench, largest_uses, off_path

ASKED_OFF: Final = 1e-5  # m off the path, that the player asks of the arm
DONE_OFF: Final = 3e-4  # m off the path, that the arm does
SLEEPS: Final = (0.02, 0.5)  # s, of a stopped executor
LOST_SHARE: Final = 0.05  # share of setpoints


@dataclass(frozen=True)
class Disturbed:
    """What a disturbed motion came to.

    Attributes:
        asked: how far off the path the player wished the arm to be, at most [m].
        done: how far off the path the arm was, at most [m].
        uses: of the limits of speed, acceleration and jerk by what the player asked, at most.
        speed: use of the speed limits by what the arm did, at most.
        torque: use of the torque limits by what the arm did, at most.
        rested: whether the arm came to rest, and where the executor lived, at the path's end.
    """

    asked: float
    done: float
    uses: tuple[float, float, float]
    speed: float
    torque: float
    rested: bool


def random_plans() -> Iterator[tuple[int, Plan]]:
    """Yield seeds with plans of random paths in random scenes."""
    for seed in count():
        curve, scene = random_case(seed)
        try:
            made = plan(LearnedPath(f"random-{seed}", "run", 1, 1, curve, Fit(0.0, 0.0, 0.0, 0.0)), scene)
        except PathRefused:
            continue
        yield seed, signed(made)


def measure(*, paths: int, moments: int) -> list[Figure]:
    """Return the figures of so many moments on each of so many random paths, for each kind of disturbance."""
    found: dict[str, list[Disturbed]] = {"stopped for 20 to 500 ms": [], "dead": [], "5 % lost, late, doubled": []}
    stopped, dead, lossy = found.values()
    for seed, made in islice(random_plans(), paths):
        rng, undisturbed = np.random.default_rng(seed), PlayedBench()
        way = tool_pose(undisturbed.run_whole(made), ARM)[:, :3, 3]
        cycles = len(undisturbed.setpoints)
        stopped.append(_slept(made, way, rng.integers(10, cycles, moments), rng))
        dead += [_died(made, way, int(cycle)) for cycle in rng.integers(10, cycles, moments)]
        lossy.append(_whole(MovedBench(made, _lossy(rng)), made, way))
    return [figure for kind, cases in found.items() for figure in _figures(kind, cases)]


def _slept(made: Plan, way: np.ndarray, cycles: np.ndarray, rng: np.random.Generator) -> Disturbed:
    bench = MovedBench(made)
    bench.oversleep = {int(cycle): int(1e9 * rng.uniform(*SLEEPS)) for cycle in cycles}
    return _whole(bench, made, way)


def _lossy(rng: np.random.Generator) -> Arrivals:
    def arrivals(cycle: int) -> list[float]:
        if rng.random() < LOST_SHARE:
            return []
        late = [float(rng.uniform(0.0, 0.012))] if rng.random() < 0.95 else [float(rng.uniform(0.05, 0.3))]
        return late + ([late[0] + 0.01] if rng.random() < 0.1 else [])

    return arrivals


def _whole(bench: MovedBench, made: Plan, way: np.ndarray) -> Disturbed:
    played = bench.run_whole(made)
    return _disturbed(bench, way, bool(np.allclose(tool_pose(played[-1:], ARM)[0, :3, 3], way[-1], atol=1e-9)))


def _died(made: Plan, way: np.ndarray, cycle: int) -> Disturbed:
    """Play setpoints until one; none that is later is ever heard."""
    bench = MovedBench(made, lambda sent: [0.0] if sent < cycle else [])
    bench.start(made)
    bench.when(lambda: len(bench.setpoints) >= cycle, lambda: None)
    rested: list[int] = []
    bench.when(lambda: bench.player.at_rest, lambda: rested.append(bench.now))
    bench.when(lambda: bench.now > rested[-1] + 10**9, bench.stop.set)
    bench.run()
    return _disturbed(bench, way, bench.player.at_rest)


def _disturbed(bench: MovedBench, way: np.ndarray, rested: bool) -> Disturbed:
    speed, acceleration, jerk = largest_uses(np.array(bench.played))
    return Disturbed(
        asked=off_path(np.array(bench.played), way),
        done=off_path(np.array(bench.positions), way),
        uses=(speed, acceleration, jerk),
        speed=float((np.abs(bench.velocities) / ARM.limits.speed).max()),
        torque=float((np.abs(bench.torques) / ARM.limits.torque).max()),
        rested=rested,
    )


def _figures(kind: str, cases: list[Disturbed]) -> list[Figure]:
    uses = np.max([each.uses for each in cases], axis=0)
    return [
        Figure(f"executor or setpoints {kind}: arms not at rest where they should be", (_astray(cases),), "motions"),
        against(
            "  the player asks off the path", [1e6 * e.asked for e in cases], "um", name="asked", value=1e6 * ASKED_OFF
        ),
        against("  the arm does off the path", [1e3 * e.done for e in cases], "mm", name="asked", value=1e3 * DONE_OFF),
        *(
            against(f"  largest use of {name} by what the player asks", [float(use)], "", name="limit", value=1.0)
            for name, use in zip(("speed", "acceleration", "jerk"), uses, strict=True)
        ),
        against("  use of speed by what the arm does", [e.speed for e in cases], "", name="limit", value=1.0),
        against("  use of torque by what the arm does", [e.torque for e in cases], "", name="limit", value=1.0),
    ]


def _astray(cases: list[Disturbed]) -> float:
    return float(sum(not each.rested for each in cases))
