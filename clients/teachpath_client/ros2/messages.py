"""The messages of ROS 2, by their definitions in rosbags: bytes in CDR to objects, and back."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

from teachpath_client.errors import ClientError

POSE: Final = "geometry_msgs/msg/PoseStamped"
TRANSFORMS: Final = "tf2_msgs/msg/TFMessage"
JOINTS: Final = "sensor_msgs/msg/JointState"
TRAJECTORY: Final = "trajectory_msgs/msg/JointTrajectory"
BOOL: Final = "std_msgs/msg/Bool"
MARKERS: Final = "visualization_msgs/msg/MarkerArray"
DIAGNOSTICS: Final = "diagnostic_msgs/msg/DiagnosticArray"
SECOND: Final = 1_000_000_000  # [ns]
MAX_SIZE: Final = 1_000_000  # bytes; a JointState of 100 joints has 5,000


class Malformed(ValueError):
    """Bytes are not the message that they should be."""


@cache
def typestore() -> Any:
    """Return the definitions of messages.

    Raises:
        ClientError: rosbags is not installed.
    """
    try:
        from rosbags.typesys import Stores, get_typestore
    except ModuleNotFoundError as error:
        raise ClientError(
            f"ROS 2 needs {error.name}, which is not installed; install it with: pip install 'teachpath[ros]'"
        ) from None
    return get_typestore(Stores.LATEST)


def type_hash(kind: str) -> str:
    """Return the hash of a message's definition, as ROS 2 has it in its keys."""
    return str(typestore().hash_rihs01(kind))


def decode(kind: str, payload: bytes, *, largest: int = MAX_SIZE) -> Any:
    """Read a message of at most `largest` bytes; raises `Malformed` with the reason."""
    if len(payload) > largest:
        raise Malformed(f"a message of {len(payload)} bytes is over the limit of {largest}")
    if len(payload) < 4 or payload[0] != 0 or payload[1] not in (0, 1):
        raise Malformed(f"{payload[:4].hex(' ') or 'nothing'} in front does not say that CDR follows")
    try:
        return typestore().deserialize_cdr(payload, kind)
    except Exception as error:  # of strangers' bytes the library says only that it cannot read them
        raise Malformed(f"{len(payload)} bytes are no {kind}: cut off or damaged ({type(error).__name__})") from None


def encode(kind: str, **fields: Any) -> bytes:
    """Write a message, its parts as `make` makes them."""
    return bytes(typestore().serialize_cdr(make(kind, **fields), kind))


def make(kind: str, **fields: Any) -> Any:
    """Return a message, or a part of one, as an object."""
    return typestore().types[kind](**fields)


def header(stamp_ns: int, frame: str) -> Any:
    """Return a Header; the stamp is in nanoseconds since the Unix epoch."""
    seconds, nanoseconds = divmod(stamp_ns, SECOND)
    stamp = make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
    return make("std_msgs/msg/Header", stamp=stamp, frame_id=frame)


def stamp_of(head: Any) -> int:
    """Return the stamp of a Header [ns since the Unix epoch]; 0: it has none."""
    return int(head.stamp.sec) * SECOND + int(head.stamp.nanosec)
