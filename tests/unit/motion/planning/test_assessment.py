"""The quick look at a path agrees with the plan, and what it proposes really helps."""

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import nearest_to_usable
from teachpath.motion.paths.tool_path import control_point_weights, sample_tool_path
from teachpath.motion.planning.assessment import assess
from teachpath.motion.planning.failure import first_failing_range
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Assessment, Scene
from tests.unit.motion.ways import MIDDLE, clamped, gated, learned, wandering, way

ARM = Arm.of_variant()


@pytest.mark.parametrize("curve", [way(MIDDLE, degree=5).curve, wandering(3)])
def test_a_path_that_can_be_planned_is_found_good_and_its_duration_nearly_right(curve: Curve) -> None:
    scene = paper_scene() if np.allclose(curve(0.0), way(MIDDLE).curve(0.0)) else empty_scene()
    looked = assess(curve, scene)
    made = plan(learned(curve), scene)
    assert looked.failure is None
    assert set(looked.faults) == {""}
    assert looked.duration == pytest.approx(made.duration, rel=0.15)
    assert "plan it to be sure" in looked.sentence
    np.testing.assert_allclose(looked.positions, curve(looked.parameters), atol=1e-12)
    np.testing.assert_allclose(np.diff(looked.lengths), looked.lengths[-1] / (len(looked.lengths) - 1), rtol=0.6)


@pytest.mark.parametrize(
    ("curve", "fault"),
    [
        (way(1.1).curve, "reach"),
        (way(0.31).curve, "limit"),
        (way(0.48).curve, "collision"),
        (way(MIDDLE, height=0.505).curve, "collision"),
        (clamped(way(MIDDLE).curve.control_points + np.array([0.0, 0.05, 0.0])), "start"),
    ],
)
def test_a_path_that_is_refused_is_found_wrong_where_the_plan_says(curve: Curve, fault: str) -> None:
    looked = assess(curve, paper_scene())
    assert looked.failure is not None
    failure = looked.failure
    assert (failure.fault, looked.duration) == (fault, None)
    assert failure.interval[0] == failure.s <= failure.interval[1]
    assert f"control point {failure.suggestion.control_point + 1} of 9" in looked.sentence
    inside = (looked.lengths >= failure.interval[0] - 1e-9) & (looked.lengths <= failure.interval[1] + 1e-9)
    assert all(word for word, here in zip(looked.faults, inside, strict=True) if here)
    with pytest.raises(PathRefused) as refused:
        plan(learned(curve), paper_scene())
    assert failure.suggestion.sentence.split(" by ")[0] in str(refused.value)


def test_what_fails_at_a_look_is_refused_and_what_passes_is_planned_but_for_the_moves_there_and_away() -> None:
    found = []
    for seed in range(12):
        curve, scene = gated(seed)
        looked = assess(curve, scene)
        try:
            refused = ""
            assert plan(learned(curve), scene).certificate.branch == looked.branch
        except PathRefused as error:
            refused = str(error)
        if looked.failure is None:
            assert not refused or "ways to the" in refused
            assert set(looked.faults) == {""}
        else:
            assert refused == looked.sentence
            assert "collision" in looked.faults
        found.append(("rolling" in looked.branch, bool(looked.failure)))
    assert {(False, False), (True, False), (False, True)} <= set(found)


def improved(curve: Curve, looked: Assessment) -> Curve:
    """Do what was proposed."""
    assert looked.failure is not None
    points = curve.control_points.copy()
    points[looked.failure.suggestion.control_point] += looked.failure.suggestion.move
    return clamped(points, degree=curve.degree)


@pytest.mark.parametrize(
    ("curve", "scene"),
    [
        (way(0.31).curve, paper_scene()),
        (way(MIDDLE, height=0.505).curve, paper_scene()),
        (way(0.86).curve, empty_scene()),
    ],
)
def test_doing_what_was_proposed_again_and_again_makes_the_path_good(curve: Curve, scene: Scene) -> None:
    for _ in range(8):
        looked = assess(curve, scene)
        if looked.failure is None:
            return
        curve = improved(curve, looked)
    pytest.fail(f"still: {looked.sentence}")


def test_moving_a_control_point_moves_the_curve_by_its_influence() -> None:
    curve = way(MIDDLE).curve
    shares = control_point_weights(curve, 0.37)
    assert shares.sum() == pytest.approx(1.0)
    for k in range(len(shares)):
        points = curve.control_points.copy()
        points[k] += [0.1, 0.0, 0.0]
        moved = clamped(points)(0.37) - curve(0.37)
        np.testing.assert_allclose(moved, [0.1 * shares[k], 0.0, 0.0], atol=1e-12)


def test_the_first_stretch_is_the_first_run() -> None:
    assert first_failing_range(np.array([False, True, True, False, True])) == (1, 2)
    assert first_failing_range(np.array([True, True])) == (0, 1)
    with pytest.raises(ValueError, match="nothing"):
        first_failing_range(np.array([False]))


def test_the_least_wrong_branch_has_the_fewest_wrong_nodes() -> None:
    every = enumerate_candidates(sample_tool_path(way(0.31).curve, MotionSettings()), ARM, MotionSettings())
    chosen = nearest_to_usable(every)
    counts = [np.count_nonzero((c.limit_excess.max(axis=1) > 0) | c.branch.jumps) for c in every]
    assert np.count_nonzero((chosen.limit_excess.max(axis=1) > 0) | chosen.branch.jumps) == min(counts)
