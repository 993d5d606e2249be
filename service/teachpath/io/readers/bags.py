"""Bags of ROS 2 (MCAP, SQLite) and of ROS 1: poses, transforms or joint states of one topic as a motion."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import numpy as np

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.bag_joints import JOINT_STATE, SECOND, counted, joint_topics, read_joint_states
from teachpath.io.readers.contract import (
    UNITS,
    FileMotions,
    OptionNeeded,
    Progress,
    Reader,
    ReadOptions,
    Track,
    unheard,
)

MCAP_HEAD: Final = b"\x89MCAP0\r\n\x01"  # its magic, and the opcode of its header
SQLITE_HEAD, BAG_HEAD = b"SQLite format 3\0", b"#ROSBAG V"
PROFILE: Final = "ros2"  # what the header of a bag in MCAP says of itself


@dataclass
class _Readings:
    """What was read of one track.

    Attributes:
        frame: in which the positions are.
        kind: of the messages.
        logged: how many stamps are those of the recording, since the message had none.
    """

    frame: str
    kind: str
    stamps: list[int] = field(default_factory=list)
    poses: list[tuple[float, ...]] = field(default_factory=list)
    logged: int = 0


def is_bag(content: bytes) -> bool:
    """Tell whether content is a bag of ROS; an MCAP file is one if its header says so."""
    if content.startswith(MCAP_HEAD):
        size = content[len(MCAP_HEAD) + 8 : len(MCAP_HEAD) + 12]  # behind the length of the record
        return content[len(MCAP_HEAD) + 12 :].startswith(PROFILE.encode()) and size == struct.pack("<I", len(PROFILE))
    return content.startswith((SQLITE_HEAD, BAG_HEAD))


def read_bag(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read a bag that is in memory; as `read_bag_file`."""
    with TemporaryDirectory(prefix="teachpath-") as folder:
        file = Path(folder) / "bag"
        file.write_bytes(content)
        return read_bag_file(file, name, options, limits, unheard)


def read_bag_file(
    file: Path, name: str, options: ReadOptions, limits: ImportSettings, progress: Progress
) -> FileMotions:
    """Read the poses of one topic, or of one child frame of transforms; `options.track` chooses among several.

    Joint states are read where their topic is chosen, or where there are no poses. Stamps are those of the messages'
    headers; where they are zero, when the message was recorded.

    Raises:
        UnusableRecording: the bag is damaged, or holds no motion; OptionNeeded: those of several.
        UnusableInput: rosbags is not installed.
    """
    with _opened(file, name) as bag:
        poses = [connection for connection in bag.connections if connection.msgtype in POSES]
        joints = joint_topics(bag)
        if options.track in joints or (joints and not poses):
            states = read_joint_states(bag, name, options, limits, progress)
            return replace(states, choices=_choices(poses, joints, ()))
        if not poses:
            held = sorted({connection.msgtype.replace("/msg/", "/") for connection in bag.connections})
            known = ", ".join(kind.replace("/msg/", "/") for kind in (*POSES, JOINT_STATE))
            raise UnusableRecording(f"{name}: no topic of {known} in it; it holds {', '.join(held) or 'none'}")
        wanted = [connection for connection in poses if options.track in ("", connection.topic)] or poses
        found = _read(bag, wanted, name, limits, progress)
    track, readings = _chosen(found, options.track, name, joints)
    unit = options.units or "m"
    poses_ = np.array(readings.poses)
    clock = "time from the headers" if not readings.logged else "time as recorded: the headers have none"
    understood = (
        f"{track} ({readings.kind.replace('/msg/', '/')})",
        clock,
        f"position in {unit}, frame {readings.frame or 'not named'}",
        "orientation as x, y, z, w",
    )
    positions, turns = poses_[:, :3] * UNITS[unit], poses_[:, [6, 3, 4, 5]]
    choices = _choices(poses, joints, found)
    return FileMotions([Track(np.array(readings.stamps, np.int64), positions, turns)], understood, choices=choices)


def _choices(poses: list[Any], joints: Iterable[str], found: Iterable[str]) -> tuple[str, ...]:
    """Return what may be chosen, if there is a choice; child frames of transforms are known when they were read."""
    names = {connection.topic for connection in poses if connection.msgtype not in TRANSFORMS} | {*joints, *found}
    return tuple(sorted(names)) if len(names) > 1 else ()


