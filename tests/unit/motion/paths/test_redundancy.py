"""The redundancy of an arm with seven joints along a path."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE
from teachpath.motion.arm.serial_kinematics import serial_tool_pose
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.paths.enumeration import enumerate_candidates
from teachpath.motion.paths.ik_branches import Candidate, configurations, rolled_poses
from teachpath.motion.paths.redundancy import find_sheets
from teachpath.motion.paths.tool_path import ToolPath, sample_tool_path
from teachpath.motion.planning.candidates import usable_candidates
from teachpath.motion.planning.clearance import rough_clearance
from teachpath.motion.planning.model_arms import with_home
from teachpath.motion.planning.redundancy_search import swivelled_candidates
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve
from teachpath.records import Shape

POINTS = np.array([(0.45, -0.3, 0.65), (0.5, -0.1, 0.75), (0.5, 0.1, 0.7), (0.45, 0.3, 0.65)])
ARM = Arm.of_model(read_arm("seven-axis", base=((0.0, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))), MotionSettings())
SETTINGS = with_home(MotionSettings(), ARM)
PATH = sample_tool_path(Curve(3, np.array([0.0] * 4 + [1.0] * 4), POINTS, np.ones(4)), SETTINGS)


@pytest.fixture(scope="module")
def usable() -> list[Candidate]:
    return usable_candidates(enumerate_candidates(PATH, ARM, SETTINGS), SETTINGS)


def test_a_posture_that_was_shown_decides_on_solution_and_swivel(usable: list[Candidate]) -> None:
    shown = usable[-1].joints  # the dearest
    path = PATH.preferring(shown)
    nearest, *_ = usable_candidates(enumerate_candidates(path, ARM, SETTINGS), SETTINGS, shown)
    off, before = (np.abs(candidate.joints - shown).max() for candidate in (nearest, usable[0]))
    assert off < 0.2
    assert off < before / 2


def misses(q: np.ndarray, poses: np.ndarray) -> float:
    return float(np.abs(serial_tool_pose(q, ARM.model) - poses).max())  # type: ignore[arg-type]


def test_a_sheet_meets_its_poses_with_the_joint_at_its_angles_and_is_continuous() -> None:
    poses = PATH.poses(PATH.parameters)
    sheets = find_sheets([poses], ARM.model)  # type: ignore[arg-type]
    assert len(sheets) >= 3
    for sheet in sheets:
        closed = sheet.off <= POSE_TOLERANCE
        every = np.repeat(poses[sheet.nodes][:, None], len(sheet.angles), axis=1)
        assert misses(sheet.joints[closed], every[closed]) <= POSE_TOLERANCE
        np.testing.assert_array_equal(sheet.joints[:, :, sheet.joint], np.tile(sheet.angles, (len(sheet.nodes), 1)))
        both = closed[1:] & closed[:-1]
        steps = np.abs(np.diff(sheet.joints, axis=0)).max(axis=2)
        assert np.median(steps[both]) < 0.1
    begins = np.array([sheet.joints[0] for sheet in sheets])
    apart = np.abs(begins[:, None] - begins).max(axis=3)
    assert apart[~np.eye(len(sheets), dtype=bool)].max(axis=-1).min() > 0.01  # no sheet comes twice


def test_a_candidate_meets_the_path_between_its_nodes_with_its_joint_on_the_spline(usable: list[Candidate]) -> None:
    u = np.linspace(0.0, 1.0, 333)
    for candidate in usable:
        redundancy = candidate.branch.redundancy
        assert redundancy is not None
        q = configurations(PATH, candidate, u)
        assert misses(q, rolled_poses(PATH.poses(u), candidate.roll(u), ARM)) <= POSE_TOLERANCE
        np.testing.assert_allclose(q[:, redundancy.sheet.joint], redundancy.angle(u), atol=1e-12)
        assert np.all((q >= ARM.limits.lower) & (q <= ARM.limits.upper))
        assert np.abs(np.diff(q, 3, axis=0)).max() < 1e-3  # no kink


def clearance(tool_path: ToolPath, candidate: Candidate, model: CollisionModel) -> float:
    return rough_clearance(tool_path, candidate, model, SETTINGS).value


def test_the_elbow_swivels_around_what_is_in_its_way(usable: list[Candidate]) -> None:
    ball = Shape("ball", "sphere", (0.06,), (0.15, -0.2, 1.1))
    scene = empty_scene()
    model = CollisionModel(replace(scene, obstacles=(*scene.obstacles, ball)), ARM)
    cheapest = usable[:1]
    assert clearance(PATH, cheapest[0], model) < SETTINGS.clearance_min
    (swivelled,) = swivelled_candidates(PATH, cheapest, model, SETTINGS)
    assert clearance(PATH, swivelled, model) >= SETTINGS.clearance_min
    assert swivelled.branch.index == cheapest[0].branch.index
