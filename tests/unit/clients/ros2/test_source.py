"""Topics of a peer that plays rmw_zenoh, over real sockets, as samples on a station's bus."""

import itertools
import struct
import threading
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from teachpath_client.devices import open_source
from teachpath_client.devices.source import Source
from teachpath_client.errors import ClientError
from teachpath_client.link import Link
from teachpath_client.live import record_live
from teachpath_client.reading import HandReading
from teachpath_client.ros2.bridge import ArmBridge, Names
from teachpath_client.ros2.messages import BOOL, JOINTS, POSE, TRAJECTORY, TRANSFORMS, decode, encode
from teachpath_client.ros2.node import Node
from teachpath_client.tracker import Tracker
from teachpath_client.tracker_check.bench import TrackerBench
from teachpath_proto.motion_pb2 import JointState
from teachpath_proto.tracker_pb2 import HandSample
from tests.ports import free_endpoint
from tests.unit.clients.ros2 import golden
from tests.unit.clients.ros2.peer import RmwPeer
from tests.unit.clients.ros2.test_readings import HOME, NAMES, robot, transform
from tests.waiting import wait_until

pytestmark = pytest.mark.system

PERIOD_NS = 20_000_000


@pytest.fixture
def peer() -> Iterator[RmwPeer]:
    with RmwPeer() as peer:
        yield peer


def pose(number: int) -> bytes:
    """Return the golden pose `number` periods later, 0.1 m on for each."""
    return golden.posed(golden.STAMP_NS + number * PERIOD_NS, (0.1 * number, -2.0, 0.5))


def test_poses_become_samples_with_their_own_stamps(peer: RmwPeer, caplog: pytest.LogCaptureFixture) -> None:
    peer.announce("MP", "/vive/pose", POSE)
    peer.announce("MP", "/vive/trigger", BOOL, number=2)
    options = {"router": peer.router, "topic": "/vive/pose", "grasp": "/vive/trigger"}
    endpoint = free_endpoint()
    source = open_source("ros2", options)
    with TrackerBench(endpoint, "lab") as bench, source, Link(endpoint) as link:
        tracker = Tracker(link, "vive", prefix="lab")
        recording = threading.Thread(target=record_live, args=(tracker, source, "cup"))
        recording.start()
        sent = 0

        def samples() -> list[HandSample]:
            return [HandSample.FromString(each.payload) for each in list(bench.seen.received)]

        def put() -> list[HandSample]:  # what is sent before the source is known here is not seen
            nonlocal sent
            sent += 1
            peer.put("/vive/pose", POSE, pose(sent))
            return samples()

        def grasped() -> bool:
            peer.put("/vive/trigger", BOOL, golden.GRASP)
            return any(sample.buttons for sample in put())

        wait_until(put, "poses come")
        wait_until(grasped, "the grasp has come")
        peer.put("/vive/pose", POSE, pose(sent)[:60])  # damaged
        peer.put("/vive/pose", POSE, pose(sent))  # again
        peer.put("/vive/pose", POSE, pose(sent + 1), skip=3)
        last = golden.STAMP_NS + (sent + 1) * PERIOD_NS
        wait_until(lambda: samples()[-1].device_ns == last, "the last one has come")
        source.close()
        recording.join()
    assert bench.seen.announced == {"vive"}
    for number, sample in enumerate(samples(), 1):
        steps, rest = divmod(sample.device_ns - golden.STAMP_NS, PERIOD_NS)
        assert (rest, sample.sequence, sample.tracked) == (0, number, True)
        assert sample.position.x == 0.1 * steps
        assert (sample.position.y, sample.orientation.x) == (-2.0, 1.0)
    assert [samples()[0].buttons, samples()[-1].buttons] == [0, 1]
    for said in (
        "a message is refused: 60 bytes are no geometry_msgs",
        "refused: 1\n",
        "never came",
        "publishers: 3\n",
    ):
        assert said in caplog.text


def first_reading(source: Source, put: Callable[[int], None]) -> HandReading:
    """Call `put` with 1, 2, ... until a reading comes, and return it."""
    found: list[HandReading] = []
    reader = threading.Thread(target=lambda: found.append(next(iter(source))))
    reader.start()
    numbers = itertools.count(1)

    def comes() -> bool:  # what is sent before the source is known here is not seen
        put(next(numbers))
        return bool(found)

    wait_until(comes, "a reading comes")
    reader.join()
    return found[0]


