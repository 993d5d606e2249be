"""A source that follows a topic of ROS 2: poses, a frame of TF, or the joints of an arm that is led by hand."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from queue import Empty, Full, Queue
from typing import Final, Self

from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_client.rest import LOCAL_ADDRESS
from teachpath_client.ros2.messages import BOOL, JOINTS, POSE, TRANSFORMS, Malformed, decode, type_hash
from teachpath_client.ros2.node import Node
from teachpath_client.ros2.readings import (
    Interpreter,
    JointInterpreter,
    Measured,
    PoseInterpreter,
    TransformInterpreter,
)
from teachpath_client.ros2.statistics import TopicStatistics
from teachpath_client.ros2.wire import NO_HASH, Topic
from teachpath_client.station import Station
from teachpath_proto.sample_rules import GRASP_BUTTON

KINDS: Final = (POSE, TRANSFORMS, JOINTS)
STATIC: Final = "/tf_static"
READ_TIMEOUT: Final = 0.1  # [s] a read waits
LOOK_INTERVAL: Final = 0.2  # [s] between looks for the topic
QUEUE_SIZE: Final = 10_000  # messages that wait; over it they are lost, and counted

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Ros2Settings:
    """What is followed."""

    # where rmw_zenohd or zenoh-bridge-ros2dds listens
    router: str
    # of PoseStamped, TF or JointState
    topic: str
    # ROS_DOMAIN_ID
    domain: int = 0
    # [s] to wait for somebody who publishes it
    wait: float = 10.0
    # topic of std_msgs/Bool: the hand grasps
    grasp: str = ""
    # TF: the frame that is followed
    child: str = ""
    # TF: one above it, in which it is told; else the one its own transform is told in
    frame: str = ""
    # JointState: the station whose arm gives the kinematics
    url: str = LOCAL_ADDRESS
    # JointState: before the names of the arm's joints
    prefix: str = ""
    # JointState: joint of the fingers, and its positions
    gripper: str = ""
    # of the open gripper
    opened: float = 0.0
    # of the closed gripper
    closed: float = 0.0


def ros2(**options: str) -> Ros2Source:
    """A topic of ROS 2 over Zenoh, no ROS needed; router=ENDPOINT, topic=NAME, grasp=TOPIC; TF: child=, frame=."""
    return Ros2Source(configure(Ros2Settings, options))


class Ros2Source:
    """Readings of a topic; each has the stamp of its message's header.

    Args:
        settings: what is followed.
        clock: [s] that never runs back.
    """

    def __init__(self, settings: Ros2Settings, *, clock: Callable[[], float] = time.monotonic) -> None:
        if settings.gripper and settings.opened == settings.closed:
            raise ClientError("gripper: say where it is open and where it is closed: opened=, closed=")
        self._settings, self._clock = settings, clock
        self._queue: Queue[tuple[float, Topic, bytes, bytes]] = Queue(QUEUE_SIZE)
        self._statistics = TopicStatistics(settings.topic)
        self._stack = ExitStack()
        self._over = self._grasps = False

    @property
    def capabilities(self) -> Capabilities:
        """Poses, live; the rate is not known before."""
        return Capabilities(rate=0.0, sensors=0, orientation=True, live=True)

    def __enter__(self) -> Self:
        settings = self._settings
        with ExitStack() as stack:
            node = stack.enter_context(Node(settings.router, domain=settings.domain))
            self._topic = self._found(node, settings.topic, KINDS)
            self._interpreter = self._chosen(self._topic)
            node.subscribe(self._topic, self._receiver(self._topic))
            if isinstance(self._interpreter, TransformInterpreter):
                static = Topic(STATIC, TRANSFORMS, self._topic.type_hash, self._topic.bridged)
                node.subscribe(static, self._receiver(static), history=True)
            if settings.grasp:
                grasp = self._found(node, settings.grasp, (BOOL,))
                node.subscribe(grasp, self._receiver(grasp))
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
        self._stack.close()
        for sentence in self._statistics.sentences():
            _log.warning("%s", sentence)

    def close(self) -> None:
        """End the iteration soon."""
        self._over = True

    def __iter__(self) -> Iterator[HandReading]:
        start, last = 0.0, 0
        while not self._over:
            try:
                came, topic, content, attached = self._queue.get(timeout=READ_TIMEOUT)
            except Empty:
                continue
            sent_ns = self._statistics.sent(attached) if topic == self._topic else 0
            measured = self._measured(topic, content)
            if measured is None:
                continue
            stamp = measured.stamp_ns or sent_ns or time.time_ns()
            if stamp <= last:
                self._statistics.repeated += 1
                continue
            start = came if last == 0 else start
            last = stamp
            grasps = self._grasps if measured.grasps is None else measured.grasps
            buttons = GRASP_BUTTON if grasps else 0
            yield HandReading(
                came - start,
                measured.position,
                measured.orientation,
                buttons=buttons,
                device_ns=stamp,
                joints=measured.joints,
            )

    def _measured(self, topic: Topic, content: bytes) -> Measured | None:
        """Return what a message says of the hand; None where it says nothing of it, or is refused."""
        try:
            message = decode(topic.kind, content)
            if topic == self._topic:
                return self._interpreter.read(message)
            if topic.kind == BOOL:
                self._grasps = bool(message.data)
            elif isinstance(self._interpreter, TransformInterpreter):
                self._interpreter.keep(message)
        except Malformed as error:
            if self._statistics.refuse(topic.name):
                _log.warning("%s: a message is refused: %s", topic.name, error)
        return None

    def _receiver(self, topic: Topic) -> Callable[[bytes, bytes], object]:
        def receive(content: bytes, attached: bytes) -> None:
            try:
                self._queue.put_nowait((self._clock(), topic, content, attached))
            except Full:
                self._statistics.overflowed += 1

        return receive

    def _chosen(self, topic: Topic) -> Interpreter:
        settings = self._settings
        if topic.kind == POSE:
            return PoseInterpreter()
        if topic.kind == TRANSFORMS:
            if not settings.child:
                raise ClientError(f"{topic.name} has the transforms of many frames; name the one to follow: child=")
            return TransformInterpreter(settings.child, settings.frame)
        with Station(settings.url) as station:
            robot = station.robot()
        return JointInterpreter(
            robot,
            prefix=settings.prefix,
            gripper=settings.gripper,
            opened=settings.opened,
            closed=settings.closed,
        )

    def _found(self, node: Node, name: str, kinds: tuple[str, ...]) -> Topic:
        """Wait until somebody publishes a topic, and return it; raises ClientError."""
        deadline = self._clock() + self._settings.wait
        while True:
            published = node.published()
            found = next((topic for topic in published if topic.name == name), None)
            if found is not None:
                return _usable(found, kinds)
            if self._over or self._clock() > deadline:
                there = ", ".join(f"{t.name} ({t.kind})" for t in published if t.kind in kinds) or "none"
                raise ClientError(
                    f"nobody publishes {name} at {self._settings.router} in domain {node.domain}; topics of "
                    f"{' or '.join(kinds)} there: {there}"
                )
            time.sleep(LOOK_INTERVAL)


def _usable(topic: Topic, kinds: tuple[str, ...]) -> Topic:
    if topic.kind not in kinds:
        raise ClientError(f"{topic.name} is {topic.kind}, which is not read here; it can be {', '.join(kinds)}")
    ours = type_hash(topic.kind)
    if topic.type_hash not in ("", NO_HASH, ours):
        raise ClientError(
            f"{topic.name} is another version of {topic.kind} ({topic.type_hash}) than is known here ({ours})"
        )
    return topic
