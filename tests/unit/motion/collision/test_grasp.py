"""The gripper takes what its fingers overlap and fit around; the simulated one holds by the same rule."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.collision.grasp import grasp_fault
from teachpath.motion.planning.assessment import assess
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import LearnedPath, Scene, Shape
from teachpath.simulator.arm import SimulatedArm
from teachpath.simulator.settings import SimulatorSettings
from tests.plan_checker.checker import _moved, _surface
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()
TOOL = 0.13  # m, from the flange to the grasp point
WIDTH, TIP, BASE, OPENING = 0.022, 0.135, 0.035, 0.07  # m, of the fingers, in the flange's frame
BLOCK = Shape("block", "box", (0.04, 0.04, 0.04), (0.0, 0.0, 0.0))


def held_at(x: float, y: float, z: float) -> np.ndarray:
    """The pose of an object whose middle is off the grasp point by so much, in the flange's frame."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, TOOL + z
    return pose


def begun(x: float, y: float, z: float) -> tuple[LearnedPath, Scene]:
    """The way through the middle, and the paper's scene with its block off the way's start by so much."""
    scene = paper_scene()
    assert scene.carried is not None
    a, b, c = scene.carried.position
    table = replace(scene.obstacles[0], position=(0.6, 0.0, 0.48 + z))
    carried = replace(scene.carried, position=(a + x, b + y, c + z))
    return way(MIDDLE), replace(scene, obstacles=(table, *scene.obstacles[1:]), carried=carried)


@pytest.mark.parametrize(
    ("off", "fault"),
    [
        ((0.0, 0.0, 0.0), ""),
        ((0.0, 0.0, 0.014), ""),
        ((0.0, 0.0, 0.029), "the fingers miss block by 4 mm along their length"),
        ((0.0, 0.0, 0.018), r"the fingers overlap block by 7 mm along their length, less than 1 cm"),
        ((0.029, 0.0, 0.0), "the fingers overlap block by 2 mm across their width, less than 1 cm"),
        ((0.0, 0.029, 0.0), "block sticks out from between the open fingers by 1.4 cm"),
    ],
)
def test_a_block_is_taken_where_the_fingers_overlap_it_and_nowhere_else(off: tuple[float, ...], fault: str) -> None:
    found = grasp_fault(BLOCK, held_at(*off), ARM)
    assert found.startswith(fault)
    assert bool(found) == bool(fault)


@pytest.mark.parametrize(
    ("shape", "fault"),
    [
        (Shape("bar", "box", (0.02, 0.09, 0.02), (0, 0, 0)), "bar is 9 cm wide there, the fingers open 7 cm"),
        (Shape("coin", "cylinder", (0.02, 0.004), (0, 0, 0)), ""),
        (Shape("pole", "cylinder", (0.02, 0.3), (0, 0, 0)), ""),
        (Shape("ball", "sphere", (0.03,), (0, 0, 0)), ""),
        (Shape("drum", "cylinder", (0.04, 0.05), (0, 0, 0)), "drum is 8 cm wide there"),
    ],
)
def test_what_is_wider_than_the_gripper_opens_is_refused_and_what_is_flat_is_not(shape: Shape, fault: str) -> None:
    found = grasp_fault(shape, held_at(0.0, 0.0, 0.0), ARM)
    assert found.startswith(fault)
    assert bool(found) == bool(fault)


def test_a_ball_is_held_at_its_middle() -> None:
    ball = Shape("ball", "sphere", (0.03,), (0, 0, 0))
    assert "before the middle of ball" in grasp_fault(ball, held_at(0.0, 0.0, 0.012), ARM)
    assert "before the middle of ball" in grasp_fault(ball, held_at(0.013, 0.0, 0.0), ARM)


@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere"])
def test_what_is_taken_is_met_by_both_fingers_as_they_close(kind: str) -> None:
    rng = np.random.default_rng(len(kind))
    taken = 0
    for _ in range(400):
        size = tuple(rng.uniform(0.01, 0.06, {"box": 3, "cylinder": 2, "sphere": 1}[kind]).tolist())
        turn = rng.normal(size=4)
        pose = held_at(*rng.normal(0.0, 0.015, 3))
        pose[:3, :3] = rotation_matrices(turn[None] / np.linalg.norm(turn))[0]
        if grasp_fault(Shape("thing", kind, size, (0, 0, 0)), pose, ARM):
            continue
        taken += 1
        points = _moved(pose, _surface(kind, size))
        assert np.abs(points[:, 1]).max() <= OPENING / 2
        span = [min(high, points[:, k].max()) - max(low, points[:, k].min())
                for k, low, high in ((0, -WIDTH / 2, WIDTH / 2), (2, BASE, TIP))]  # fmt: skip
        assert min(span) > 0.0
    assert taken > 20


@pytest.mark.parametrize("off", [(0.0, 0.0, -0.029), (0.029, 0.0, 0.0), (0.0, 0.029, 0.0)])
def test_a_start_29_mm_off_is_refused_with_the_remedy(off: tuple[float, float, float]) -> None:
    path, scene = begun(*off)
    settings = MotionSettings(rolls=(0.0,))
    with pytest.raises(PathRefused, match=r"starts 2.9 cm .* block .*move control point 1 of \d by 29 mm") as refused:
        plan(path, scene, settings)
    failure = assess(path.curve, scene, settings).failure
    assert failure == refused.value.failure
    assert failure is not None
    assert failure.suggestion.move == pytest.approx(off, abs=1e-9)


def test_the_simulated_gripper_holds_what_a_plan_may_begin_with_and_not_what_it_may_not() -> None:
    rng, verdicts = np.random.default_rng(7), set()
    for _ in range(12):
        path, scene = begun(*rng.uniform(-1.0, 1.0, 3) * [0.025, 0.02, 0.02])
        assert scene.carried is not None
        try:
            q = plan(path, scene).joints[0]
            allowed = True
        except PathRefused as refusal:
            if refusal.failure is None or refusal.failure.fault != "start":
                continue  # it is too near to something else
            q, allowed = plan(path, paper_scene()).joints[0], False
        arm = SimulatedArm(scene, ARM, SimulatorSettings(), q)
        for _ in range(20):
            arm.step(q, np.zeros(6), np.zeros(6))
        assert arm.grasp() or not allowed
        verdicts.add(allowed)
    assert verdicts == {True, False}


def test_the_simulated_gripper_does_not_hold_what_is_29_mm_off() -> None:
    for off in ((0.0, 0.0, -0.029), (0.029, 0.0, 0.0)):
        _, scene = begun(*off)
        q = plan(way(MIDDLE), paper_scene(), MotionSettings(rolls=(0.0,))).joints[0]
        arm = SimulatedArm(scene, ARM, SimulatorSettings(), q)
        arm.step(q, np.zeros(6), np.zeros(6))
        assert not arm.grasp()
