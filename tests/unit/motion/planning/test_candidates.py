from dataclasses import replace

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import cost
from teachpath.motion.paths.tool_path import sample_tool_path
from teachpath.motion.planning.candidates import clear_candidates, usable_candidates
from teachpath.motion.planning.clearance import SUFFICIENT_CLEARANCE, rough_clearance
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, Shape
from tests.unit.motion.ways import clamped

ARM = Arm.of_variant()
SETTINGS = MotionSettings()
TOOL_PATH = sample_tool_path(clamped(np.linspace([0.5, -0.2, 0.65], [0.5, 0.2, 0.65], 8), degree=5), SETTINGS)


def gate(gap: float) -> Scene:
    """Two posts across the path, each this far from it [m]."""
    posts = (Shape(f"post {x:g}", "cylinder", (0.005, 0.3), (x, 0.0, 0.65)) for x in (0.495 - gap, 0.505 + gap))
    return replace(empty_scene(), obstacles=(*empty_scene().obstacles, *posts))


def clearances(scene: Scene) -> tuple[float, float]:
    """The clearance [m] of the cheapest candidate, and of the one that is taken."""
    model = CollisionModel(scene, ARM)
    usable = usable_candidates(enumerate_candidates(TOOL_PATH, ARM, SETTINGS), SETTINGS)
    taken = clear_candidates(TOOL_PATH, usable, model, SETTINGS)[0]
    assert cost(usable[0], SETTINGS) <= cost(taken, SETTINGS)
    cheapest, best = (rough_clearance(TOOL_PATH, candidate, model, SETTINGS).value for candidate in (usable[0], taken))
    return cheapest, best


def test_a_candidate_with_more_clearance_is_taken_before_one_that_just_keeps_clear() -> None:
    cheapest, taken = clearances(gate(0.063))
    assert SETTINGS.clearance_min < cheapest < SUFFICIENT_CLEARANCE / 2
    assert taken >= SUFFICIENT_CLEARANCE


def test_where_clearance_is_sufficient_the_cheapest_candidate_is_taken() -> None:
    cheapest, taken = clearances(gate(0.09))
    assert cheapest == taken >= SUFFICIENT_CLEARANCE


def test_a_candidate_that_does_not_keep_clear_is_not_taken() -> None:
    cheapest, taken = clearances(gate(0.055))
    assert cheapest < SETTINGS.clearance_min <= taken
