"""Where objects lie: as told last, else as configured; steady while the arm moves or a camera jitters."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from teachpath.errors import NotFound, UnusableInput
from teachpath.io.documents import decode, encode
from teachpath.io.memory_bus import MemoryBus
from teachpath.motion.collision.builtin_scenes import builtin_scenes
from teachpath.records import ObjectPose, Scene, SceneQuery
from teachpath.robot.object_poses import SAME_PLACE, ObjectPoses
from teachpath_proto.keys import Keys

KEYS = Keys()
PAPER = builtin_scenes()["paper"]
OTHER_POSE = ObjectPose((0.5, -0.2, 0.52), (math.cos(0.3), 0.0, 0.0, math.sin(0.3)))


class Seen:
    """The poses of a station whose arm moves when a test says so, and what was said of changes."""

    def __init__(self) -> None:
        self.bus, self.moving = MemoryBus(), False
        self.changes: list[str] = []
        self.poses = ObjectPoses(
            self.bus, KEYS, self.configured, moving=lambda: self.moving, on_change=self.changes.append
        )

    @staticmethod
    def configured(name: str) -> Scene:
        try:
            return builtin_scenes()[name]
        except KeyError:
            raise NotFound(f"there is no scene {name!r}") from None


@pytest.fixture
def seen() -> Iterator[Seen]:
    seen = Seen()
    seen.poses.start()
    yield seen
    seen.poses.stop()


def test_a_scene_is_as_configured_until_its_object_is_told_to_lie_elsewhere(seen: Seen) -> None:
    assert seen.poses.scene("paper") == PAPER
    assert seen.poses.tell("paper", OTHER_POSE) == OTHER_POSE
    assert seen.poses.scene("paper") == PAPER.with_object(OTHER_POSE)
    assert seen.changes == ["paper"]
    seen.poses.forget("paper")
    assert seen.poses.scene("paper") == PAPER
    assert seen.changes == ["paper", "paper"]


def test_the_executor_is_answered_what_stands_in_a_scene_and_where_its_object_lies(seen: Seen) -> None:
    seen.poses.tell("paper", OTHER_POSE)
    answer = seen.bus.ask(KEYS.station_scene, encode(SceneQuery("paper")))
    assert decode(Scene, answer) == PAPER.with_object(OTHER_POSE)
    with pytest.raises(NotFound, match="no scene 'moon'"):
        seen.bus.ask(KEYS.station_scene, encode(SceneQuery("moon")))


def test_a_camera_tells_it_on_the_bus(seen: Seen) -> None:
    seen.bus.publish(KEYS.object("paper"), encode(OTHER_POSE))
    assert seen.poses.pose("paper") == OTHER_POSE
    for nonsense in (b"", b"[]", b'{"position": [NaN, 0, 0]}', encode(ObjectPose((0.0, 0.0, 99.0)))):
        seen.bus.publish(KEYS.object("paper"), nonsense)
    seen.bus.publish(KEYS.object("empty"), encode(OTHER_POSE))
    seen.bus.publish(KEYS.object("moon"), encode(OTHER_POSE))
    assert seen.poses.pose("paper") == OTHER_POSE


def test_what_a_camera_sees_of_a_resting_object_changes_nothing(seen: Seen) -> None:
    seen.poses.tell("paper", OTHER_POSE)
    x, y, z = OTHER_POSE.position
    for off in (0.9, -0.9):
        assert seen.poses.tell("paper", ObjectPose((x + off * SAME_PLACE, y, z), OTHER_POSE.orientation)) == OTHER_POSE
    assert seen.poses.tell("paper", ObjectPose((x + 1.1 * SAME_PLACE, y, z), OTHER_POSE.orientation)) != OTHER_POSE
    assert seen.changes == ["paper", "paper"]


def test_a_scene_stays_as_it_was_while_the_arm_carries_its_object(seen: Seen) -> None:
    seen.moving = True
    assert seen.poses.tell("paper", OTHER_POSE).position == PAPER.carried.position  # type: ignore[union-attr]
    assert seen.changes == []
    seen.moving = False
    assert seen.poses.pose("paper") == OTHER_POSE


@pytest.mark.parametrize(
    ("pose", "sentence"),
    [
        (ObjectPose((0.5, math.nan, 0.5)), "is no position of an object"),
        (ObjectPose((0.5, 0.0, 10.5)), "each within ±10 m"),
        (ObjectPose((0.5, 0.0, 0.5), (0.0, 0.0, 0.0, 0.0)), "is no value of an orientation: write a quaternion"),
        (ObjectPose((0.5, 0.0, 0.5), (math.nan, 0.0, 0.0, 0.0)), "is no value of an orientation: write a quaternion"),
    ],
)
def test_what_is_no_pose_is_refused_and_changes_nothing(seen: Seen, pose: ObjectPose, sentence: str) -> None:
    with pytest.raises(UnusableInput, match=sentence):
        seen.poses.tell("paper", pose)
    assert seen.poses.scene("paper") == PAPER


def test_a_quaternion_is_brought_to_unit_length(seen: Seen) -> None:
    told = seen.poses.tell("paper", ObjectPose((0.5, 0.0, 0.52), (0.995, 0.0, 0.0, 0.0)))
    assert told.orientation == (1.0, 0.0, 0.0, 0.0)


def test_a_scene_without_an_object_has_none_to_tell_of(seen: Seen) -> None:
    with pytest.raises(NotFound, match="scene empty has no object; give it one: teachpath scene add"):
        seen.poses.tell("empty", OTHER_POSE)