def test_a_bridge_of_dds_is_followed_too(peer: RmwPeer) -> None:
    peer.announce_bridged("MP", "/vive/pose", POSE)
    with open_source("ros2", {"router": peer.router, "topic": "/vive/pose"}) as source:
        first = first_reading(source, lambda number: peer.put_bridged("/vive/pose", pose(number)))
    assert first.device_ns is not None
    assert (first.device_ns - golden.STAMP_NS) % PERIOD_NS == 0


def test_a_leader_arms_tool_is_followed_over_its_fixed_frames(peer: RmwPeer) -> None:
    def put(number: int) -> None:
        moved = transform("arm", "base", (1.0, 0.0, 0.0), stamp=golden.STAMP_NS + number)
        peer.put("/tf", TRANSFORMS, encode(TRANSFORMS, transforms=[moved]))

    peer.announce("MP", "/tf", TRANSFORMS)
    peer.keep("/tf_static", TRANSFORMS, encode(TRANSFORMS, transforms=[transform("tool", "arm", (0.5, 0.0, 0.0))]))
    options = {"router": peer.router, "topic": "/tf", "child": "tool", "frame": "base"}
    with open_source("ros2", options) as source:
        assert first_reading(source, put).position == (1.5, 0.0, 0.0)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"topic": "/nothing", "wait": "0"}, r"nobody publishes /nothing .* there: /tf .*, /vive/pose \(geometry_msgs"),
        ({"topic": "/vive/trigger"}, "/vive/trigger is std_msgs/msg/Bool, which is not read here"),
        ({"topic": "/tf"}, "name the one to follow: child="),
        ({"topic": "/vive/pose", "domain": "300"}, "domain 300 is none of ROS 2: 0 to 232"),
        ({"topic": "/vive/pose", "gripper": "fingers"}, "opened=, closed="),
    ],
)
def test_what_cannot_be_followed_is_said(peer: RmwPeer, options: dict[str, str], sentence: str) -> None:
    peer.announce("MP", "/vive/pose", POSE)
    peer.announce("MP", "/vive/trigger", BOOL, number=2)
    peer.announce("MP", "/tf", TRANSFORMS, number=3)
    with pytest.raises(ClientError, match=sentence), open_source("ros2", {"router": peer.router, **options}):
        pass


def test_a_router_that_is_not_there_is_said() -> None:
    with pytest.raises(ClientError, match="no router of ROS 2 at"):
        Node(free_endpoint(), timeout=0.2)


def test_an_arm_shows_its_joints_its_tool_and_once_a_trajectory(peer: RmwPeer) -> None:
    state = JointState(stamp_ns=golden.STAMP_NS, position=HOME, velocity=[0.1] * 6, torque=[2.0] * 6)
    with Node(peer.router) as node:
        bridge = ArmBridge(node, robot(), Names())
        announced = {token.split("/")[5] + " " + token.split("/")[9] for token in topics(peer)}
        assert announced == {"MP %joint_states", "MP %tf", "MP %teachpath%joint_trajectory"}
        bridge.publish_state(state.SerializeToString())
        assert not bridge.publish_trajectory(b"program")
        peer.announce("MS", "/teachpath/joint_trajectory", TRAJECTORY)
        wait_until(lambda: bridge.publish_trajectory(b"program"), "the subscription is seen")
        with pytest.raises(ValueError, match="6 finite positions"):
            bridge.publish_state(JointState(position=HOME[:5]).SerializeToString())
        with pytest.raises(ValueError, match="no joint state"):
            bridge.publish_state(b"\xff")
        wait_until(lambda: len(peer.heard) == 3, "all came")
    (joints_key, joints, attached), (_, moved, _), (trajectory_key, trajectory, _) = peer.heard
    assert joints_key.startswith("0/joint_states/sensor_msgs::msg::dds_::JointState_/RIHS01_a13ee3a3")
    assert struct.unpack("<q", attached[:8]) == (1,)
    message = decode(JOINTS, joints)
    assert joints[4:12] == golden.JOINTS[4:12]  # the stamp
    assert (tuple(message.name), tuple(message.position), set(message.effort)) == (NAMES, HOME, {2.0})
    (tool,) = decode(TRANSFORMS, moved).transforms
    assert (tool.header.frame_id, tool.child_frame_id) == ("world", "teachpath_tool")
    assert np.isfinite(tool.transform.translation.x)
    assert (trajectory_key.split("/")[1:3], trajectory) == (["teachpath", "joint_trajectory"], b"program")


def topics(peer: RmwPeer) -> list[str]:
    """Return the tokens of topics that others announce, as soon as all three are there."""
    return wait_until(
        lambda: found if len(found := [key for key in peer.tokens() if "/NN/" not in key]) == 3 else [], "tokens came"
    )
