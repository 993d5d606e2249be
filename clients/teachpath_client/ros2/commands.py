"""The command that shows a station's arm to ROS 2."""

from __future__ import annotations

import argparse
import logging
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from queue import Empty, Full, Queue
from threading import Event
from typing import Final

from teachpath_client.errors import ClientError
from teachpath_client.link import Link, given_login
from teachpath_client.rest import LOCAL
from teachpath_client.ros2.bridge import ArmBridge, Names
from teachpath_client.ros2.messages import typestore
from teachpath_client.ros2.node import Node
from teachpath_client.station import Station
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role

READ_TIMEOUT: Final = 0.1  # [s] a read waits
LOOK_INTERVAL: Final = 0.5  # [s] between looks for somebody who subscribes
QUEUE_SIZE: Final = 1000  # joint states that wait
ABOUT: Final = (
    "Show a station's arm to ROS 2, no ROS needed here: its joint states and where its tool is, live, and the "
    "trajectory of a plan, once. It moves nothing by itself; but a controller that listens to the topic of the "
    "trajectory moves its arm. A topic of ROS 2 as a tracker is another command: teachpath-client tracker --source "
    "ros2 --option router=tcp/127.0.0.1:7447 --option topic=/vive/pose --option grasp=/vive/trigger --task cup. The "
    "router is rmw_zenohd (`ros2 run rmw_zenoh_cpp rmw_zenohd`) or zenoh-bridge-ros2dds."
)

_log = logging.getLogger(__name__)


def add_ros2(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `teachpath-client ros2`."""
    names = Names()
    parser.add_argument("--router", required=True, metavar="ENDPOINT", help="of ROS 2, e.g. tcp/127.0.0.1:7447")
    parser.add_argument("--domain", type=int, default=0, help="ROS_DOMAIN_ID (%(default)s)")
    parser.add_argument("--topics", action="store_true", help="only list what is published there")
    parser.add_argument("--dds", action="store_true", help="the router is zenoh-bridge-ros2dds")
    parser.add_argument("--plan", action="append", default=[], metavar="PLAN", help="certified; publish it; repeatable")
    parser.add_argument("--joints-topic", default=names.joints, metavar="NAME", help="(%(default)s)")
    parser.add_argument("--trajectory-topic", default=names.trajectory, metavar="NAME", help="(%(default)s)")
    parser.add_argument("--world-frame", default=names.world, metavar="NAME", help="of TF (%(default)s)")
    parser.add_argument("--tool-frame", default=names.tool, metavar="NAME", help="of TF (%(default)s)")
    parser.add_argument("--url", default=LOCAL, help="of the station (%(default)s)")
    parser.add_argument("--endpoint", default="tcp/127.0.0.1:7447", help="of the station's bus (%(default)s)")
    parser.add_argument("--prefix", default="teachpath/station", help="of the station's keys (%(default)s)")
    parser.add_argument(
        "--login", metavar="FILE", default="", help="as `teachpath login create --role viewer` wrote it"
    )
    parser.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    typestore()  # without it nothing works, which is said first
    if options.topics:
        with Node(options.router, domain=options.domain) as node:
            for topic in node.published():
                print(f"{topic.name}  {topic.kind}{'  by zenoh-bridge-ros2dds' if topic.bridged else ''}")
        return
    if options.router == options.endpoint:
        raise ClientError(
            f"--router and --endpoint are both {options.router}: the station and the router of ROS 2 are two programs; "
            "let one listen elsewhere, the station by its setting bus.endpoint"
        )
    with Station(options.url) as station:
        robot = station.robot()
        trajectories = {plan: station.program(plan, "cdr") for plan in options.plan}
    names = Names(
        joints=options.joints_topic,
        trajectory=options.trajectory_topic,
        world=options.world_frame,
        tool=options.tool_frame,
    )
    states: Queue[bytes] = Queue(QUEUE_SIZE)
    with (
        _ended_by_signals() as ended,
        Node(options.router, domain=options.domain) as node,
        Link(options.endpoint, role=Role.VIEWER, login=given_login(options.login, Role.VIEWER)) as link,
    ):
        bridge = ArmBridge(node, robot, names, bridged=options.dds)
        subscription = link.subscribe(Keys(options.prefix).state(robot.name), lambda payload: _append(states, payload))
        print(f"showing {robot.name} in domain {options.domain}; Ctrl-C ends it", file=sys.stderr)
        for plan, content in trajectories.items():
            done = bridge.publish_trajectory(content, lambda: _pass_on(bridge, states, ended, LOOK_INTERVAL))
            said = (
                f"published on {names.trajectory}" if done else f"not published: nobody listens to {names.trajectory}"
            )
            print(f"plan {plan}: {said}", file=sys.stderr)
        while _pass_on(bridge, states, ended, LOOK_INTERVAL):
            pass
        subscription.undeclare()


def _append(states: Queue[bytes], payload: bytes) -> None:
    with suppress(Full):  # whoever is behind wants the next ones
        states.put_nowait(payload)


def _pass_on(bridge: ArmBridge, states: Queue[bytes], ended: Event, seconds: float) -> bool:
    """Publish the joint states that come within some seconds; return whether to go on."""
    until = time.monotonic() + seconds
    while not ended.is_set() and (left := until - time.monotonic()) > 0:
        try:
            bridge.publish_state(states.get(timeout=min(left, READ_TIMEOUT)))
        except Empty:
            continue
        except ValueError as error:
            _log.warning("%s", error)
    return not ended.is_set()


@contextmanager
def _ended_by_signals() -> Iterator[Event]:
    """Make an event that the first Ctrl-C or SIGTERM sets."""
    ended, numbers = Event(), (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.signal(number, lambda *_: ended.set()) for number in numbers}
    try:
        yield ended
    finally:
        for number in numbers:
            signal.signal(number, before[number])