@contextmanager
def _opened(file: Path, name: str) -> Iterator[Any]:
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ModuleNotFoundError as error:
        raise UnusableInput(
            f"{name} is a bag, which needs {error.name}, which is not installed; install it with: pip install "
            "'teachpath[ros]'"
        ) from None
    with file.open("rb") as stream:
        head = stream.read(len(SQLITE_HEAD))
    suffix = ".mcap" if head.startswith(MCAP_HEAD) else ".db3" if head.startswith(SQLITE_HEAD) else ".bag"
    with TemporaryDirectory(prefix="teachpath-") as folder:
        named = Path(folder) / f"file{suffix}"  # by its ending the library tells the storage
        named.symlink_to(file.resolve())
        try:
            with AnyReader([named], default_typestore=get_typestore(Stores.LATEST)) as bag:
                yield bag
        except MemoryError:  # the length of a record is wrong, or right and too large
            raise UnusableRecording(
                f"{name}: the bag is damaged, or needs more memory than there is (jobs.max_file_memory); "
                "check it, or split it"
            ) from None


def _read(
    bag: Any, connections: list[Any], name: str, limits: ImportSettings, progress: Progress
) -> dict[str, _Readings]:
    """Return the readings of each topic, of transforms those of each child frame."""
    found: dict[str, _Readings] = {}
    count = 0
    for connection, logged, content in counted(bag, connections, progress):
        kind = connection.msgtype
        for header, child, position, turn in POSES[kind](bag.deserialize(content, kind)):
            readings = found.setdefault(child or connection.topic, _Readings(header.frame_id, kind))
            if readings.frame != header.frame_id:
                raise UnusableRecording(
                    f"{name}: {child or connection.topic} is in the frame {readings.frame} and in {header.frame_id}; "
                    "write it in one frame"
                )
            stamp = int(header.stamp.sec) * SECOND + int(header.stamp.nanosec)
            readings.logged += not stamp
            readings.stamps.append(stamp or int(logged))
            readings.poses.append((position.x, position.y, position.z, turn.x, turn.y, turn.z, turn.w))
            count += 1
            if count > limits.max_samples:
                problem = f"{name}: over {limits.max_samples} poses, the limit (imports.max_samples)"
                raise OptionNeeded(problem, "track", *sorted(found))
    return found


def _chosen(found: dict[str, _Readings], wanted: str, name: str, joints: tuple[str, ...]) -> tuple[str, _Readings]:
    names = sorted({*found, *joints})
    if wanted and wanted not in found:
        raise OptionNeeded(f"{name}: no {wanted!r} in it", "track", *names)
    if not found and joints:
        raise OptionNeeded(f"{name}: its topics of poses hold no messages", "track", *joints)
    if not found:
        raise UnusableRecording(f"{name}: its topics of poses hold no messages")
    if len(found) > 1 and not wanted:
        raise OptionNeeded(f"{name}: it holds {len(names)} of them", "track", *names)
    track = wanted or next(iter(found))
    if found[track].logged not in (0, len(found[track].stamps)):
        raise UnusableRecording(f"{name}: only some messages of {track} have a stamp; write all with one, or none")
    return track, found[track]


def _stamped_pose(message: Any) -> Iterable[tuple[Any, str, Any, Any]]:
    yield message.header, "", message.pose.position, message.pose.orientation


def _covariant_pose(message: Any) -> Iterable[tuple[Any, str, Any, Any]]:
    yield message.header, "", message.pose.pose.position, message.pose.pose.orientation


def _transform(message: Any) -> Iterable[tuple[Any, str, Any, Any]]:
    yield message.header, "", message.transform.translation, message.transform.rotation


def _transforms(message: Any) -> Iterable[tuple[Any, str, Any, Any]]:
    for each in message.transforms:
        yield each.header, each.child_frame_id, each.transform.translation, each.transform.rotation


TRANSFORMS: Final = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")  # whose tracks are their child frames
# Of each message: header, child frame where there are several, position and orientation.
POSES: Final = {
    "geometry_msgs/msg/PoseStamped": _stamped_pose,
    "geometry_msgs/msg/PoseWithCovarianceStamped": _covariant_pose,
    "geometry_msgs/msg/TransformStamped": _transform,
    "nav_msgs/msg/Odometry": _covariant_pose,
    "tf2_msgs/msg/TFMessage": _transforms,
    "tf/msg/tfMessage": _transforms,  # in old bags of ROS 1
}

ROSBAG = Reader("rosbag", "bag of ROS 1 or 2", read_bag, lambda content, name: is_bag(content), read_file=read_bag_file)
