"""Planning for arms that are read from a model: random paths, planned for the examples of six and seven axes.

`python -m tests.bench.model_arms` prints the figures.
"""

import time

import numpy as np

from teachpath.errors import PathRefused
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.sampled_plan import sample_plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Fit, LearnedPath, Plan, SerialArm
from tests.bench.report import Figure, against, print_report
from tests.plan_checker.random_cases import random_case
from tests.plan_checker.refusal_judge import Refusal, RefusalJudge

HEIGHT = 0.5  # [m] of the table, on which the arm stands
RATE = 250.0  # [Hz]
PATH_LENGTHS = {"six-axis": 0.3, "seven-axis": 1.0}  # [s] of a processor, of planning a metre


def measure(example: str, *, count: int) -> list[Figure]:
    """Return the figures of an example over so many random paths in random scenes, after one that does not count."""
    model = read_arm(example, base=((0.0, 0.0, HEIGHT), (1.0, 0.0, 0.0, 0.0)), gripper_length=0.13)
    arm = Arm.of_model(model, MotionSettings())
    _planned(0, arm)
    judge = RefusalJudge(EXAMPLES[example], HEIGHT, arm.tool_length)
    found = [_planned(seed, arm) for seed in range(count)]
    wrong = [seed for seed, (made, _) in enumerate(found) if made and not judge.accepts(made, *random_case(seed), arm)]
    plans = [(made, seconds) for made, seconds in found if made is not None]
    uses = np.max([_largest_use(made, arm, model) for made, _ in plans])
    refused = tuple(took for made, took in found if made is None)
    refusals = [judge.refuses(*random_case(seed)) for seed, (made, _) in enumerate(found) if made is None]
    return [
        Figure(f"plans accepted of {count} random paths", (float(len(plans)),), "plans"),
        Figure("of them off the path or too near to something, by MuJoCo", (float(len(wrong)),), "plans"),
        against("largest use of a joint's speed, acceleration or jerk", [float(uses)], "", name="limit", value=1.0),
        against(
            "planning a metre, CPU",
            [took / made.lengths[-1] for made, took in plans],
            "s",
            name="asked",
            value=PATH_LENGTHS[example],
        ),
        *([Figure("finding that there is no plan, CPU", refused, "s")] if refused else []),
        *[Figure(f"refused: {kind}, by MuJoCo", (float(refusals.count(kind)),), "paths") for kind in Refusal],
    ]


def _planned(seed: int, arm: Arm) -> tuple[Plan | None, float]:
    """Plan a random path; return the plan, None where it is refused, and the time of a processor that it took [s]."""
    curve, scene = random_case(seed)
    path = LearnedPath(f"random-{seed}", "run", 1, 1, curve, Fit(0.0, 0.0, 0.0, 0.0))
    began = time.process_time()
    try:
        made = plan(path, scene, arm=arm)
    except PathRefused:
        return None, time.process_time() - began
    return made, time.process_time() - began


def _largest_use(made: Plan, arm: Arm, model: SerialArm) -> float:
    motion, worst = sample_plan(made, RATE, arm).positions, 0.0
    for kind in ("speed", "acceleration", "jerk"):
        motion = np.diff(motion, axis=0) * RATE
        worst = max(worst, float(np.abs(motion / [getattr(joint, kind).value for joint in model.joints]).max()))
    return worst


if __name__ == "__main__":
    for example in PATH_LENGTHS:
        print_report(f"Arms from models, planned: {example}", measure(example, count=20))
