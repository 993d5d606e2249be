import random
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.description import describe_arm
from teachpath.motion.arm.kinematics import tool_pose as service_tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath_client.ros2 import messages
from teachpath_client.ros2.messages import Malformed, decode, encode, header, make
from teachpath_client.ros2.poses import tool_pose
from teachpath_client.ros2.readings import JointInterpreter, Measured, PoseInterpreter, TransformInterpreter
from tests.unit.clients.ros2 import golden

HOME = (0.365, 1.663, -3.177, 0.0, -1.628, 0.365)
PUMA = Arm.of_variant()
OFFSET_TOOL = Arm.of_settings(MotionSettings(tool_position=[0.05, -0.02, 0.2], tool_orientation=[0.8, 0.0, 0.6, 0.0]))
NAMES = tuple(f"joint{number}" for number in range(1, 7))


def robot(arm: Arm = PUMA) -> Any:
    return describe_arm(arm, name="puma560", home=HOME)


def joints(positions: dict[str, float]) -> Any:
    empty = np.array([])
    of = {"name": list(positions), "position": np.array(list(positions.values())), "velocity": empty, "effort": empty}
    return make(messages.JOINTS, header=header(golden.STAMP_NS, ""), **of)


def transform(child: str, parent: str, place: tuple[float, float, float], *, stamp: int = 1, w: float = 1.0) -> Any:
    x, y, z = place
    moved = make(
        "geometry_msgs/msg/Transform",
        translation=make("geometry_msgs/msg/Vector3", x=x, y=y, z=z),
        rotation=make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=(1.0 - w * w) ** 0.5, w=w),
    )
    return make(
        "geometry_msgs/msg/TransformStamped", header=header(stamp, parent), child_frame_id=child, transform=moved
    )


def transforms(*parts: Any) -> Any:
    return make(messages.TRANSFORMS, transforms=list(parts))


@pytest.mark.parametrize("content", [golden.POSE, golden.BIG_ENDIAN_POSE])
def test_a_pose_is_read_with_its_stamp_and_its_scalar_first(content: bytes) -> None:
    measured = PoseInterpreter().read(decode(messages.POSE, content))
    assert measured == Measured(golden.STAMP_NS, (1.5, -2.0, 0.5), (0.0, 1.0, 0.0, 0.0))


def test_an_orientation_of_zeros_is_none() -> None:
    measured = PoseInterpreter().read(decode(messages.POSE, golden.POSE[:-32] + bytes(32)))
    assert measured.orientation is None


@pytest.mark.parametrize(
    ("start", "value", "fault"),
    [
        (20, float("nan"), "not finite"),
        (20, 1e9, "are its units metres"),
        (44, 3.0, "no unit quaternion"),
    ],
)
def test_a_pose_that_a_station_would_refuse_is_refused(start: int, value: float, fault: str) -> None:
    damaged = golden.POSE[:start] + np.float64(value).tobytes() + golden.POSE[start + 8 :]
    with pytest.raises(Malformed, match=fault):
        PoseInterpreter().read(decode(messages.POSE, damaged))


def test_messages_are_written_and_read_byte_by_byte() -> None:
    message = decode(messages.JOINTS, golden.JOINTS)
    assert (message.name, message.position.tolist()) == (["j1", "j2"], [1.5, 0.5])
    of = {"name": message.name, "position": message.position, "velocity": message.velocity, "effort": message.effort}
    assert encode(messages.JOINTS, header=message.header, **of) == golden.JOINTS
    assert decode(messages.BOOL, golden.GRASP).data


@pytest.mark.parametrize(("kind", "content"), [(messages.POSE, golden.POSE), (messages.JOINTS, golden.JOINTS)])
def test_a_message_that_is_cut_off_anywhere_is_refused_with_a_sentence(kind: str, content: bytes) -> None:
    for size in range(len(content)):
        with pytest.raises(Malformed, match=r"cut off|CDR follows"):
            decode(kind, content[:size])


