"""Random paths, planned: every accepted plan judged by the independent checker, every refusal by kind."""

import re
import time
from collections import Counter

import numpy as np
from checker import judge, reachable
from random_plans import random_case, streamed
from report import Figure, against

from teachpath.errors import PathRefused
from teachpath.motion.plan import plan
from teachpath.records import Fit, LearnedPath

DT = 0.004
ALLOWED = 1.0 + 1e-9
OFF = 1e-4  # m
SAMPLED = 0.001  # m, by which sampled surfaces may seem nearer than they are


def measure(*, count: int) -> list[Figure]:
    """Return the figures over so many random paths in random scenes."""
    seconds, worst, broken = [], np.zeros(6), 0
    refused: Counter[str] = Counter()
    unfounded = 0
    for seed in range(count):
        curve, scene = random_case(seed)
        began = time.process_time()
        try:
            made = plan(LearnedPath(f"random-{seed}", "run", 1, 1, curve, Fit(0.0, 0.0, 0.0, 0.0)), scene)
        except PathRefused as error:
            kind, founded = _founded(str(error))
            refused[kind] += 1
            unfounded += not founded
            continue
        seconds.append((time.process_time() - began) / made.lengths[-1])
        found = judge(streamed(made), curve, scene)
        uses = [found.position, found.speed, found.acceleration, found.jerk]
        tight = made.certificate.clearance.value - found.clearance
        worst = np.maximum(worst, [*uses, found.off_path, tight])
        broken += max(uses) > ALLOWED or found.off_path > OFF or tight > SAMPLED
    planned = float(len(seconds))
    kinds = ", ".join(f"{kind} {number}" for kind, number in sorted(refused.items())) or "none"
    return [
        Figure(f"plans accepted of {count} random paths; refused: {kinds}", (planned,), "plans"),
        Figure("accepted plans with a violation", (float(broken),), "plans"),
        Figure("refusals for reach where the wrist does reach", (float(unfounded),), "plans"),
        *[
            against(f"largest use of {name}", [float(use)], "", name="limit", value=1.0)
            for name, use in zip(("position", "speed", "acceleration", "jerk"), worst[:4], strict=True)
        ],
        against("farthest from the curve", [1e6 * float(worst[4])], "um", name="allowed", value=1e6 * OFF),
        Figure("certified clearance beyond the sampled one, at most", (1e3 * float(worst[5]),), "mm"),
        against("planning a metre", seconds or [np.nan], "s", name="asked", value=0.5),
    ]


def _founded(sentence: str) -> tuple[str, bool]:
    """Sort a refusal by its words; one for reach is checked where it is said to be."""
    kinds = {
        "reach": "wrist centre",
        "a move to or from the path": "on the way|above the",
        "collision": "comes within",
        "joint limit": "joint . needs",
        "wrist": "turn over",
        "singular": "singular",
    }
    kind = next((kind for kind, words in kinds.items() if re.search(words, sentence)), sentence)
    place = re.search(r"\((-?[\d.]+), (-?[\d.]+), (-?[\d.]+)\)", sentence)
    if kind != "reach" or place is None:
        return kind, True
    return kind, not reachable([float(value) for value in place.groups()])
