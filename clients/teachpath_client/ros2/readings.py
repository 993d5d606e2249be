"""What a message of ROS 2 says of a hand: where it is, how it is turned, and whether it grasps."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from teachpath_client.models import Robot
from teachpath_client.reading import Quaternion, Vector
from teachpath_client.ros2.messages import Malformed, stamp_of
from teachpath_client.ros2.poses import Pose, composed, joint_name, tool_pose
from teachpath_client.rotations import unit
from teachpath_proto.sample_rules import NOT_MEASURED, sample_fault

MAX_FRAMES = 10_000  # of TF that are kept
GRASP_THRESHOLD, RELEASE_THRESHOLD = (
    0.6,
    0.4,
)  # share by which a gripper is closed, over which it grasps and under which it lets go


@dataclass(frozen=True, slots=True)
class Measured:
    """A hand at one moment.

    Attributes:
        stamp_ns: of the message's header [ns since the Unix epoch]; 0: it has none.
        position: [m] in the frame of the message.
        orientation: w, x, y, z; None where the message has none.
        grasps: whether it holds something; None where the message does not say.
        joints: of the arm that shows it, in the order of the station's arm [rad]; none where no arm does.
    """

    stamp_ns: int
    position: Vector
    orientation: Quaternion | None
    grasps: bool | None = None
    joints: tuple[float, ...] = ()


class Interpreter(ABC):
    """Reads one kind of message."""

    @abstractmethod
    def read(self, message: Any) -> Measured | None:
        """Return what a message says of the hand; None where it is about something else; raises `Malformed`."""


class PoseInterpreter(Interpreter):
    """Reads PoseStamped."""

    def read(self, message: Any) -> Measured:
        """Return the pose."""
        position, turn = _pose(message.pose.position, message.pose.orientation)
        return checked(Measured(stamp_of(message.header), position, turn))


class TransformInterpreter(Interpreter):
    """Reads TF: where a frame is in one above it, over the newest transforms of those between.

    Args:
        child: the frame that is followed, e.g. of a leader arm's tool.
        frame: in which it is told; empty: in the one that its own transform is told in.
    """

    def __init__(self, child: str, frame: str) -> None:
        self._child, self._frame = child, frame
        self._newest: dict[str, tuple[str, Pose]] = {}  # by child: its parent, and its pose there

    def keep(self, message: Any) -> dict[str, int]:
        """Keep all transforms of a message, also of those that never change; return their stamps by child [ns]."""
        stamps = {}
        for each in message.transforms:
            child, parent = (name.lstrip("/") for name in (each.child_frame_id, each.header.frame_id))
            position, turn = _pose(each.transform.translation, each.transform.rotation)
            checked(Measured(0, position, turn))
            if turn is None:
                raise Malformed(f"the transform of {child} has no rotation: it is all zero")
            if child not in self._newest and len(self._newest) >= MAX_FRAMES:
                raise Malformed(f"over {MAX_FRAMES} frames, the limit")
            self._newest[child] = parent, (position, unit(turn))
            stamps[child] = stamp_of(each.header)
        return stamps

    def read(self, message: Any) -> Measured | None:
        """Return the pose, if a transform of the chain came, and the chain is whole."""
        stamps = self.keep(message)
        chain = self._chain()
        came = [stamps[name] for name in chain if name in stamps]
        if not came:
            return None
        position, turn = self._newest[chain[0]][1]
        for name in chain[1:]:
            position, turn = composed(self._newest[name][1], (position, turn))
        return checked(Measured(max(came), position, unit(turn)))

    def _chain(self) -> list[str]:
        """Return the frames from the child up to the one under the frame; none where a transform is missing."""
        chain, child = [], self._child
        while child in self._newest and child not in chain:
            chain.append(child)
            child = self._newest[child][0]
            if child == self._frame or not self._frame:
                return chain
        return []


class JointInterpreter(Interpreter):
    """Reads JointState of an arm that is led by hand, by the kinematics of the station's arm.

    Args:
        robot: the station's arm.
        prefix: before the names of the joints, e.g. "leader_".
        gripper: name of the joint that opens and closes the fingers; empty: none.
        opened, closed: its positions.
    """

    def __init__(
        self, robot: Robot, *, prefix: str = "", gripper: str = "", opened: float = 0.0, closed: float = 0.0
    ) -> None:
        self._robot, self._prefix, self._gripper = robot, prefix, gripper
        self._opened, self._closed, self._grasps = opened, closed, False
        self._names = [joint_name(joint.name) for joint in robot.joints]

    def read(self, message: Any) -> Measured | None:
        """Return the pose of the tool; None where the message is of other joints, or has speeds or efforts alone."""
        if len(message.position) == 0:
            return None
        if len(message.position) != len(message.name):
            raise Malformed(f"{len(message.name)} names of joints and {len(message.position)} positions")
        angles = dict(zip(message.name, map(float, message.position), strict=True))
        if not all(math.isfinite(angle) for angle in angles.values()):
            raise Malformed("a joint's position is not finite")
        if self._gripper in angles:
            share = (angles[self._gripper] - self._opened) / (self._closed - self._opened)
            self._grasps = share > (RELEASE_THRESHOLD if self._grasps else GRASP_THRESHOLD)
        wanted = {name: angles.get(self._prefix + name) for name in self._names}
        known = {name: angle for name, angle in wanted.items() if angle is not None}
        if not known:
            return None
        if len(known) < len(wanted):
            raise Malformed(f"it has no joint {', '.join(self._prefix + n for n in self._names if n not in known)}")
        position, turn = tool_pose(self._robot, known)
        grasps, joints = self._grasps if self._gripper else None, tuple(known.values())
        return checked(Measured(stamp_of(message.header), position, turn, grasps, joints))


def checked(measured: Measured) -> Measured:
    """Return what was measured, or raise `Malformed` where the station would refuse it."""
    turn = measured.orientation or NOT_MEASURED
    fault = sample_fault(measured.position, turn, (), measured.stamp_ns or 1, measured.joints)
    if fault:
        raise Malformed(fault)
    return measured


def _pose(position: Any, turn: Any) -> tuple[Vector, Quaternion | None]:
    quaternion = (float(turn.w), float(turn.x), float(turn.y), float(turn.z))
    place = (float(position.x), float(position.y), float(position.z))
    return place, None if quaternion == NOT_MEASURED else quaternion
