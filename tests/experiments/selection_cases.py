"""Sets of five demonstrations on which the parts of the selection are judged: faultless ones, and ones with a fault."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from teachpath.records import Array, Trajectory
from tests.experiments.scenarios import SCENARIOS, SHAPES, spoilt
from tests.unit.learning import synthetic

DURATION = 3.98  # s
RATES = (25, 50, 100, 200)  # Hz


@dataclass(frozen=True)
class SelectionCase:
    """Five demonstrations of one way, the last `marked` with a fault.

    Attributes:
        target: least rate at which all marked are left out; with none marked, largest rate of faultless ones left out.
    """

    key: str
    title: str
    shown: Callable[[np.random.Generator], list[Trajectory]]
    target: float
    marked: int = 0


def alike(rng: np.random.Generator, size: float = 1.0) -> list[Trajectory]:
    """Five of one way, alike in pace, of a task that is so many times as large as that of experiment 2."""
    five = [synthetic.demonstration(rng, duration=DURATION) for _ in range(5)]
    return [Trajectory(each.times, size * each.positions) for each in five]


def at_strong_pace(rng: np.random.Generator) -> list[Trajectory]:
    return [synthetic.demonstration(rng, duration=3.16 * (1 + 0.45 * rng.uniform(-1, 1)), warp=0.25) for _ in range(5)]


def one_twice_as_fast(rng: np.random.Generator) -> list[Trajectory]:
    return [synthetic.demonstration(rng, duration=DURATION / (1 + (i == 4))) for i in range(5)]


def at_mixed_rates(rng: np.random.Generator) -> list[Trajectory]:
    """Five, each sampled at a rate of its own."""
    five = []
    for _ in range(5):
        hand = synthetic.demonstration(rng, duration=DURATION, noise=0.0)
        times = np.arange(0.0, hand.times[-1] + 1e-9, 1 / rng.choice(RATES))
        positions = np.column_stack([np.interp(times, hand.times, hand.positions[:, k]) for k in range(3)])
        five.append(Trajectory(times, positions + rng.normal(0, 0.001, positions.shape)))
    return five


def along_shape(shape: str, rng: np.random.Generator) -> list[Trajectory]:
    return synthetic.shown(SHAPES[shape](), 5, int(rng.integers(1 << 31)))[0]


def detour_of_3_cm(positions: Array, at: int, rng: np.random.Generator) -> Array:
    side = rng.normal(size=3)
    bump = np.exp(-0.5 * np.square((np.arange(len(positions)) - at) / (0.09 * len(positions))))
    return np.asarray(positions + 0.03 * bump[:, None] * side / np.linalg.norm(side))


FAULTLESS_CASES = (
    SelectionCase("alike", "alike in pace", alike, 0.02),
    SelectionCase("pace", "±45 % duration, warped", at_strong_pace, 0.025),
    SelectionCase("twice", "one twice as fast", one_twice_as_fast, 0.025),
    SelectionCase("rates", "sampled at 25 to 200 Hz", at_mixed_rates, 0.02),
    SelectionCase("small", "a task of 5 cm", partial(alike, size=0.07), 0.02),
    SelectionCase("large", "a task of 5 m", partial(alike, size=7.0), 0.02),
    *(SelectionCase(shape, f"a path: {shape}", partial(along_shape, shape), 0.02) for shape in SHAPES),
)
TARGETS = {"wiggle": 0.995, "wiggle_fifth": 0.98, "two_wiggly": 0.98, "pause": 0.98, "freeze": 0.98, "spike": 0.98}
TARGETS |= {"jitter": 0.98, "detour": 0.98}
FAULTY_CASES = (
    *(SelectionCase(s.key, s.title, s.shown, TARGETS[s.key], s.marked) for s in SCENARIOS if s.key in TARGETS),
    SelectionCase("detour_half", "a smooth detour of 3 cm", partial(spoilt, detour_of_3_cm), 0.75, 1),
)
CASES = {case.key: case for case in (*FAULTLESS_CASES, *FAULTY_CASES)}
