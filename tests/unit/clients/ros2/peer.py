"""A peer that plays rmw_zenoh: it listens as its router does, and says and hears what a node of ROS 2 would."""

from __future__ import annotations

import struct
import time
from typing import Any

import zenoh
import zenoh.ext

from teachpath_proto.sessions import listening, open_session
from tests.ports import free_endpoint

TYPES = {  # of each kind: its name and hash in keys
    "geometry_msgs/msg/PoseStamped": (
        "geometry_msgs::msg::dds_::PoseStamped_/RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"
    ),
    "tf2_msgs/msg/TFMessage": (
        "tf2_msgs::msg::dds_::TFMessage_/RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
    ),
    "sensor_msgs/msg/JointState": (
        "sensor_msgs::msg::dds_::JointState_/RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
    ),
    "std_msgs/msg/Bool": (
        "std_msgs::msg::dds_::Bool_/RIHS01_feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9"
    ),
    "trajectory_msgs/msg/JointTrajectory": (
        "trajectory_msgs::msg::dds_::JointTrajectory_/"
        "RIHS01_179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e"
    ),
    "visualization_msgs/msg/MarkerArray": (
        "visualization_msgs::msg::dds_::MarkerArray_/"
        "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"
    ),
    "diagnostic_msgs/msg/DiagnosticArray": (
        "diagnostic_msgs::msg::dds_::DiagnosticArray_/"
        "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"
    ),
}


class RmwPeer:
    """Use it as a context manager.

    Attributes:
        router: where it listens.
        heard: key, content and attachment of all that others publish.
    """

    def __init__(self) -> None:
        self.router = free_endpoint()
        self.heard: list[tuple[str, bytes, bytes]] = []
        self._session = open_session({**listening([self.router]), "timestamping/enabled": True})
        self._kept: list[Any] = [self._session.declare_subscriber("0/**", self._hear)]
        self._sent: dict[str, int] = {}

    def __enter__(self) -> RmwPeer:
        return self

    def __exit__(self, *_: object) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def announce(self, kind: str, topic: str, message: str, *, number: int = 1) -> None:
        """Show that a node publishes ("MP") or subscribes ("MS") a topic."""
        mangled = topic.replace("/", "%")
        node = f"@ros2_lv/0/{self._session.zid()}/0/{number}/{kind}/%/%/talker"
        self._kept.append(self._session.liveliness().declare_token(f"{node}/{mangled}/{TYPES[message]}/::,7:,:,:,,"))

    def announce_bridged(self, kind: str, topic: str, message: str) -> None:
        """Show it as zenoh-bridge-ros2dds does."""
        name, of = topic.strip("/").replace("/", "§"), message.replace("/", "§")
        key = f"@/{self._session.zid()}/@ros2_lv/{kind}/{name}/{of}/:1:0:0,10"
        self._kept.append(self._session.liveliness().declare_token(key))

    def put(self, topic: str, message: str, content: bytes, *, skip: int = 0) -> None:
        """Publish a message; `skip` numbers before it are never seen."""
        self._sent[topic] = self._sent.get(topic, 0) + 1 + skip
        attachment = struct.pack("<qqB16s", self._sent[topic], time.time_ns(), 16, b"talker")
        key = f"0/{topic.strip('/')}/{TYPES[message]}"
        self._session.put(key, content, attachment=attachment, congestion_control=zenoh.CongestionControl.BLOCK)

    def put_bridged(self, topic: str, content: bytes) -> None:
        """Publish a message as zenoh-bridge-ros2dds does: on the topic's name, without attachment."""
        self._session.put(topic.strip("/"), content, congestion_control=zenoh.CongestionControl.BLOCK)

    def keep(self, topic: str, message: str, content: bytes) -> None:
        """Publish a message that whoever subscribes later gets too (durability transient local)."""
        publisher = zenoh.ext.declare_advanced_publisher(
            self._session,
            f"0/{topic.strip('/')}/{TYPES[message]}",
            cache=zenoh.ext.CacheConfig(1),
            publisher_detection=True,
        )
        publisher.put(content)
        self._kept.append(publisher)

    def tokens(self) -> set[str]:
        """Return the tokens of all that others announce."""
        own = str(self._session.zid())
        replies = self._session.liveliness().get("@ros2_lv/0/**")
        keys = {str(reply.ok.key_expr) for reply in replies if reply.ok is not None}
        return {key for key in keys if own not in key}

    def _hear(self, sample: zenoh.Sample) -> None:
        attachment = sample.attachment
        attached = b"" if attachment is None else attachment.to_bytes()
        self.heard.append((str(sample.key_expr), sample.payload.to_bytes(), attached))
