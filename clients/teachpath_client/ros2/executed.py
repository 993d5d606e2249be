"""What the arm did in executions that have ended, for ROS 2."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any, Final

import numpy as np
from mcap.reader import NonSeekingReader

from teachpath_client.ros2.messages import SECOND, TRAJECTORY, header
from teachpath_client.ros2.node import Node
from teachpath_client.ros2.trajectories import JointMotion, trajectory_fields
from teachpath_client.station import Station
from teachpath_proto.control import ExecutorState
from teachpath_proto.motion_pb2 import JointState

STATES: Final = "states"  # topic of joint states in a recording
MAX_POINTS: Final = 5000  # of what is published
MAX_EXECUTIONS: Final = 20  # executions that are looked at; more do not end between two looks


class ExecutedTrajectories:
    """Publishes what the arm did in every execution that ends from now on.

    Args:
        node: that publishes.
        station: whose arm it is.
        joints: names of the arm's joints, in its order.
        topic: its name.
        bridged: the router is zenoh-bridge-ros2dds.
    """

    def __init__(
        self, node: Node, station: Station, joints: Sequence[str], topic: str, *, bridged: bool = False
    ) -> None:
        self._node, self._station, self._joints = node, station, joints
        self._publisher = node.publisher(topic, TRAJECTORY, bridged=bridged)
        self._ended = self._ended_now()

    def step(self) -> list[str]:
        """Publish what ended since the last call, if somebody subscribes, and return the ids; raises ClientError."""
        ended = self._ended_now()
        new, self._ended = [each for each in ended if each not in self._ended], ended
        published: list[str] = []
        if not new or not self._node.is_subscribed(self._publisher.topic):
            return published
        for execution in reversed(new):
            fields = executed_trajectory(self._station.recorded_execution(execution), self._joints)
            if fields is not None:
                self._publisher.put(**fields)
                published.append(execution)
        return published

    def _ended_now(self) -> list[str]:
        executions = self._station.executions(limit=MAX_EXECUTIONS)
        return [each.id for each in executions if ExecutorState(each.status.state).is_resting]


def executed_trajectory(recording: bytes, joints: Sequence[str], *, most: int = MAX_POINTS) -> dict[str, Any] | None:
    """Return what the arm measured in an execution as fields of a JointTrajectory; None: it measured nothing.

    The header has the stamp of the first point, so that no controller takes it for a motion that is to begin. Where
    there are over `most` joint states, every second, third ... of them is taken.

    Args:
        recording: of an execution, MCAP; of a torn one what is whole.
        joints: names of the arm's joints, in its order.
        most: points, at least 2.
    """
    newest, states = 0, []
    with suppress(Exception):  # a torn file ends with whatever its records, compression or messages raise
        for _, _, message in NonSeekingReader(io.BytesIO(recording)).iter_messages(topics=[STATES]):
            state = JointState.FromString(message.data)
            if state.stamp_ns > newest and len(state.position) == len(joints):
                newest = state.stamp_ns
                states.append(state)
    states = states[:: -(-len(states) // most) or 1]
    if not states:
        return None

    def rows(values: Callable[[JointState], Sequence[float]]) -> np.ndarray[Any, np.dtype[np.float64]]:
        return np.array([values(state) for state in states], np.float64).reshape(len(states), -1)

    begin = states[0].stamp_ns
    times = np.array([state.stamp_ns - begin for state in states]) / SECOND
    motion = JointMotion(times, rows(lambda state: state.position), rows(lambda state: state.velocity))
    efforts = rows(lambda state: state.torque)
    return {"header": header(begin, ""), **trajectory_fields(motion, efforts, joints)}
