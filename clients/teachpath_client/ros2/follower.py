"""The execution of plans by topic: whoever sends a plan's own trajectory starts that plan, with the bridge's login."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, Full, Queue
from threading import Event, Thread
from typing import Final, Self

from teachpath_client.errors import ClientError
from teachpath_client.models import Execution
from teachpath_client.ros2.messages import DIAGNOSTICS, TRAJECTORY, Malformed, header, make, type_hash
from teachpath_client.ros2.node import Node
from teachpath_client.ros2.plan_requests import PlanRequests
from teachpath_client.ros2.wire import Topic
from teachpath_client.station import Station
from teachpath_proto.control import ExecutorState

QUEUE_SIZE: Final = 10  # messages that wait
READ_TIMEOUT: Final = 0.1  # [s] a read waits
REPORT_INTERVAL: Final = 0.5  # [s] between reports of an execution
OK, WARNING, ERROR = 0, 1, 2  # levels of diagnostic_msgs/DiagnosticStatus
NAME: Final = "teachpath: execution by topic"

_log = logging.getLogger(__name__)


class TrajectoryFollower:
    """Starts plans that are asked for by topic, one at a time, and reports what becomes of each.

    Use it as a context manager; at its end an arm that moves is held on its path.

    Args:
        node: that subscribes and publishes.
        station: that executes; its token has to have the role operate, and it is used for nothing else.
        requests: judges the messages.
        robot: name of the arm, for reports.
        asked, reported: names of the topics of requests and of reports.
        bridged: the router is zenoh-bridge-ros2dds.
        clock: [ns since the Unix epoch].
    """

    def __init__(
        self,
        node: Node,
        station: Station,
        requests: PlanRequests,
        *,
        robot: str,
        asked: str,
        reported: str,
        bridged: bool = False,
        clock: Callable[[], int] = time.time_ns,
    ) -> None:
        self._station, self._requests, self._robot, self._clock = station, requests, robot, clock
        self._queue: Queue[bytes] = Queue(QUEUE_SIZE)
        self._closing, self._moves = Event(), Event()
        self._listener = Thread(target=self._listen, name="requests by topic")
        self._executor: Thread | None = None
        self._publisher = node.publisher(reported, DIAGNOSTICS, bridged=bridged)
        topic = Topic(asked, TRAJECTORY, "" if bridged else type_hash(TRAJECTORY), bridged)
        node.subscribe(topic, self._append)

    def __enter__(self) -> Self:
        self._listener.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._closing.set()
        self._listener.join()
        if self._executor is not None:
            self._executor.join()

    def _append(self, content: bytes, _: bytes) -> None:
        with suppress(Full):  # nobody means to start so many
            self._queue.put_nowait(content)

    def _listen(self) -> None:
        while not self._closing.is_set():
            with suppress(Empty):
                self._judge(self._queue.get(timeout=READ_TIMEOUT))

    def _judge(self, content: bytes) -> None:
        try:
            plan = self._requests.plan_of(content, self._clock())
        except Malformed as error:
            self._report(ERROR, f"refused: {error}")
            return
        if plan is None:
            self._stop()
        elif self._moves.is_set():
            self._report(WARNING, f"refused: an execution is under way; {plan} is not begun", plan=plan)
        else:
            self._moves.set()
            self._executor = Thread(target=self._execute, args=(plan,), name="execution by topic")
            self._executor.start()

    def _stop(self) -> None:
        try:
            status = self._station.stop_arm()
            self._report(OK, "stopped, by a trajectory without points", execution=status.execution)
        except ClientError as error:
            self._report(ERROR, str(error))

    def _execute(self, plan: str) -> None:
        try:
            execution = self._followed(plan)
        except ClientError as error:
            self._moves.clear()
            self._report(ERROR, str(error), plan=plan)
        else:
            self._moves.clear()  # before its end is told: whoever waits for that may ask for the next one
            self._report_execution(execution)

    def _followed(self, plan: str) -> Execution:
        """Execute a plan, in control of the arm meanwhile, and report on it until it has ended."""
        with self._station.control():
            execution = self._station.begin_execution(plan)
            while not ExecutorState(execution.status.state).is_resting:
                self._report_execution(execution)
                if self._closing.wait(REPORT_INTERVAL):
                    raise ClientError("the program that listens to ROS 2 ends, and the arm is held")
                execution = self._station.get_execution(execution.id)
        return execution

    def _report_execution(self, execution: Execution) -> None:
        status = execution.status
        level = ERROR if status.state == "faulted" else WARNING if status.reason else OK
        values = {"plan": execution.plan or "", "execution": execution.id, "state": str(status.state)}
        said = f"{status.state}: {status.reason or status.activity}".rstrip(": ")
        self._report(level, said, **values, progress=f"{status.progress:.3f}")

    def _report(self, level: int, sentence: str, **values: str) -> None:
        if level != OK:
            _log.warning("%s", sentence)
        status = make(
            "diagnostic_msgs/msg/DiagnosticStatus",
            level=level,
            name=NAME,
            message=sentence,
            hardware_id=self._robot,
            values=[make("diagnostic_msgs/msg/KeyValue", key=key, value=value) for key, value in values.items()],
        )
        self._publisher.put(header=header(self._clock(), ""), status=[status])
