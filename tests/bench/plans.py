"""Random paths, planned: every accepted plan and every refusal judged by independent checkers.

`python tests/bench/plans.py FIRST LAST` prints each of these paths; `make bench` counts them.
"""

import re
import sys
import time
from collections import Counter
from dataclasses import dataclass

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.planning.plan import plan
from teachpath.records import Fit, LearnedPath
from tests.bench.report import Figure, against
from tests.plan_checker.checker import Verdict, judge
from tests.plan_checker.exhaustive_search import search
from tests.plan_checker.random_cases import random_case, streamed

DT = 0.004
ALLOWED_LIMIT_USE = 1.0 + 1e-9
TOLERANCE = 1e-4  # m
SAMPLING_PERIOD = 0.001  # m, by which sampled surfaces may seem nearer than they are


LONG_PATH = 0.5  # m, of a path whose planning is also told by the metre
KINDS = {
    "reach": "wrist centre",
    "a move to or from the path": "on the way|above the",
    "collision": "comes within|goes .* mm into",
    "joint limit": "joint . needs",
    "wrist": "turn over",
    "singular": "singular",
}


@dataclass(frozen=True)
class Case:
    """What came of a random path: a plan of some length [m] with its verdict, or a refusal that is founded or not."""

    seconds: float
    length: float = 0.0
    verdict: Verdict | None = None
    certified: float = 0.0
    refusal: str = ""
    founded: bool = True

    @property
    def violation(self) -> bool:
        """Whether the plan breaks a limit, leaves the path or is nearer to something than certified."""
        if self.verdict is None:
            return False
        return max(self.uses) > ALLOWED_LIMIT_USE or self.verdict.off_path > TOLERANCE or self.tight > SAMPLING_PERIOD

    @property
    def uses(self) -> list[float]:
        """Uses of position, speed, acceleration and jerk limits."""
        assert self.verdict is not None
        return [self.verdict.position, self.verdict.speed, self.verdict.acceleration, self.verdict.jerk]

    @property
    def tight(self) -> float:
        """How much more clearance is certified than was found [m]."""
        assert self.verdict is not None
        return self.certified - self.verdict.clearance


def case(seed: int) -> Case:
    """Plan a random path and judge what comes of it; a refusal is founded when a graph search finds no way either."""
    curve, scene = random_case(seed)
    began = time.process_time()
    try:
        made = plan(LearnedPath(f"random-{seed}", "run", 1, 1, curve, Fit(0.0, 0.0, 0.0, 0.0)), scene)
    except PathRefused as error:
        seconds = time.process_time() - began
        return Case(seconds, refusal=str(error), founded=not search(curve, scene).possible)
    seconds = time.process_time() - began
    return Case(
        seconds,
        float(made.lengths[-1]),
        judge(streamed(made), curve, scene),
        made.certificate.clearance.value,
    )


def measure(*, count: int) -> list[Figure]:
    """Return the figures over so many random paths in random scenes."""
    cases = [case(seed) for seed in range(count)]
    planned = [each for each in cases if each.verdict is not None]
    refused = Counter(kind(each.refusal) for each in cases if each.refusal)
    kinds = ", ".join(f"{name} {number}" for name, number in sorted(refused.items())) or "none"
    worst = np.max([each.uses for each in planned], axis=0)
    per_metre = [each.seconds / each.length for each in planned if each.length >= LONG_PATH]
    wrong = float(sum(not each.founded for each in cases))
    off = max(each.verdict.off_path for each in planned if each.verdict)
    return [
        Figure(f"plans accepted of {count} random paths; refused: {kinds}", (float(len(planned)),), "plans"),
        Figure("accepted plans with a violation", (float(sum(each.violation for each in planned)),), "plans"),
        Figure("refusals where a graph search finds a way", (wrong,), "plans"),
        *[
            against(f"largest use of {name}", [float(use)], "", name="limit", value=1.0)
            for name, use in zip(("position", "speed", "acceleration", "jerk"), worst, strict=True)
        ],
        against("farthest from the curve", [1e6 * off], "um", name="allowed", value=1e6 * TOLERANCE),
        Figure("certified clearance beyond the sampled one, at most", (1e3 * max(e.tight for e in planned),), "mm"),
        against("planning a path, CPU", [each.seconds for each in planned], "s", name="asked", value=0.5),
        against(
            f"planning a metre, paths from {LONG_PATH} m on, CPU", per_metre or [np.nan], "s", name="asked", value=0.5
        ),
    ]


def kind(sentence: str) -> str:
    """Sort a refusal by its words."""
    return next((kind for kind, words in KINDS.items() if re.search(words, sentence)), sentence)


if __name__ == "__main__":
    for seed in range(int(sys.argv[1]), int(sys.argv[2])):
        found = case(seed)
        fault = "VIOLATION " if found.violation else "" if found.founded else "UNFOUNDED "
        print(
            f"{seed}: {fault}{found.refusal or f'{found.length:.2f} m, {max(found.uses):.4f} of a limit'}", flush=True
        )
