"""Nothing gets a plan, or a live hand, through the floor or into a zone: judged by points on all surfaces."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.planning.assessment import assess
from teachpath.motion.planning.digest import verify
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan, Scene, Shape
from tests.plan_checker.checker import Solids, judge
from tests.plan_checker.random_cases import streamed
from tests.unit.motion.ways import MIDDLE, clamped, learned, wandering, way

ARM = Arm.of_variant()
SETTINGS = MotionSettings()
HOME = np.array(SETTINGS.home)
OPEN_SCENE = Scene("open")  # no table: the way to the floor is free


def dipping(height: float) -> np.ndarray:
    """Control points of a way that goes down to about a height amid its length."""
    y = np.linspace(-0.25, 0.25, 9)
    z = np.array([0.4, 0.4, 0.3, height, height, height, 0.3, 0.4, 0.4])
    return np.column_stack([np.full(9, 0.55), y, z])


def moves_clear(made: Plan, scene: Scene) -> float:
    """Return the least distance [m] that points on the surfaces keep on the moves to the path and home."""
    bodies = Solids(scene)
    stops = [HOME, made.above_start, made.joints[0], made.joints[-1], made.above_goal, HOME]
    lines = [np.linspace(a, b, 60) for a, b in (stops[0:2], stops[1:3], stops[3:5], stops[4:6])]
    return min(bodies.outside(q) for line in lines for q in line)


@pytest.mark.parametrize("height", [-0.125, -0.03, -0.005])
def test_a_path_through_the_floor_is_refused_with_the_place_and_the_way_out(height: float) -> None:
    curve = clamped(dipping(height), degree=5)
    with pytest.raises(PathRefused, match=r"finger .* the floor.*s = .*move control point \d of 9 by .* up") as refused:
        plan(learned(curve), OPEN_SCENE)
    found = assess(curve, OPEN_SCENE)
    assert refused.value.failure is not None
    assert (refused.value.failure.fault, found.failure and found.failure.fault) == ("collision", "collision")
    lower = replace(OPEN_SCENE, floor=-0.4)
    assert judge(streamed(plan(learned(curve), lower)), curve, lower).clearance >= SETTINGS.clearance_min - 1e-3


def test_doing_what_was_proposed_brings_the_path_off_the_floor() -> None:
    points = dipping(-0.05)
    assert assess(clamped(points, degree=5), OPEN_SCENE).failure is not None
    for _ in range(6):
        found = assess(clamped(points, degree=5), OPEN_SCENE)
        if found.failure is None:
            break
        points[found.failure.suggestion.control_point] += found.failure.suggestion.move
    made = plan(learned(clamped(points, degree=5)), OPEN_SCENE)
    assert made.certificate.clearance.value >= SETTINGS.clearance_min


@pytest.mark.parametrize("seed", range(8))
def test_no_plan_passes_a_zone_between_its_samples(seed: int) -> None:
    rng = np.random.default_rng(seed)
    curve = wandering(seed)
    x, y, z = curve(rng.uniform(0.1, 0.9)) + rng.normal(0.0, 0.05, 3)
    # A needle, a plate of half a millimetre, or a wall that the arm has to keep behind, about where the tool goes.
    needle = Shape("needle", "sphere", (0.0005,), (x, y, z))
    plate = Shape("plate", "box", (0.0005, 0.04, 0.04), (x, y, z - 0.06))
    cell = Shape("cell", "box", (2.4, 2.4, 1.6), (x - 1.2 + rng.uniform(0.0, 0.12), 0.0, 0.8))
    scene = replace(
        empty_scene(), keep_out=((needle,), (plate,), ())[seed % 3], keep_in=(cell,) if seed % 3 == 2 else ()
    )
    try:
        made = plan(learned(curve), scene)
    except PathRefused:
        return
    assert judge(streamed(made), curve, scene, every=3).clearance >= made.certificate.clearance.value - 1e-3
    assert moves_clear(made, scene) >= SETTINGS.clearance_min - 1e-3


def test_the_carried_object_keeps_out_of_a_zone_too() -> None:
    path = way(MIDDLE)
    free = plan(path, paper_scene())
    x, y, z = path.curve(0.5)
    zone = Shape("beam", "box", (0.05, 0.02, 0.02), (x, y, z - 0.03))  # beneath the fingers, within the block
    with pytest.raises(PathRefused, match=r"block .* the keep-out zone beam"):
        plan(path, replace(paper_scene(), keep_out=(zone,)))
    assert free.certificate.clearance.value > SETTINGS.clearance_min


def test_a_plan_holds_for_its_zones_and_no_others() -> None:
    made = plan(way(MIDDLE), paper_scene())
    for changed in (
        replace(made.scene, floor=-0.1),
        replace(made.scene, keep_in=(Shape("cell", "box", (3.0, 3.0, 3.0), (0.0, 0.0, 0.0)),)),
        replace(made.scene, keep_out=(Shape("far", "sphere", (0.1,), (5.0, 0.0, 0.0)),)),
    ):
        with pytest.raises(PathRefused, match="changed"):
            verify(replace(made, scene=changed), ARM)


@pytest.mark.parametrize(
    "scene",
    [
        OPEN_SCENE,
        Scene("low", floor=0.3),
        Scene("cell", keep_in=(Shape("cell", "box", (2.0, 1.0, 1.4), (0.0, 0.0, 0.8)),)),
        Scene("person", keep_out=(Shape("person", "cylinder", (0.15, 2.0), (0.75, 0.15, 1.0)),)),
    ],
    ids=lambda scene: scene.name,
)
def test_a_live_hand_leads_nothing_through_the_floor_or_into_a_zone(scene: Scene) -> None:
    rng = np.random.default_rng(11)
    follower = TeleopFollower(CollisionModel(scene, ARM), HOME, SETTINGS)
    follower.engage(np.zeros(3))
    # First ahead and down, then wherever a hand may be.
    hands = [*([[0.25, 0.1, -0.3]] * 3), *([[0.25, 0.15, -1.0]] * 4), [0.6, 0.15, -0.3], [0.2, 0.7, -0.3]]
    hands += rng.uniform([-0.3, -0.5, -1.0], [0.5, 0.5, 0.1], (12, 3)).tolist()
    sent, reasons = [HOME], set()
    for cycle in range(150 * len(hands)):
        hand = np.array(hands[cycle // 150])
        follower.set_hand(hand, cycle)
        sent.append(follower.step()[0])
        follower.advance_planning()
        reasons.add(follower.reason)
    bodies = Solids(scene)
    assert min(bodies.outside(q) for q in sent[::3]) >= SETTINGS.clearance_min - 1e-3
    assert any("the floor" in reason or "zone" in reason for reason in reasons)
