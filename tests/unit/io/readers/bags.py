"""Bags as the tools of ROS 1 and 2 write them, in all three storages."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from teachpath.records import Array

STORES = {"bag": get_typestore(Stores.ROS1_NOETIC)} | dict.fromkeys(("mcap", "db3"), get_typestore(Stores.ROS2_JAZZY))
STORAGES = tuple(STORES)
SECOND = 1_000_000_000
POSE, COVARIANT = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORM, TRANSFORMS = "geometry_msgs/msg/TransformStamped", "tf2_msgs/msg/TFMessage"
ODOMETRY, TEXT = "nav_msgs/msg/Odometry", "std_msgs/msg/String"
JOINTS = "sensor_msgs/msg/JointState"
STORES["bag"].register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TRANSFORMS))  # of tf2


class Messages:
    """Makes messages of ROS 1 or ROS 2."""

    def __init__(self, storage: str) -> None:
        self.storage, self.store = storage, STORES[storage]

    def make(self, kind: str, stamp_ns: int, position: Array, turn: Array, frame: str, child: str = "hand") -> Any:
        """Return a message of a pose; `turn` is x, y, z, w."""
        point = self._new("geometry_msgs/msg/Point", *position.tolist())
        shift = self._new("geometry_msgs/msg/Vector3", *position.tolist())
        rotation = self._new("geometry_msgs/msg/Quaternion", *turn.tolist())
        header, pose = self._header(stamp_ns, frame), self._new("geometry_msgs/msg/Pose", point, rotation)
        transform = self._new(TRANSFORM, header, child, self._new("geometry_msgs/msg/Transform", shift, rotation))
        match kind:
            case "geometry_msgs/msg/PoseStamped":
                return self._new(kind, header, pose)
            case "geometry_msgs/msg/TransformStamped":
                return transform
            case "tf2_msgs/msg/TFMessage":
                return self._new(kind, [transform])
        spread = np.zeros(36)
        covariant = self._new("geometry_msgs/msg/PoseWithCovariance", pose, spread)
        if kind == COVARIANT:
            return self._new(kind, header, covariant)
        still = self._new("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0)
        twist = self._new("geometry_msgs/msg/Twist", still, still)
        moving = self._new("geometry_msgs/msg/TwistWithCovariance", twist, spread)
        return self._new(ODOMETRY, header, child, covariant, moving)

    def joints(self, stamp_ns: int, names: Sequence[str], angles: Array) -> Any:
        """Return a message of joints that stand still."""
        return self._new(
            JOINTS, self._header(stamp_ns, ""), list(names), np.ascontiguousarray(angles), np.zeros(0), np.zeros(0)
        )

    def text(self, content: str) -> Any:
        """Return a message that is no pose."""
        return self._new(TEXT, content)

    def _header(self, stamp_ns: int, frame: str) -> Any:
        stamp = self._new("builtin_interfaces/msg/Time", *divmod(stamp_ns, SECOND))
        numbered = (0,) if self.storage == "bag" else ()
        return self._new("std_msgs/msg/Header", *numbered, stamp, frame)

    def _new(self, kind: str, *values: Any) -> Any:
        return self.store.types[kind](*values)


def write_bag(folder: Path, storage: str, messages: Sequence[tuple[str, str, int, Any]]) -> bytes:
    """Return the file of a bag of messages: topic, type, when it was recorded [ns], and the message."""
    return bag_file(folder, storage, messages).read_bytes()


def bag_file(folder: Path, storage: str, messages: Iterable[tuple[str, str, int, Any]]) -> Path:
    """Write the file of a bag of messages, one after the other; likewise."""
    store, opened = STORES[storage], dict[tuple[str, str], Any]()
    if storage == "bag":
        with Writer1(folder / "f.bag") as writer1:
            for topic, kind, logged, message in messages:
                if (topic, kind) not in opened:
                    opened[topic, kind] = writer1.add_connection(topic, kind, typestore=store)
                writer1.write(opened[topic, kind], logged, store.serialize_ros1(message, kind))
        return folder / "f.bag"
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer2(folder / "f", version=9, storage_plugin=plugin) as writer2:
        for topic, kind, logged, message in messages:
            if (topic, kind) not in opened:
                opened[topic, kind] = writer2.add_connection(topic, kind, typestore=store)
            writer2.write(opened[topic, kind], logged, store.serialize_cdr(message, kind))
    return next((folder / "f").glob(f"*.{storage}"))
