"""How ROS 2 lies on Zenoh: the keys of topics, the tokens of its graph, and what is attached to a message.

rmw_zenoh puts a topic on `<domain>/<topic>/<type>/<hash of the type>`, announces whoever publishes or subscribes by a
liveliness token below `@ros2_lv`, and attaches a number, a stamp and the publisher's id to each message (its design
document, docs/design.md). zenoh-bridge-ros2dds puts it on its name alone, with tokens of its own and no attachment.
"""

from __future__ import annotations

import hashlib
import struct
from dataclasses import dataclass
from typing import Final

GRAPH: Final = "@ros2_lv"
NODE, PUBLISHER, SUBSCRIPTION = "NN", "MP", "MS"  # kinds of tokens
NO_HASH: Final = "TypeHashNotSupported"  # what Humble says in a hash's place
QOS: Final = "::,10:,:,:,,"  # reliable, volatile, the last ten are kept; what is not named is rmw_zenoh's default
GID_SIZE: Final = 16
_FIELDS: Final = struct.Struct(f"<qqB{GID_SIZE}s")  # zenoh's serialization: a length goes before the bytes
_NAMES: Final = (b"sequence_number", b"source_timestamp", b"source_gid")  # before each field, in rmw_zenoh up to 0.2.3
_BRIDGE_SLASH: Final = "§"
_NODE_TOKEN_LENGTH, _TOPIC_TOKEN_LENGTH, _BRIDGE_TOKEN_LENGTH = 9, 13, 7  # segments


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic as somebody publishes or subscribes it.

    Attributes:
        name: with its slash, e.g. "/vive/pose".
        kind: of its messages, e.g. "geometry_msgs/msg/PoseStamped".
        type_hash: of that message's definition (RIHS01); empty behind a bridge, which tells none.
        bridged: by zenoh-bridge-ros2dds.
    """

    name: str
    kind: str
    type_hash: str = ""
    bridged: bool = False

    def key(self, domain: int) -> str:
        """Return the Zenoh key of its messages; `domain` is ROS_DOMAIN_ID."""
        name = self.name.strip("/")
        return name if self.bridged else f"{domain}/{name}/{_dds_name(self.kind)}/{self.type_hash}"


@dataclass(frozen=True, slots=True)
class Attachment:
    """What goes with a message.

    Attributes:
        sequence: counts up by one per message of a publisher.
        stamp_ns: when it was published [ns since the Unix epoch].
        gid: id of the publisher, `GID_SIZE` bytes.
    """

    sequence: int
    stamp_ns: int
    gid: bytes

    def pack(self) -> bytes:
        """Return its bytes, as rmw_zenoh 0.2.4 and later read them."""
        return _FIELDS.pack(self.sequence, self.stamp_ns, GID_SIZE, self.gid)

    @classmethod
    def unpack(cls, content: bytes) -> Attachment:
        """Read an attachment, also one with named fields; raises ValueError where it is none."""
        plain = content
        for name in _NAMES if len(content) != _FIELDS.size else ():
            plain = plain.replace(bytes([len(name)]) + name, b"", 1)
        if len(plain) != _FIELDS.size:
            raise ValueError(f"an attachment of {len(content)} bytes is none of rmw_zenoh's")
        sequence, stamp, size, gid = _FIELDS.unpack(plain)
        if size != GID_SIZE:
            raise ValueError(f"the publisher's id in an attachment has {size} bytes instead of {GID_SIZE}")
        return cls(sequence, stamp, gid)


def token(kind: str, domain: int, session: str, number: int, node: str, topic: Topic | None = None) -> str:
    """Return the key of a liveliness token.

    Args:
        kind: `NODE`, `PUBLISHER` or `SUBSCRIPTION`.
        domain: ROS_DOMAIN_ID.
        session: id of the Zenoh session, hexadecimal.
        number: of what is announced, unique in the session; the node has 0.
        node: its name, in the root namespace.
        topic: that is published or subscribed.
    """
    segments = [GRAPH, str(domain), session, "0", str(number), kind, "%", "%", node]
    if topic is not None:
        segments += [topic.name.replace("/", "%"), _dds_name(topic.kind), topic.type_hash, QOS]
    return "/".join(segments)


def read_token(key: str) -> tuple[str, Topic] | None:
    """Return the kind of a token of either form, and its topic; None where it announces no topic."""
    segments = key.split("/")
    if len(segments) == _TOPIC_TOKEN_LENGTH and segments[0] == GRAPH:
        name, dds_name, type_hash = segments[9:12]
        return segments[5], Topic(name.replace("%", "/"), _ros_name(dds_name), type_hash)
    if len(segments) == _BRIDGE_TOKEN_LENGTH and (segments[0], segments[2]) == ("@", GRAPH):
        name, kind = (segment.replace(_BRIDGE_SLASH, "/") for segment in segments[4:6])
        return segments[3], Topic(f"/{name}", kind, bridged=True)
    return None


def graph_keys(domain: int) -> tuple[str, str]:
    """Return the keys of all tokens: those of rmw_zenoh in a domain, and those of bridges."""
    return f"{GRAPH}/{domain}/**", f"@/*/{GRAPH}/**"


def gid_of(announced: str) -> bytes:
    """Return an id for the publisher that a token announces; the same token has the same id."""
    return hashlib.blake2b(announced.encode(), digest_size=GID_SIZE).digest()


def _dds_name(kind: str) -> str:
    """Return e.g. "std_msgs::msg::dds_::String_" for "std_msgs/msg/String"."""
    package, folder, name = kind.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def _ros_name(dds_name: str) -> str:
    return dds_name.replace("::dds_::", "::").removesuffix("_").replace("::", "/")
