"""The command that shows a station's arm to ROS 2."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from threading import Event
from typing import Final

from teachpath_client.errors import ClientError
from teachpath_client.link import Link, given_login
from teachpath_client.rest import LOCAL_ADDRESS
from teachpath_client.ros2.arm_show import ArmShow
from teachpath_client.ros2.bridge import Names
from teachpath_client.ros2.messages import typestore
from teachpath_client.ros2.node import Node
from teachpath_client.station import Station
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role

COMMAND_HELP: Final = (
    "Show a station's arm to ROS 2, no ROS needed here: its joint states and where its tool is, live, what it did in "
    "each execution, tasks as markers, and the trajectory of a plan, once. Without --execute it moves nothing by "
    "itself; but a controller that listens to the topic of the trajectory moves its arm. A topic of ROS 2 as a tracker "
    "is another command: teachpath-client tracker --source ros2 --option router=tcp/127.0.0.1:7447 --option "
    "topic=/vive/pose --option grasp=/vive/trigger --task cup. The "
    "router is rmw_zenohd (`ros2 run rmw_zenoh_cpp rmw_zenohd`) or zenoh-bridge-ros2dds."
)


def add_ros2(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `teachpath-client ros2`."""
    names = Names()
    parser.add_argument("--router", required=True, metavar="ENDPOINT", help="of ROS 2, e.g. tcp/127.0.0.1:7447")
    parser.add_argument("--domain", type=int, default=0, help="ROS_DOMAIN_ID (%(default)s)")
    parser.add_argument("--topics", action="store_true", help="only list what is published there")
    parser.add_argument("--dds", action="store_true", help="the router is zenoh-bridge-ros2dds")
    parser.add_argument("--plan", action="append", default=[], metavar="PLAN", help="certified; publish it; repeatable")
    parser.add_argument(
        "--task",
        action="append",
        default=[],
        metavar="TASK",
        help="its demonstrations and paths as markers; repeatable",
    )
    parser.add_argument(
        "--execute", action="store_true", help="start a --plan whose own trajectory comes by --execute-topic"
    )
    parser.add_argument("--joints-topic", default=names.joints, metavar="NAME", help="(%(default)s)")
    parser.add_argument("--trajectory-topic", default=names.trajectory, metavar="NAME", help="(%(default)s)")
    parser.add_argument("--execute-topic", default=names.asked, metavar="NAME", help="(%(default)s)")
    parser.add_argument("--world-frame", default=names.world, metavar="NAME", help="of TF (%(default)s)")
    parser.add_argument("--tool-frame", default=names.tool, metavar="NAME", help="of TF (%(default)s)")
    parser.add_argument("--url", default=LOCAL_ADDRESS, help="of the station (%(default)s)")
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
    if options.execute and not options.plan:
        raise ClientError("--execute needs the plans that may be asked for: --plan PLAN")
    names = Names(
        joints=options.joints_topic,
        trajectory=options.trajectory_topic,
        asked=options.execute_topic,
        world=options.world_frame,
        tool=options.tool_frame,
    )
    with (
        _ended_by_signals() as ended,
        Station(options.url) as station,
        Node(options.router, domain=options.domain) as node,
        Link(options.endpoint, role=Role.VIEWER, login=given_login(options.login, Role.VIEWER)) as link,
        ExitStack() as stack,
    ):
        show = ArmShow(node, station, names, bridged=options.dds)
        if options.execute:
            stack.enter_context(show.followed(options.plan))
        stack.enter_context(show.joint_states(link, Keys(options.prefix)))
        print(f"showing {show.robot.name} in domain {options.domain}; Ctrl-C ends it", file=sys.stderr)
        show.run(options.plan, options.task, ended)


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
