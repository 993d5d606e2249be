"""Joint states of bags: the tool moves as the arm's kinematics say; another arm, zero or unit is said."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import FileMotions, ReadOptions
from teachpath.io.readers.registry import read_motions
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.offline.file_samples import Source, read_source
from teachpath.offline.recorded_arm import PUMA_JOINTS, kinematics_of
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array, Calibration
from tests.unit.io.readers import bags
from tests.unit.io.readers.bags import JOINTS, Messages, write_bag
from tests.unit.io.readers.test_bags import motion
from tests.unit.io.readers.test_damage import damaged

ARM = Arm.of_variant()
COUNT = 50
NS = 10**18 + 20_000_000 * np.arange(COUNT)
SHARE = 0.4 + np.linspace(0.0, 1.0, COUNT)[:, None] * [0.1, 0.12, 0.05, -0.1, 0.2, 0.15]  # of the ranges of the joints
ANGLES = ARM.limits.lower + SHARE * (ARM.limits.upper - ARM.limits.lower)
ORDER = [3, 0, 5, 1, 4, 2]  # joints as drivers of ROS publish them: in alphabetical or any other order


def states(
    storage: str, names: tuple[str, ...] = PUMA_JOINTS, angles: Array = ANGLES, topic: str = "/joint_states"
) -> list[tuple[str, str, int, Any]]:
    make = Messages(storage)
    return [(topic, JOINTS, int(ns) + 5, make.joints(int(ns), names, row)) for ns, row in zip(NS, angles, strict=True)]


def read(content: bytes, arm: Arm | None = ARM, **options: str) -> FileMotions:
    known = None if arm is None else kinematics_of(arm)
    return read_motions(content, "f.bag", "", ReadOptions(**options), ImportSettings(), known)  # type: ignore[arg-type]


@pytest.mark.parametrize("storage", bags.STORAGES)
def test_the_tool_is_where_the_arm_s_kinematics_say(tmp_path: Path, storage: str) -> None:
    names = tuple(PUMA_JOINTS[k] for k in ORDER)
    gripper = states(storage, ("finger",), ANGLES[:, :1])  # another publisher on the same topic
    content = write_bag(tmp_path, storage, [*states(storage, names, ANGLES[:, ORDER]), *gripper])
    found = read(content)
    (track,) = found.tracks
    poses = tool_pose(ANGLES, ARM)
    assert np.array_equal(track.stamps_ns, NS)
    assert np.allclose(track.positions, poses[:, :3, 3], atol=1e-12)
    assert track.orientations is not None
    w, x, y, z = track.orientations.T
    axis = np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    assert np.allclose(axis, poses[:, :3, 2], atol=1e-9)
    told = "; ".join(found.understood)
    assert ("/joint_states" in told, "time from the headers" in told, "by its kinematics" in told) == (True, True, True)


def test_joints_become_samples_in_the_robot_s_frame_whatever_the_calibration(tmp_path: Path) -> None:
    source = Source("f.mcap", write_bag(tmp_path, "mcap", states("mcap")))
    askew = Calibration("askew", scale=0.5, offset=(1.0, 2.0, 3.0))
    found = read_source(source, askew, ImportSettings(), RecordingSettings(), ARM)
    assert found.calibration == Calibration("identity")
    assert np.allclose([s.position for s in found.motions[0]], tool_pose(ANGLES, ARM)[:, :3, 3], atol=1e-12)


def test_poses_come_first_and_joints_may_be_chosen(tmp_path: Path) -> None:
    both = write_bag(tmp_path, "mcap", [*motion("mcap"), *states("mcap")])
    assert read(both).choices == ("/hand", "/joint_states")
    assert "PoseStamped" in read(both).understood[1]
    assert len(read(both, track="/joint_states").tracks[0].stamps_ns) == COUNT
    (tmp_path / "two").mkdir()
    two = write_bag(tmp_path / "two", "mcap", [*states("mcap"), *states("mcap", topic="/leader/joint_states")])
    with pytest.raises(UnusableRecording, match="2 topics of joint states; choose one with --track /joint_states or"):
        read(two)


@pytest.mark.parametrize(
    ("names", "angles", "sentence"),
    [
        (("shoulder_pan_joint", *PUMA_JOINTS[1:]), ANGLES, r"its joints are shoulder_pan_joint, .* has joint1, joint2"),
        (PUMA_JOINTS, np.degrees(ANGLES), r"sample 0: joint1 is at -32 rad, outside .* angles in radians\?"),
        (PUMA_JOINTS, np.where(np.arange(COUNT)[:, None] == 7, np.nan, ANGLES), r"sample 7: joint1 is at nan rad"),
        (PUMA_JOINTS, ANGLES[:, :5], r"message 0 of /joint_states: 6 different names and 5 positions"),
        ((PUMA_JOINTS[1], *PUMA_JOINTS[1:]), ANGLES, r"5 different names and 6 positions"),
        (PUMA_JOINTS, ANGLES[:, :0], r"no message of /joint_states has positions of joints"),
    ],
)
def test_what_cannot_be_the_station_s_arm_is_said(
    tmp_path: Path, names: tuple[str, ...], angles: Array, sentence: str
) -> None:
    with pytest.raises(UnusableRecording, match=sentence):
        read(write_bag(tmp_path, "mcap", states("mcap", names, angles)))


def test_units_and_a_missing_arm_are_said(tmp_path: Path) -> None:
    content = write_bag(tmp_path, "mcap", states("mcap"))
    with pytest.raises(UnusableRecording, match="joint states are in radians"):
        read(content, units="mm")
    with pytest.raises(UnusableRecording, match="read where an arm is known"):
        read(content, None)
    with pytest.raises(UnusableRecording, match=r"over 10 messages of /joint_states, the limit \(imports\.max_samples"):
        read_motions(content, "f", "", ReadOptions(), ImportSettings(max_samples=10), kinematics_of(ARM))


def test_a_damaged_bag_of_joints_ends_in_a_sentence_or_in_a_motion(tmp_path: Path) -> None:
    content = write_bag(tmp_path, "db3", states("db3"))
    for number in range(40):
        try:
            found = read(damaged(content, np.random.default_rng(number)))
        except UnusableInput as error:
            assert str(error).startswith("f.bag")  # noqa: PT017
        else:
            assert all(np.isfinite(track.positions).all() for track in found.tracks)


def test_a_tool_that_is_longer_is_elsewhere(tmp_path: Path) -> None:
    content = write_bag(tmp_path, "mcap", states("mcap"))
    longer = read(content, replace(ARM, tool_length=ARM.tool_length + 0.1)).tracks[0].positions
    assert np.allclose(np.linalg.norm(longer - read(content).tracks[0].positions, axis=1), 0.1)
