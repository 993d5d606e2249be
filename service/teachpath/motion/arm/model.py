"""The arm as a value, which is passed to everything that plans, simulates, executes or draws."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.limits import JointLimits
from teachpath.motion.arm.poses import pose_matrix
from teachpath.motion.arm.puma560 import DEFAULT_VARIANT, GRASP_DEPTH, TOOL_LENGTH, VARIANTS, Array, Link
from teachpath.motion.arm.tool import tool_matrix, tool_of_settings
from teachpath.motion.settings import MotionSettings
from teachpath.records import SerialArm, ToolPose
from teachpath.records.later_fields import LATER_FIELD

GripperKind = Literal["parallel", "suction", "none"]


@dataclass(frozen=True)
class Payload:
    """What the flange carries besides the gripper and the scene's object.

    Attributes:
        mass: [kg].
        center: of mass in the flange's frame [m].
    """

    mass: float = 0.0
    center: tuple[float, ...] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Arm:
    """One arm with its gripper; equal arms compute equal motions, and a plan is of one arm and no other.

    Attributes:
        name: of the published variant.
        links: its six rows, from the base to the flange; none where a `model` describes the arm.
        tool_length: from where the gripper sits to the tool centre point, between the fingers [m].
        grasp_depth: by which the fingers overlap an object that they hold [m] (see `collision.grasp`).
        payload: that the flange carries.
        tool_speed: that elbow, wrist and tool centre point keep [m/s] (see `tool_speed`); None: no limit.
        tool: pose of the tool to the flange; None: the gripper sits on the flange, along the axis of joint 6.
        model: that describes an arm other than the Puma 560; None: the Puma 560.
        gripper: what takes an object: two fingers, a suction cup, or nothing.
    """

    name: str
    links: tuple[Link, ...]
    tool_length: float = TOOL_LENGTH
    grasp_depth: float = GRASP_DEPTH
    payload: Payload = Payload()
    tool_speed: float | None = None
    tool: ToolPose | None = field(default=None, metadata=LATER_FIELD)
    model: SerialArm | None = field(default=None, metadata=LATER_FIELD)
    gripper: GripperKind = field(default="parallel", metadata=LATER_FIELD)

    @classmethod
    def of_settings(cls, settings: MotionSettings) -> Arm:
        """Return the arm that settings describe: a published variant with its tool, payload and limit of speed.

        Raises:
            UnusableSettings: they name a stored arm, whose model they do not have.
        """
        if settings.arm is not None:
            raise UnusableSettings(
                f"setting motion.arm is {settings.arm!r}, an arm that is kept in a data folder; give its model as arm, "
                "or leave the setting out for the Puma 560"
            )
        mass = settings.payload_mass
        return replace(
            cls.of_variant(settings.variant),
            tool_length=settings.tool_length,
            grasp_depth=settings.grasp_depth,
            payload=Payload(mass, tuple(settings.payload_center)) if mass else Payload(),  # nothing is nowhere
            tool_speed=settings.tool_speed,
            tool=tool_of_settings(settings),
            gripper=settings.gripper or "parallel",
        )

    @classmethod
    def of_variant(cls, name: str = DEFAULT_VARIANT) -> Arm:
        """Return the arm of a published variant.

        Raises:
            UnusableSettings: there is no such variant.
        """
        if name not in VARIANTS:
            raise UnusableSettings(f"setting motion.variant is {name!r}; known: {', '.join(VARIANTS)}")
        return cls(name, VARIANTS[name].links)

    @classmethod
    def of_model(cls, model: SerialArm, settings: MotionSettings) -> Arm:
        """Return the arm that a user's model describes; of the settings it has gripper, grasp depth and limit of speed.

        Raises:
            UnusableSettings: the arm was added with a gripper, and the settings say that it has none.
        """
        if settings.gripper == "none" and model.gripper_length:
            raise UnusableSettings(
                f"setting motion.gripper is none, and {model.name} was added with a gripper; add it without --gripper"
            )
        return cls(
            model.name,
            (),
            tool_length=model.gripper_length,
            grasp_depth=settings.grasp_depth,
            payload=Payload(model.payload_mass, model.payload_center),
            tool_speed=settings.tool_speed,
            model=model,
            gripper=settings.gripper or "parallel",
        )

    @property
    def identity(self) -> str:
        """Name of the published variant; of a user's model its name and the begin of its hash."""
        return self.name if self.model is None else f"{self.name} ({self.model.hash[:12]})"

    @property
    def joint_count(self) -> int:
        """Number of its joints."""
        return len(self.links) if self.model is None else len(self.model.links)

    @property
    def has_gripper(self) -> bool:
        """Whether it has fingers or a cup that take an object."""
        return self.gripper != "none" and (self.model is None or self.model.gripper_length > 0.0)

    @cached_property
    def limits(self) -> JointLimits:
        """What the joints may do, and how fast the tool may be."""
        if self.model is not None:
            return JointLimits.of_model(self.model, self.tool_speed)
        return JointLimits.of_links(self.links, self.tool_speed)

    @cached_property
    def tool_matrix(self) -> Array:
        """Pose (4, 4) to the flange from the tool, read-only."""
        pose = tool_matrix(self.tool, self.tool_length) if self.model is None else pose_matrix(self.model.tool)
        pose.flags.writeable = False
        return pose

    @cached_property
    def gripper_mount(self) -> Array | None:
        """Pose (4, 4) to the flange from the gripper, read-only; None where it sits on the flange itself."""
        if self.tool is None and (self.model is None or not self.has_gripper):
            return None
        pose = self.tool_matrix.copy()
        pose[:3, 3] -= self.tool_length * pose[:3, 2]
        pose.flags.writeable = False
        return pose

    @property
    def tool_reach(self) -> float:
        """Distance of the tool centre point from the middle of the flange [m]."""
        return self.tool_length if self.tool is None else float(np.linalg.norm(self.tool.position))

    @property
    def rolls_by_joint_6(self) -> bool:
        """Whether joint 6 alone rolls the tool about its own axis."""
        if self.model is not None:
            return False
        return self.tool is None or not any((*self.tool.position[:2], *self.tool.orientation[1:3]))
