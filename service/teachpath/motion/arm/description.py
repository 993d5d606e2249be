"""How the arm is built, as a document for pages and other programs."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import FINGER_TRAVEL
from teachpath.motion.arm.tool import NO_TURN
from teachpath.records import Array, Quaternion, ToolPose, Vector


@dataclass(frozen=True, slots=True)
class LinkGeometry:
    """A link by its standard Denavit-Hartenberg parameters: a and d [m], alpha [rad].

    Attributes:
        a: length of the link along its x [m].
        d: offset along z of the link before [m].
        alpha: twist about its x [rad].
    """

    a: float
    d: float
    alpha: float


@dataclass(frozen=True, slots=True)
class JointGeometry:
    """How a joint moves its link: about an axis through a point, both in the link's own frame.

    Attributes:
        name: of the joint.
        position: of the link's frame in that of the link before, the world for the first, while the joint is at 0 [m].
        orientation: likewise, unit quaternion w, x, y, z.
        axis: unit vector about which the link turns.
        anchor: a point on the axis [m].
    """

    name: str
    position: Vector
    orientation: Quaternion
    axis: Vector
    anchor: Vector


@dataclass(frozen=True, eq=False)
class Robot:
    """How the arm is built.

    Attributes:
        name: of the arm in its keys.
        variant: the published table that its lengths and masses come from; of an arm that was added, its name.
        model: SHA-256 of an arm that was added (hex); empty for a published one.
        links: of a published arm, from the base to the wrist; empty for one that was added.
        joints: from the base to the flange.
        lower: (joints,) limits of the joints [rad].
        upper: (joints,) likewise.
        speed: (joints,) limits [rad/s].
        acceleration: (joints,) limits [rad/s^2].
        jerk: (joints,) limits [rad/s^3].
        torque: (joints,) limits [N m].
        tool: its pose to the flange.
        tool_length: from where the gripper sits to the tool centre point [m]; 0: there is no gripper.
        tool_speed: limit of elbow, wrist and tool centre point [m/s]; None: no limit.
        payload_mass: of what the flange carries besides the gripper and the scene's object [kg].
        payload_center: its centre of mass in the flange's frame [m].
        finger_travel: of each finger [m].
        home: configuration in which the arm waits [rad].
    """

    name: str
    variant: str
    model: str
    links: tuple[LinkGeometry, ...]
    joints: tuple[JointGeometry, ...]
    lower: Array
    upper: Array
    speed: Array
    acceleration: Array
    jerk: Array
    torque: Array
    tool: ToolPose
    tool_length: float
    finger_travel: float
    home: tuple[float, ...]
    tool_speed: float | None
    payload_mass: float
    payload_center: tuple[float, ...]


def describe_arm(arm: Arm, *, name: str, home: tuple[float, ...]) -> Robot:
    """Describe an arm.

    Args:
        name: of the arm in its keys.
        home: configuration in which it waits [rad].
    """
    limits = arm.limits
    return Robot(
        name=name,
        variant=arm.name,
        model="" if arm.model is None else arm.model.hash,
        links=tuple(LinkGeometry(link.a, link.d, link.alpha) for link in arm.links),
        joints=_joints(arm),
        lower=limits.lower,
        upper=limits.upper,
        speed=limits.speed,
        acceleration=limits.acceleration,
        jerk=limits.jerk,
        torque=limits.torque,
        tool=_tool(arm),
        tool_length=arm.tool_length,
        finger_travel=FINGER_TRAVEL if arm.has_gripper and arm.gripper == "parallel" else 0.0,
        home=home,
        tool_speed=arm.tool_speed,
        payload_mass=arm.payload.mass,
        payload_center=arm.payload.center,
    )


def _tool(arm: Arm) -> ToolPose:
    if arm.model is not None:
        return ToolPose(*arm.model.tool)
    return arm.tool or ToolPose((0.0, 0.0, arm.tool_length), NO_TURN)


def _joints(arm: Arm) -> tuple[JointGeometry, ...]:
    frames = link_frames(np.zeros(len(arm.limits.lower)), arm)
    made = []
    for number, (before, frame) in enumerate(pairwise(frames)):
        relative = np.linalg.inv(before) @ frame
        w, x, y, z = Rotation.from_matrix(relative[:3, :3]).as_quat(scalar_first=True)
        if arm.model is None:  # it turns about z of the frame before
            axis = _vector(relative[2, :3])
            anchor = _vector(-relative[:3, :3].T @ relative[:3, 3])
        else:
            joint = arm.model.joints[number]
            axis, anchor = joint.axis, joint.anchor
        turn = (float(w), float(x), float(y), float(z))
        made.append(JointGeometry(arm.limits.names[number], _vector(relative[:3, 3]), turn, axis, anchor))
    return tuple(made)


def _vector(values: Array) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z
