"""What a station's arm does, for ROS 2: its joint states, where its tool is, and the trajectory of a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath_client.models import Robot
from teachpath_client.ros2.messages import JOINTS, TRAJECTORY, TRANSFORMS, header, make
from teachpath_client.ros2.node import Node
from teachpath_client.ros2.poses import joint_name, tool_pose
from teachpath_proto.motion_pb2 import JointState

ROOT: Final = ""  # frame of joints: they have none


@dataclass(frozen=True, slots=True)
class Names:
    """How topics and frames are called.

    Attributes:
        joints: topic of sensor_msgs/JointState.
        transforms: topic of tf2_msgs/TFMessage.
        trajectory: topic of trajectory_msgs/JointTrajectory; none that a controller listens to, unless that is meant.
        executed: topic of trajectory_msgs/JointTrajectory, of executions that have ended.
        markers: topic of visualization_msgs/MarkerArray.
        asked: topic of trajectory_msgs/JointTrajectory that ask for an execution.
        reported: topic of diagnostic_msgs/DiagnosticArray, what becomes of them.
        world: frame of the station's world.
        tool: frame of the arm's tool centre point.
    """

    joints: str = "/joint_states"
    transforms: str = "/tf"
    trajectory: str = "/teachpath/joint_trajectory"
    executed: str = "/teachpath/executed_trajectory"
    markers: str = "/teachpath/markers"
    asked: str = "/teachpath/follow_joint_trajectory"
    reported: str = "/teachpath/execution"
    world: str = "world"
    tool: str = "teachpath_tool"


class ArmBridge:
    """Publishes what an arm says as messages of ROS 2.

    Args:
        node: that publishes.
        robot: the arm, as the station describes it.
        names: of topics and frames.
        bridged: the router is zenoh-bridge-ros2dds.

    Attributes:
        joints: names of the arm's joints in messages, in its order.
    """

    def __init__(self, node: Node, robot: Robot, names: Names, *, bridged: bool = False) -> None:
        self._node, self._robot, self._names = node, robot, names
        self.joints: list[str] = [joint_name(joint.name) for joint in robot.joints]
        self._states = node.publisher(names.joints, JOINTS, bridged=bridged)
        self._transforms = node.publisher(names.transforms, TRANSFORMS, bridged=bridged)
        self._trajectory = node.publisher(names.trajectory, TRAJECTORY, bridged=bridged)

    def publish_state(self, payload: bytes) -> None:
        """Publish a joint state of the station's bus, with its stamp; raises ValueError where it is none."""
        try:
            state = JointState.FromString(payload)
        except Exception as error:  # protobuf's own errors are no ValueError
            raise ValueError(f"no joint state: {error}") from None
        if len(state.position) != len(self.joints) or not np.isfinite(state.position).all():
            raise ValueError(f"a joint state needs {len(self.joints)} finite positions: {list(state.position)}")
        self._states.put(
            header=header(state.stamp_ns, ROOT),
            name=self.joints,
            position=np.array(state.position),
            velocity=np.array(state.velocity),
            effort=np.array(state.torque),
        )
        position, turn = tool_pose(self._robot, dict(zip(self.joints, state.position, strict=True)))
        axes = ("x", "y", "z")
        transform = make(
            "geometry_msgs/msg/Transform",
            translation=make("geometry_msgs/msg/Vector3", **dict(zip(axes, position, strict=True))),
            rotation=make("geometry_msgs/msg/Quaternion", **dict(zip(("w", *axes), turn, strict=True))),
        )
        stamped = make(
            "geometry_msgs/msg/TransformStamped",
            header=header(state.stamp_ns, self._names.world),
            child_frame_id=self._names.tool,
            transform=transform,
        )
        self._transforms.put(transforms=[stamped])

    def publish_trajectory(self, content: bytes) -> bool:
        """Publish a trajectory, and return whether; it is not published while nobody subscribes to its topic.

        Args:
            content: trajectory_msgs/JointTrajectory in CDR, as the station writes the program of a plan.
        """
        subscribed = self._node.is_subscribed(self._trajectory.topic)
        if subscribed:
            self._trajectory.put_encoded(content)
        return subscribed
