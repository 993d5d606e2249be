"""Joint states of one topic of a bag of ROS."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import FileMotions, JointTrack, OptionNeeded, Progress, ReadOptions

JOINT_STATE: Final = "sensor_msgs/msg/JointState"
SECOND: Final = 1_000_000_000  # [ns]
REPORT_INTERVAL: Final = 500  # messages, between two reports of progress


@dataclass
class _Angles:
    """What was read of the joints that one publisher names.

    Attributes:
        logged: how many stamps are those of the recording, since the message had none.
    """

    stamps: list[int] = field(default_factory=list)
    rows: list[Any] = field(default_factory=list)
    logged: int = 0


def joint_topics(bag: Any) -> tuple[str, ...]:
    """Return the topics of joint states in a bag, in alphabetical order."""
    return tuple(sorted({connection.topic for connection in bag.connections if connection.msgtype == JOINT_STATE}))


def counted(bag: Any, connections: Sequence[Any], progress: Progress) -> Iterator[tuple[Any, int, bytes]]:
    """Yield connection, time of recording [ns] and content of each message, and tell the share of those that came."""
    total = sum(connection.msgcount for connection in connections)
    for number, message in enumerate(bag.messages(connections=connections)):
        if number % REPORT_INTERVAL == 0 and number < total:
            progress(number / total)
        yield message


def read_joint_states(
    bag: Any, name: str, options: ReadOptions, limits: ImportSettings, progress: Progress
) -> FileMotions:
    """Read the positions of the joints of one topic; `options.track` chooses among several.

    An arm and its gripper often share a topic: messages that name other joints are a track of their own.

    Raises:
        UnusableRecording: a message is wrong, or none has positions; OptionNeeded: there are several topics.
    """
    topics = joint_topics(bag)
    if len(topics) > 1 and not options.track:
        raise OptionNeeded(f"{name}: it holds {len(topics)} topics of joint states", "track", *topics)
    if options.units:
        raise UnusableRecording(f"{name}: joint states are in radians, so that no units can be said of them")
    topic = options.track or topics[0]
    found = _read(bag, topic, name, limits, progress)
    if not found:
        raise UnusableRecording(f"{name}: no message of {topic} has positions of joints")
    for angles in found.values():
        if angles.logged not in (0, len(angles.stamps)):
            raise UnusableRecording(f"{name}: only some messages of {topic} have a stamp; write all with one, or none")
    recorded = any(angles.logged for angles in found.values())
    understood = (
        f"{topic} (sensor_msgs/JointState)",
        "time as recorded: the headers have none" if recorded else "time from the headers",
        "joint angles in rad",
    )
    tracks = [JointTrack(np.array(a.stamps, np.int64), names, np.array(a.rows)) for names, a in found.items()]
    return FileMotions((), understood, joint_tracks=tracks)


def _read(
    bag: Any, topic: str, name: str, limits: ImportSettings, progress: Progress
) -> dict[tuple[str, ...], _Angles]:
    """Return the readings of each set of joints."""
    found: dict[tuple[str, ...], _Angles] = {}
    wanted = [each for each in bag.connections if each.topic == topic and each.msgtype == JOINT_STATE]
    for number, (connection, logged, content) in enumerate(counted(bag, wanted, progress)):
        message = bag.deserialize(content, connection.msgtype)
        names, row = tuple(message.name), np.array(message.position, np.float64)
        if not len(row):
            continue  # speeds or torques alone
        if len(row) != len(names) or len(set(names)) != len(names):
            raise UnusableRecording(
                f"{name}, message {number} of {topic}: {len(set(names))} different names and {len(row)} positions"
            )
        angles = found.setdefault(names, _Angles())
        stamp = int(message.header.stamp.sec) * SECOND + int(message.header.stamp.nanosec)
        angles.logged += not stamp
        angles.stamps.append(stamp or int(logged))
        angles.rows.append(row)
        if number >= limits.max_samples:
            raise UnusableRecording(
                f"{name}: over {limits.max_samples} messages of {topic}, the limit (imports.max_samples); split the bag"
            )
    return found
