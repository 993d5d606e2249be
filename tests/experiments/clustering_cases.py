"""Demonstrations of known clusters, for the rates of the clustering: ways shown once, tidy and untidy hands, ends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed
from teachpath.records import Array, Trajectory
from tests.unit.learning import synthetic

TIDY_SPREADS = {"via_spread": 0.003, "end_spread": 0.001, "tremor": 0.0005, "noise": 0.0005}  # m
UNTIDY_SPREADS = {"via_spread": 0.03}
MOUSE = {"via_spread": 0.002, "end_spread": 0.001, "tremor": 0.0002, "noise": 0.0002}
Labelled = tuple[list[Trajectory], list[int]]


@dataclass(frozen=True)
class Case:
    """Demonstrations whose clusters are known.

    Attributes:
        shown: from a seed to the demonstrations in random order and the true cluster of each.
        target: least rate of seeds with the right clusters.
        stops: whether the first demonstration is incomplete, 1 or 0.
        doubt: whether the right clusters count where they are not found, but called doubtful and the next cut.
        called: largest rate of seeds that may be called ambiguous.
    """

    title: str
    shown: Callable[[int], Labelled]
    target: float = 0.95
    stops: int = 0
    doubt: bool = False
    called: float = 1.0


def known_ways(
    seed: int, sizes: Sequence[int], ways: Sequence[Array] = synthetic.WAY_POINTS, pace: float = 0.2, **hand: Any
) -> Labelled:
    """So many demonstrations of each way, in random order, whose durations differ by up to `pace`."""
    rng = np.random.default_rng([seed, 14])
    truth = rng.permutation(np.repeat(np.arange(len(sizes)), sizes))
    shown = [
        synthetic.demonstration(rng, ways[way], duration=3.16 * (1 + pace * rng.uniform(-1, 1)), **hand)
        for way in truth
    ]
    return shown, truth.tolist()


def drawn_ways(seed: int, sizes: Sequence[int], least: float, **hand: Any) -> Labelled:
    """The same along ways that are drawn at random, whose mean paths are at least `least` [m] apart."""
    rng = np.random.default_rng([seed, 15])
    ways: list[Array] = []
    paths: list[Array] = []
    while len(ways) < len(sizes):
        vias = np.array([[0.38, 0.10, 0.20], [0.40, -0.12, 0.20]])
        vias = vias + rng.uniform(-1, 1, 3) * [0.3, 0.02, 0.3] + rng.normal(0, 0.04, (2, 3))
        knots = np.vstack([synthetic.START, vias, synthetic.GOAL])
        path = at_equal_arc_length(CubicSpline(np.linspace(0, 1, 4), knots)(np.linspace(0, 1, 200)), 100)
        if all(np.linalg.norm(path - other, axis=1).mean() > least for other in paths):
            ways.append(vias)
            paths.append(path)
    return known_ways(seed, sizes, ways, **hand)


def goals_apart(seed: int, sizes: Sequence[int], apart: float, **hand: Any) -> Labelled:
    """One way to goals in a row, `apart` [m] from one to the next in a random direction on the table."""
    rng = np.random.default_rng([seed, 17])
    truth = rng.permutation(np.repeat(np.arange(len(sizes)), sizes))
    angle = rng.uniform(0, 2 * np.pi)
    step = apart * np.array([np.cos(angle), np.sin(angle), 0.0])
    return [synthetic.demonstration(rng, goal=synthetic.GOAL + goal * step, **hand) for goal in truth], truth.tolist()


def reversed_in_space(shown: Labelled) -> Labelled:
    """The same with starts and goals exchanged."""
    return [Trajectory(each.times, each.positions[::-1]) for each in shown[0]], shown[1]


def starts_apart(seed: int, sizes: Sequence[int], apart: float) -> Labelled:
    return reversed_in_space(goals_apart(seed, sizes, apart))


def one_way(seed: int, count: int, pace: float = 0.45, **hand: Any) -> Labelled:
    return known_ways(seed, (count,), synthetic.WAY_POINTS[1:2], pace, **hand)


def one_wiggles(seed: int, **hand: Any) -> Labelled:
    """Five of one way; one wiggles by 2.5 cm."""
    shown, truth = one_way(seed, 4, 0.2, **hand)
    rng = np.random.default_rng([seed, 16])
    shown.insert(int(rng.integers(5)), synthetic.demonstration(rng, wiggle=0.025, **hand))
    return shown, [*truth, 0]


def every_other_rests(seed: int, count: int, rest: float = 3.0, noise: float = 0.0008) -> Labelled:
    """One way; every other demonstration rests at a random share of its duration, tracker noise [m] goes on."""
    shown, truth = one_way(seed, count, 0.2, noise=noise)
    rng = np.random.default_rng([seed, 19])
    return [rests(rng, each, rest, noise) if i % 2 else each for i, each in enumerate(shown)], truth


def rests(rng: np.random.Generator, shown: Trajectory, rest: float, noise: float) -> Trajectory:
    """The same with a rest [s] put in between 30 and 70 % of its samples."""
    at, count = int(rng.uniform(0.3, 0.7) * len(shown)), round(rest / synthetic.PERIOD)
    still = shown.positions[at] + rng.normal(0, noise, (count, 3))
    positions = np.concatenate([shown.positions[:at], still, shown.positions[at:]])
    return Trajectory(np.arange(len(positions)) * synthetic.PERIOD, positions)


def differ_in_part(seed: int, sizes: Sequence[int], height: float, **hand: Any) -> Labelled:
    """One way; some make a bump of this height [m] over a third of the path, at a random place to a random side."""
    rng = np.random.default_rng([seed, 20])
    shown, truth = known_ways(seed, sizes, (synthetic.WAY_POINTS[1],) * len(sizes), **hand)
    middle, side = rng.uniform(0.3, 0.7), np.cross(synthetic.GOAL - synthetic.START, rng.normal(size=3))
    bumped = []
    for each, way in zip(shown, truth, strict=True):
        along = arc_lengths(smoothed(each))
        bump = np.square(np.cos(np.pi * np.clip(3 * (along / along[-1] - middle), -0.5, 0.5)))
        away = way * height * bump[:, None] * side / np.linalg.norm(side)
        bumped.append(Trajectory(each.times, each.positions + away))
    return bumped, truth


def two_agree_exactly(seed: int, apart: float = 0.015, noise: float = 1e-4) -> Labelled:
    """Two along one way that agree to 0.1 mm, and two along another on average up to `apart` [m] from each other."""
    rng = np.random.default_rng([seed, 21])
    quiet = dict.fromkeys(("via_spread", "end_spread", "tremor", "noise", "warp"), 0.0)
    tight, loose = (synthetic.demonstration(rng, synthetic.WAY_POINTS[way], **quiet) for way in (0, 1))
    side = rng.normal(size=3)
    bow = np.sin(np.pi * np.linspace(0, 1, len(loose)))[:, None] * np.pi / 2 * side / np.linalg.norm(side)
    shown = [
        *(Trajectory(tight.times, tight.positions + rng.normal(0, noise, tight.positions.shape)) for _ in range(2)),
        loose,
        Trajectory(loose.times, loose.positions + rng.uniform(0.3, 1.0) * apart * bow),
    ]
    return shown, [0, 0, 1, 1]


def _once(sizes: tuple[int, ...]) -> list[Case]:
    return [
        Case(f"{sizes}, the ways of the paper", partial(known_ways, sizes=sizes)),
        Case(f"{sizes}, ways 10 cm apart or more", partial(drawn_ways, sizes=sizes, least=0.10)),
    ]


SINGLE_CASES = tuple(
    case for sizes in ((1, 1, 1), (2, 1, 1), (4, 1, 1), (5, 1, 1), (3, 3, 1), (2, 2, 1)) for case in _once(sizes)
)
OFTEN_CASES = (
    Case("(5, 3, 4), the ways of the paper", partial(known_ways, sizes=(5, 3, 4))),
    Case("(5, 3, 4), ±45 % duration", partial(known_ways, sizes=(5, 3, 4), pace=0.45, warp=0.25)),
    Case("(5, 3, 4), an untidy hand", partial(known_ways, sizes=(5, 3, 4), **UNTIDY_SPREADS)),
    Case("(5, 3, 4), ways 6 cm apart or more", partial(drawn_ways, sizes=(5, 3, 4), least=0.06)),
    Case("(3, 3), a tidy hand, ways 4 cm apart or more", partial(drawn_ways, sizes=(3, 3), least=0.04, **TIDY_SPREADS)),
    Case("eight ways three times", partial(drawn_ways, sizes=(3,) * 8, least=0.10), called=0.05),
    Case("twelve ways three times", partial(drawn_ways, sizes=(3,) * 12, least=0.08)),
    Case("two that agree to 0.1 mm, two within 1.5 cm", two_agree_exactly),
)
PARTIAL_CASES = (
    *(
        Case(f"{sizes}, a bump of 4 cm", partial(differ_in_part, sizes=sizes, height=0.04), 0.9, doubt=True)
        for sizes in ((2, 2), (3, 2), (3, 3), (4, 2), (6, 6))
    ),
    *(
        Case(
            f"{sizes}, a tidy hand, a bump of 2 cm",
            partial(differ_in_part, sizes=sizes, height=0.02, **TIDY_SPREADS),
            0.9,
            doubt=True,
        )
        for sizes in ((2, 2), (3, 3), (4, 2))
    ),
)
ONE_WAY_CASES = (
    *(Case(f"one way, {count} times, ±45 % duration", partial(one_way, count=count)) for count in (2, 3, 4, 5, 12)),
    *(
        Case(f"one way, {count} times, an untidy hand", partial(one_way, count=count, **UNTIDY_SPREADS))
        for count in (3, 5, 12)
    ),
    Case("one way, a tidy hand, 5 times", partial(one_way, count=5, **TIDY_SPREADS)),
    Case("one way, one of five wiggles", one_wiggles),
    Case("one way, a tidy hand, one of five wiggles", partial(one_wiggles, **TIDY_SPREADS)),
    Case("one way, six times, every other one rests for 3 s", partial(every_other_rests, count=6)),
    Case("one way, four times with the mouse", partial(one_way, count=4, **MOUSE)),
)


def one_stops(seed: int, count: int, shares: tuple[float, float], sizes: Sequence[int] = (), **hand: Any) -> Labelled:
    """One way, or several; the first demonstration stops at a share of its path and belongs to the others still."""
    shown, truth = known_ways(seed, sizes) if sizes else one_way(seed, count, 0.2, **hand)
    share = np.random.default_rng([seed, 18]).uniform(*shares)
    along = arc_lengths(smoothed(shown[0]))
    last = max(int(np.searchsorted(along, share * along[-1])), 10)
    shown[0] = Trajectory(shown[0].times[:last], shown[0].positions[:last])
    return shown, truth


def _stops(count: int, low: float, high: float) -> Case:
    title = f"one of {count} stops at {100 * low:.0f} to {100 * high:.0f} %"
    return Case(title, partial(one_stops, count=count, shares=(low, high)), stops=1)


NEARLY_CORRECT = (0.84, 0.91)
INCOMPLETE_CASES = (
    *(_stops(count, low, high) for count in (3, 6) for low, high in (NEARLY_CORRECT, (0.6, 0.8), (0.4, 0.6))),
    Case(
        "one of 6 of a tidy hand stops at 84 to 91 %",
        partial(one_stops, count=6, shares=NEARLY_CORRECT, **TIDY_SPREADS),
        stops=1,
    ),
    Case(
        "one of (5, 3, 4) stops at 50 to 90 %", partial(one_stops, count=0, sizes=(5, 3, 4), shares=(0.5, 0.9)), stops=1
    ),
)
ENDS = (
    *(
        Case(f"{sizes}, goals {100 * apart:g} cm apart", partial(goals_apart, sizes=sizes, apart=apart))
        for sizes in ((1, 1), (3, 3), (4, 2), (5, 1), (2, 2, 2))
        for apart in (0.05, 0.10)
    ),
    Case("(3, 3), starts 5 cm apart", partial(starts_apart, sizes=(3, 3), apart=0.05)),
    Case("(3, 3), a tidy hand, goals 2 cm apart", partial(goals_apart, sizes=(3, 3), apart=0.02, **TIDY_SPREADS), 0.0),
)
GROUPS = {
    "Ways shown once": SINGLE_CASES,
    "Ways shown often": OFTEN_CASES,
    "Ways that differ in a third of the path": PARTIAL_CASES,
    "One way": ONE_WAY_CASES,
    "Ends": ENDS,
    "Incomplete": INCOMPLETE_CASES,
}