@pytest.mark.parametrize(
    ("kind", "content", "interpreter"),
    [
        (messages.POSE, golden.POSE, PoseInterpreter),
        (messages.JOINTS, golden.JOINTS, lambda: JointInterpreter(robot())),
        (messages.TRANSFORMS, encode(messages.TRANSFORMS, transforms=[transform("a", "b", (1.0, 2.0, 3.0))]), None),
    ],
)
def test_damaged_bytes_are_a_reading_or_refused(
    kind: str, content: bytes, interpreter: Callable[[], Any] | None
) -> None:
    chance = random.Random(5)
    read = interpreter() if interpreter else TransformInterpreter("a", "")
    for _ in range(500):
        damaged = bytearray(content)
        for _ in range(chance.randrange(1, 5)):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        with suppress(Malformed):
            measured = read.read(decode(kind, bytes(damaged)))
            assert measured is None or np.isfinite(measured.position).all()


def test_a_message_of_a_megabyte_is_refused_unread() -> None:
    with pytest.raises(Malformed, match="over the limit of 1000000"):
        decode(messages.JOINTS, golden.JOINTS + bytes(1_000_000))


@pytest.mark.parametrize("arm", [PUMA, OFFSET_TOOL])
def test_the_tool_is_where_the_service_says(arm: Arm) -> None:
    for q in np.random.default_rng(2).uniform(-3.0, 3.0, (20, 6)):
        expected = service_tool_pose(q, arm)
        position, turn = tool_pose(robot(arm), dict(zip(NAMES, q, strict=True)))
        assert np.allclose(position, expected[:3, 3], atol=1e-12)
        assert np.allclose(Rotation.from_quat(turn, scalar_first=True).as_matrix(), expected[:3, :3], atol=1e-12)


def test_a_leader_arm_shows_its_tool_and_its_gripper() -> None:
    read = JointInterpreter(robot(), prefix="leader_", gripper="fingers", opened=0.08, closed=0.0)
    posed = {f"leader_{name}": angle for name, angle in zip(NAMES, HOME, strict=True)}
    # It closes beyond 60 % and lets go under 40 %.
    for opening, grasps in ((0.08, False), (0.04, False), (0.02, True), (0.04, True), (0.06, False)):
        measured = read.read(joints({**posed, "fingers": opening}))
        assert measured is not None
        assert measured.grasps is grasps
        assert np.allclose(measured.position, service_tool_pose(np.array(HOME), PUMA)[:3, 3])
        assert measured.joints == HOME
    assert read.read(joints({"fingers": 0.0, "wheel": 1.0})) is None
    with pytest.raises(Malformed, match="no joint leader_joint6"):
        read.read(joints({name: angle for name, angle in posed.items() if name != "leader_joint6"}))


def test_a_frame_is_followed_up_to_another_over_transforms_that_never_change() -> None:
    read = TransformInterpreter("tool", "base")
    half = 0.5**0.5  # a quarter turn about z
    moved = transforms(transform("arm", "base", (1.0, 0.0, 0.0), stamp=7, w=half), transform("x", "y", (0.0,) * 3))
    assert read.read(moved) is None  # the tool's own transform is missing
    read.keep(transforms(transform("tool", "arm", (0.5, 0.0, 0.0))))
    measured = read.read(moved)
    assert measured is not None
    assert measured.stamp_ns == 7
    assert np.allclose(measured.position, (1.0, 0.5, 0.0))
    assert np.allclose(measured.orientation, (half, 0.0, 0.0, half))
    assert read.read(transforms(transform("x", "y", (0.0,) * 3, stamp=9))) is None


def test_frames_in_a_circle_are_no_pose() -> None:
    read = TransformInterpreter("a", "base")
    assert read.read(transforms(transform("a", "b", (0.0,) * 3), transform("b", "a", (0.0,) * 3))) is None
