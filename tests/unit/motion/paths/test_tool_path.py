from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableSettings
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import shift_within_limits
from teachpath.motion.paths.tool_path import ArcLength, sample_tool_path
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, Shape
from tests.unit.motion.ways import MIDDLE, clamped, way

ARM = Arm.of_variant()

SETTINGS = MotionSettings()


def test_the_nodes_lie_at_even_arc_lengths() -> None:
    curve = way(MIDDLE).curve
    found = sample_tool_path(curve, SETTINGS)
    assert found.lengths[-1] == pytest.approx(curve.length(), rel=1e-9)
    u = np.linspace(0, 1, 400_001)
    walked = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(curve(u), axis=0), axis=1))]
    at = np.interp(ArcLength(curve).parameters(found.lengths), u, walked)
    np.testing.assert_allclose(at, found.lengths, atol=1e-6)


def test_a_sharp_bend_gets_more_nodes() -> None:
    points = way(MIDDLE).curve.control_points.copy()
    smooth = sample_tool_path(clamped(points), SETTINGS)
    points[4] = points[3] + [0.0, 0.003, 0.0]
    points[5] = points[3] + [0.03, 0.002, 0.0]
    sharp = sample_tool_path(clamped(points), SETTINGS)
    assert len(sharp.lengths) / sharp.lengths[-1] > 1.5 * len(smooth.lengths) / smooth.lengths[-1]


def test_every_candidate_is_continuous_and_on_the_path() -> None:
    found = sample_tool_path(way(MIDDLE).curve, SETTINGS)
    every = enumerate_candidates(found, ARM, SETTINGS)
    assert len(every) == 8 * len(SETTINGS.rolls)
    for candidate in every:
        np.testing.assert_allclose(tool_pose(candidate.joints, ARM)[:, :3, 3], found.positions, atol=1e-9)
        assert candidate.branch.jumps.any() == (np.abs(np.diff(candidate.joints, axis=0)).max() > 0.35)
        inside = np.all((candidate.joints >= ARM.limits.lower) & (candidate.joints <= ARM.limits.upper))
        assert inside == (candidate.limit_excess.max() <= 0)


def test_whole_turns_bring_a_joint_back_into_its_range() -> None:
    inside = np.linspace(ARM.limits.lower + 0.5, ARM.limits.lower + 1.0, 5)
    outside = inside + 2 * np.pi * np.array([1, -1, 1, 2, 0, 1])
    same = shift_within_limits(outside, ARM.limits) % (2 * np.pi)
    np.testing.assert_allclose(same, inside % (2 * np.pi), atol=1e-9)
    shifted = shift_within_limits(
        inside[:, :1].repeat(6, axis=1) * 0 + 2 * np.pi * np.array([3, 1, -1, 2, -2, 5]), ARM.limits
    )
    assert np.all((shifted >= ARM.limits.lower) & (shifted <= ARM.limits.upper))


def test_a_home_outside_the_joint_limits_is_refused() -> None:
    wrong = replace(SETTINGS, home=(0.0, 0.0, 2.0, 0.0, 0.0, 0.0))
    with pytest.raises(UnusableSettings, match=r"motion\.home puts joint 3 to 2\.000 rad"):
        plan(way(MIDDLE), paper_scene(), wrong)


@pytest.mark.parametrize(
    "shape",
    [
        Shape("ball", "sphere", (0.1, 0.1), (0.5, 0.0, 0.6)),
        Shape("cone", "cone", (0.1,), (0.5, 0.0, 0.6)),
        Shape("flat", "box", (0.1, 0.1, 0.0), (0.5, 0.0, 0.6)),
        Shape("cylinder", "box", (0.1, 0.1), (0.5, 0.0, 0.6)),
    ],
)
def test_a_scene_that_cannot_be_built_is_refused(shape: Shape) -> None:
    with pytest.raises(UnusableInput, match=shape.name):
        plan(way(MIDDLE), Scene("odd", (shape,)))
