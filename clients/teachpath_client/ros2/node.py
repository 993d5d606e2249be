"""A node in the graph of ROS 2: a Zenoh session that shows what it publishes and subscribes."""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import count
from typing import Any, Final

import zenoh
import zenoh.ext

from teachpath_client.errors import ClientError
from teachpath_client.ros2.messages import encode, type_hash
from teachpath_client.ros2.wire import (
    NODE,
    PUBLISHER,
    SUBSCRIPTION,
    Attachment,
    Topic,
    gid_of,
    graph_keys,
    read_token,
    token,
)
from teachpath_proto.sessions import joining, open_session

NAME: Final = "teachpath"
DOMAINS: Final = 233  # 0 to 232, as ROS_DOMAIN_ID
Receive = Callable[[bytes, bytes], object]


class Node:
    """A node in the root namespace, as a client of a router; use it as a context manager.

    Args:
        router: where rmw_zenohd or zenoh-bridge-ros2dds listens, e.g. "tcp/127.0.0.1:7447".
        domain: ROS_DOMAIN_ID.
        name: of the node.
        timeout: [s] to connect in.

    Raises:
        ClientError: nobody listens there, or it is no router; the domain is none.
    """

    def __init__(self, router: str, *, domain: int = 0, name: str = NAME, timeout: float = 10.0) -> None:
        if not 0 <= domain < DOMAINS:
            raise ClientError(f"domain {domain} is none of ROS 2: 0 to {DOMAINS - 1}")
        self.domain: int = domain
        self._name = name
        try:
            self._session = open_session(joining(router, None, timeout=timeout))
        except zenoh.ZError as error:
            raise ClientError(
                f"no router of ROS 2 at {router}: is `ros2 run rmw_zenoh_cpp rmw_zenohd` (or zenoh-bridge-ros2dds) "
                f"running there? A station of teachpath listens at tcp/127.0.0.1:7447 too, unless its bus.endpoint "
                f"says otherwise ({error})"
            ) from error
        self._id, self._numbers = str(self._session.zid()), count(1)
        self._kept: list[Any] = [self._announce(token(NODE, domain, self._id, 0, name))]

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *_: object) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def published(self) -> list[Topic]:
        """Return the topics that somebody publishes, by name."""
        return sorted(self._announced(PUBLISHER), key=lambda topic: (topic.name, topic.bridged))

    def is_subscribed(self, topic: Topic) -> bool:
        """Tell whether somebody subscribes to messages of this topic and kind."""
        return any((each.name, each.kind) == (topic.name, topic.kind) for each in self._announced(SUBSCRIPTION))

    def subscribe(self, topic: Topic, receive: Receive, *, history: bool = False) -> None:
        """Call `receive` with content and attachment of each message; it runs on Zenoh's thread and only appends.

        So messages of several topics come in the order in which the router sent them: a grasp before its pose.

        `history`: also with what was published before, where the publisher keeps it (durability transient local).
        """

        def take(sample: zenoh.Sample) -> None:
            attachment = sample.attachment
            receive(sample.payload.to_bytes(), b"" if attachment is None else attachment.to_bytes())

        kept = zenoh.ext.HistoryConfig(detect_late_publishers=True) if history else None
        # With a thread for each subscriber, which is the default, topics would overtake each other.
        handler = zenoh.handlers.Callback(take, indirect=False)
        key = topic.key(self.domain)
        self._kept.append(zenoh.ext.declare_advanced_subscriber(self._session, key, handler, history=kept))
        if not topic.bridged:
            self._kept.append(self._announce(token(SUBSCRIPTION, *self._identity(), topic)))

    def publisher(self, name: str, kind: str, *, bridged: bool = False) -> Publisher:
        """Publish messages of a kind on a topic; `bridged` where the router is zenoh-bridge-ros2dds."""
        topic = Topic(name, kind, "" if bridged else type_hash(kind), bridged)
        announced = token(PUBLISHER, *self._identity(), topic)
        if not bridged:
            self._kept.append(self._announce(announced))
        declared = self._session.declare_publisher(
            topic.key(self.domain), congestion_control=zenoh.CongestionControl.BLOCK
        )
        return Publisher(declared, topic, gid_of(announced))

    def _identity(self) -> tuple[int, str, int, str]:
        return self.domain, self._id, next(self._numbers), self._name

    def _announce(self, key: str) -> Any:
        return self._session.liveliness().declare_token(key)

    def _announced(self, kind: str) -> set[Topic]:
        found = set()
        for key in graph_keys(self.domain):
            for reply in self._session.liveliness().get(key):
                read = read_token(str(reply.ok.key_expr)) if reply.ok is not None else None
                if read is not None and read[0] == kind:
                    found.add(read[1])
        return found


class Publisher:
    """Publishes on one topic.

    Attributes:
        topic: itself.
    """

    def __init__(self, declared: zenoh.Publisher, topic: Topic, gid: bytes) -> None:
        self._declared, self._gid = declared, gid
        self.topic: Topic = topic
        self._numbers = count(1)

    def put(self, **fields: Any) -> None:
        """Publish a message of these fields."""
        self.put_encoded(encode(self.topic.kind, **fields))

    def put_encoded(self, content: bytes) -> None:
        """Publish a message that is written already."""
        attachment = Attachment(next(self._numbers), time.time_ns(), self._gid)
        self._declared.put(content, attachment=None if self.topic.bridged else attachment.pack())
