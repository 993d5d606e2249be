from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.execution.motion_preview import preview_motion
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.paths.tool_path import ArcLength
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import MotionPreview, Plan
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()

SETTINGS = MotionSettings()
DWELL = 0.5


@pytest.fixture(scope="module")
def middle() -> Plan:
    return plan(way(MIDDLE), paper_scene())


@pytest.fixture(scope="module")
def motion(middle: Plan) -> MotionPreview:
    return preview_motion(middle, SETTINGS, ARM, dwell=DWELL)


def test_it_is_the_motion_of_the_execution(middle: Plan, motion: MotionPreview) -> None:
    program = PlanProgram(middle, np.array(SETTINGS.home), SETTINGS, ARM, dwell=DWELL)
    executed = []
    while not program.finished:
        executed.append(program.step().position)
    run = np.array(executed)
    assert len(run) * 0.004 == pytest.approx(motion.times[-1], abs=0.1)
    # every configuration that is shown is one that the execution passes, give or take half a period at full speed
    shown = motion.joints[::5]
    nearest = np.abs(run[None] - shown[:, None]).max(axis=2).min(axis=1)
    assert nearest.max() < 0.004 * ARM.limits.speed.max()


def test_it_begins_and_ends_at_home_without_a_jump(motion: MotionPreview) -> None:
    np.testing.assert_allclose(motion.joints[[0, -1]], [SETTINGS.home, SETTINGS.home], atol=1e-9)
    assert np.all(np.abs(np.diff(motion.joints, axis=0)) <= ARM.limits.speed * motion.times[1] * (1 + 1e-9))
    assert [s.name for s in motion.segments][1:5] == [
        "on the way down",
        "closing the gripper",
        "on the path",
        "opening the gripper",
    ]
    assert motion.segments[-1].end == motion.times[-1]


def test_the_object_goes_along_the_learned_path_and_stays_where_it_is_put(middle: Plan, motion: MotionPreview) -> None:
    carried = middle.scene.carried
    assert carried is not None
    path = way(MIDDLE).curve
    on = next(s for s in motion.segments if s.name == "on the path")
    before, behind = motion.times < on.begin, motion.times > on.end
    np.testing.assert_allclose(motion.object_position[before], np.tile(carried.position, (before.sum(), 1)), atol=1e-9)
    assert np.ptp(motion.object_position[behind], axis=0).max() < 1e-9
    wanted = path(ArcLength(path).parameters(motion.progress * middle.lengths[-1]))
    during = ~before & ~behind
    assert np.linalg.norm(motion.object_position - wanted, axis=1)[during].max() < 2e-4
    assert np.linalg.norm(motion.object_position[-1] - tool_pose(middle.joints[-1], ARM)[:3, 3]) < 1e-3
    assert all(motion.gripper_closed[k] for k in np.flatnonzero(during))
    assert not motion.gripper_closed[0]
    assert np.all(np.diff(motion.progress) >= 0)
    assert (motion.progress[0], motion.progress[-1]) == (0.0, 1.0)


def test_without_an_object_there_is_none_and_a_changed_plan_is_refused(middle: Plan) -> None:
    bare = preview_motion(plan(way(MIDDLE), empty_scene()), SETTINGS, ARM, dwell=DWELL)
    assert bare.object_position.shape == (0, 3)
    assert all(bare.gripper_closed)
    with pytest.raises(PathRefused, match="has changed since it was certified"):
        preview_motion(replace(middle, joints=middle.joints + 0.01), SETTINGS, ARM, dwell=DWELL)


def test_a_long_plan_is_shown_with_fewer_instants_a_second(middle: Plan) -> None:
    motion = preview_motion(middle, SETTINGS, ARM, dwell=1000.0)
    assert len(motion.times) == 6000
    assert motion.times[-1] > 2000.0
