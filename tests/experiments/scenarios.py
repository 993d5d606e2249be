"""What the experiments show to learning: seeded demonstrations of known grouping and known faults."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from teachpath.records import Array, Trajectory
from tests.unit.learning import synthetic

Demonstrations = dict[str, Trajectory]

WIGGLE = 0.025  # m
PERIOD = synthetic.PERIOD


@dataclass(frozen=True)
class Scenario:
    """Five demonstrations of one way, some of them marked because they are spoilt.

    Attributes:
        shown: from a random generator to the five, in the order shown; the marked ones come last.
        marked: how many.
        chance: rate at which all marked are rejected when two of five are drawn blindly.
        target: least rate asked of mode default, or for the control what the rate has to be.
    """

    key: str
    title: str
    shown: Callable[[np.random.Generator], list[Trajectory]]
    marked: int = 1
    chance: float = 0.6
    target: float = 0.95


def drawn(scenario: Scenario, run: int) -> tuple[Demonstrations, set[str]]:
    """Return the demonstrations of a run in random order, named `1` to `5` by their place, and the marked ones."""
    rng = np.random.default_rng([run, 5])
    shown = scenario.shown(rng)
    order = rng.permutation(len(shown))
    named = {str(place + 1): shown[which] for place, which in enumerate(order)}
    first = len(shown) - scenario.marked
    return named, {str(place + 1) for place, which in enumerate(order) if which >= first}


def wiggly(amplitude: float, rng: np.random.Generator, *, marked: int = 1) -> list[Trajectory]:
    steady = [synthetic.demonstration(rng, duration=3.98) for _ in range(5 - marked)]
    return steady + [synthetic.demonstration(rng, duration=3.98, wiggle=amplitude) for _ in range(marked)]


def spoilt(fault: Callable[[Array, int, np.random.Generator], Array], rng: np.random.Generator) -> list[Trajectory]:
    """Five of one way; the last has a fault somewhere between 30 and 70 % of its time."""
    shown = wiggly(0.0, rng)
    positions = shown[-1].positions.copy()
    at = round(rng.uniform(0.3, 0.7) * len(positions))
    changed = fault(positions, at, rng)
    return [*shown[:-1], Trajectory(np.arange(len(changed)) * PERIOD, changed)]


def pause(positions: Array, at: int, rng: np.random.Generator) -> Array:
    still = positions[at] + rng.normal(0, 0.001, (40, 3))
    return np.concatenate([positions[:at], still, positions[at:]])


def freeze(positions: Array, at: int, _rng: np.random.Generator) -> Array:
    positions[at : at + 15] = positions[at]
    return positions


def spike(positions: Array, at: int, rng: np.random.Generator) -> Array:
    positions[at] += 0.08 * _direction(rng)
    return positions


def detour(positions: Array, at: int, rng: np.random.Generator) -> Array:
    bump = np.exp(-0.5 * np.square((np.arange(len(positions)) - at) / (0.09 * len(positions))))
    return positions + 0.06 * bump[:, None] * _direction(rng)


def jitter(positions: Array, _at: int, rng: np.random.Generator) -> Array:
    return positions + rng.normal(0, 0.004, positions.shape)


def _direction(rng: np.random.Generator) -> Array:
    side = rng.normal(size=3)
    return np.asarray(side / np.linalg.norm(side))


SCENARIOS = (
    Scenario("wiggle", "wiggles of 2.5 cm", partial(wiggly, WIGGLE), target=0.99),
    Scenario("wiggle_fifth", "wiggles of 0.5 cm", partial(wiggly, WIGGLE / 5)),
    Scenario("control", "nothing (control)", partial(wiggly, 0.0), target=0.6),
    Scenario("two_wiggly", "wiggles of 2.5 cm in two", partial(wiggly, WIGGLE, marked=2), 2, 0.3, 0.90),
    Scenario("pause", "a pause of 0.8 s", partial(spoilt, pause)),
    Scenario("freeze", "15 samples frozen", partial(spoilt, freeze)),
    Scenario("spike", "one spike of 8 cm", partial(spoilt, spike)),
    Scenario("detour", "a smooth detour of 6 cm", partial(spoilt, detour)),
    Scenario("jitter", "jitter of 4 mm an axis", partial(spoilt, jitter)),
)


@dataclass(frozen=True)
class Ways:
    """Demonstrations of known grouping.

    Attributes:
        shown: from a seed to the demonstrations.
        truth: the way of each.
        target: least share of seeds in which mode default groups them as they are.
    """

    key: str
    title: str
    shown: Callable[[int], Demonstrations]
    truth: tuple[int, ...]
    target: float


THREE_WAYS = (0, 1, 2, 2, 1, 0, 2, 0, 2, 0, 1, 0)  # Table I


def at_any_speed(seed: int, ways: tuple[int, ...]) -> Demonstrations:
    """Demonstrations with strong time warp whose durations differ by up to 45 %."""
    rng = np.random.default_rng(seed)
    return {
        str(i): synthetic.demonstration(
            rng, synthetic.WAY_POINTS[way], duration=3.16 * (1 + 0.45 * rng.uniform(-1, 1)), warp=0.25
        )
        for i, way in enumerate(ways, 1)
    }


GROUPINGS = (
    Ways("three_even", "three ways, alike in speed", synthetic.experiment_1, THREE_WAYS, 0.97),
    Ways("three_speeds", "three ways, ±45 % duration", partial(at_any_speed, ways=THREE_WAYS), THREE_WAYS, 0.97),
    Ways("one_of_twelve", "one way, 12 times, ±45 %", partial(at_any_speed, ways=(1,) * 12), (1,) * 12, 0.93),
    Ways("one_of_five", "one way, 5 times", partial(synthetic.experiment_2, wiggle=0.0), (1,) * 5, 0.93),
)

SHAPES = {
    "loop": synthetic.loop,
    "curl": synthetic.curl,
    "retreat": synthetic.retreat,
    "closed": synthetic.closed,
}


def along(shape: str, seed: int) -> tuple[Demonstrations, Array]:
    """Five demonstrations along a path that crosses itself, retreats or is closed; and their clean mean (n, 3) [m]."""
    trajectories, mean = synthetic.shown(SHAPES[shape](), 5, seed)
    return {str(i): trajectory for i, trajectory in enumerate(trajectories, 1)}, mean
