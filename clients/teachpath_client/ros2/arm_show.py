"""All that a station shows to ROS 2, and when it is published."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from queue import Empty, Full, Queue
from threading import Event, Thread
from typing import Final

from teachpath_client.errors import ClientError
from teachpath_client.link import Link
from teachpath_client.models import Robot
from teachpath_client.ros2.bridge import ArmBridge, Names
from teachpath_client.ros2.executed import ExecutedTrajectories
from teachpath_client.ros2.follower import TrajectoryFollower
from teachpath_client.ros2.markers import TaskMarkers
from teachpath_client.ros2.node import Node
from teachpath_client.ros2.plan_requests import PlanRequests, planned_motion
from teachpath_client.station import Station
from teachpath_proto.keys import Keys

READ_TIMEOUT: Final = 0.1  # [s] a read waits
LOOK_INTERVAL: Final = 0.5  # [s] between looks for somebody who subscribes, and for executions that end
MARKER_INTERVAL: Final = 5.0  # [s] after which markers are published anew: who subscribes later sees them then
OPERATING_TIMEOUT: Final = 10.0  # [s] for an answer to a command
QUEUE_SIZE: Final = 1000  # joint states that wait

_log = logging.getLogger(__name__)


class ArmShow:
    """Publishes what an arm does, plans, executions and tasks.

    Args:
        node: that publishes.
        station: of the arm.
        names: of topics and frames.
        bridged: the router is zenoh-bridge-ros2dds.

    Attributes:
        robot: the arm, as the station describes it.
    """

    def __init__(self, node: Node, station: Station, names: Names, *, bridged: bool = False) -> None:
        self._node, self._station, self._names, self._bridged = node, station, names, bridged
        self.robot: Robot = station.robot()
        self._bridge = ArmBridge(node, self.robot, names, bridged=bridged)

    @contextmanager
    def joint_states(self, link: Link, keys: Keys) -> Iterator[None]:
        """Publish the joint states that come on the station's bus, on a thread of its own."""
        states: Queue[bytes] = Queue(QUEUE_SIZE)
        over = Event()

        def take(payload: bytes) -> None:
            with suppress(Full):  # whoever is behind wants the next ones
                states.put_nowait(payload)

        def pass_on() -> None:
            """Publish what waits, until it is over."""
            while not over.is_set():
                try:
                    self._bridge.publish_state(states.get(timeout=READ_TIMEOUT))
                except Empty:
                    continue
                except ValueError as error:
                    _log.warning("%s", error)

        thread = Thread(target=pass_on, name="joint states")
        thread.start()
        try:
            subscription = link.subscribe(keys.state(self.robot.name), take)
            yield
            subscription.undeclare()
        finally:
            over.set()
            thread.join()

    @contextmanager
    def followed(self, plans: Sequence[str]) -> Iterator[None]:
        """Let these plans be started by topic; raises ClientError where this program may not operate the station."""
        joints, station, names = self._bridge.joints, self._station, self._names
        who = f"ROS 2, domain {self._node.domain}"
        with Station(station.url, timeout=OPERATING_TIMEOUT, operator=who, token=station.token) as operating:
            _require_operator(operating)
            requests = PlanRequests(joints, {plan: planned_motion(station, plan, joints) for plan in plans})
            with TrajectoryFollower(
                self._node,
                operating,
                requests,
                robot=self.robot.name,
                asked=names.asked,
                reported=names.reported,
                bridged=self._bridged,
            ):
                yield

    def run(self, plans: Sequence[str], tasks: Sequence[str], ended: Event) -> None:
        """Publish the rest until the end: plans once, executions as they end, and the markers of tasks."""
        names, node, station = self._names, self._node, self._station
        waiting = {plan: station.program(plan, "cdr") for plan in plans}
        executed = ExecutedTrajectories(node, station, self._bridge.joints, names.executed, bridged=self._bridged)
        markers = TaskMarkers(node, station, tasks, names.markers, names.world, bridged=self._bridged)
        actions = [
            PeriodicAction(LOOK_INTERVAL, lambda: self._publish(waiting)),
            PeriodicAction(LOOK_INTERVAL, executed.step),
        ]
        actions += [PeriodicAction(MARKER_INTERVAL, markers.step)] if tasks else []
        while not ended.wait(READ_TIMEOUT):
            for action in actions:
                action.step()
        for plan in waiting:
            print(f"plan {plan}: not published: nobody listens to {names.trajectory}", file=sys.stderr)

    def _publish(self, waiting: dict[str, bytes]) -> None:
        """Publish the trajectories that wait, as soon as somebody subscribes."""
        for plan, content in list(waiting.items()):
            if self._bridge.publish_trajectory(content):
                del waiting[plan]
                print(f"plan {plan}: published on {self._names.trajectory}", file=sys.stderr)


def _require_operator(station: Station) -> None:
    identity = station.identity()
    if "operate" not in identity.capabilities:
        raise ClientError(
            f"--execute needs a token with the role operate; {identity.name or 'this program'} may "
            f"{', '.join(identity.capabilities) or 'nothing'}; make one with: teachpath token create --role operate "
            "--name ros2"
        )


class PeriodicAction:
    """Does something at an interval, and says when the station refuses it or is away, once until it is back.

    Args:
        interval: [s] between two of them.
        act: what is done; may raise ClientError.
    """

    def __init__(self, interval: float, act: Callable[[], object]) -> None:
        self._interval, self._act = interval, act
        self._due, self._said = 0.0, ""

    def step(self) -> None:
        """Do it, if it is due."""
        if time.monotonic() < self._due:
            return
        try:
            self._act()
            self._said = ""
        except ClientError as error:
            if str(error) != self._said:
                self._said = str(error)
                _log.warning("%s", error)
        self._due = time.monotonic() + self._interval
