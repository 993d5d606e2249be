"""Notices a gripper that closed on nothing, or has lost its object, by the measured distance between its fingers."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.kinematics import gripper_frame, link_frames
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import shape_pose
from teachpath.motion.collision.grasp import grasp_width
from teachpath.records import JointState, Plan

LEAST_SHARE: Final = 0.5  # of the object's width, below which the fingers hold nothing: a soft object gives way
LOSS_TIME_NS: Final = 100_000_000  # [ns] for which that must be measured


class GraspMonitor:
    """Watches the gripper of one execution; an arm that does not measure its fingers is believed.

    Args:
        name: of the object.
        width: of the object, where the fingers take it [m]; 0 where there is none, and nothing is watched.

    Attributes:
        name: of the object.
    """

    def __init__(self, name: str = "", width: float = 0.0) -> None:
        self.name: str = name
        self._width = width
        self._empty_since: int | None = None  # [ns]
        self._was_reported = False  # that it is empty now
        self._is_accepted = False  # likewise

    @classmethod
    def of_plan(cls, plan: Plan, arm: Arm) -> GraspMonitor:
        """Return the monitor of an object that is taken where a plan's path begins."""
        carried = plan.scene.carried
        if carried is None:
            return cls()
        gripper = gripper_frame(link_frames(plan.joints[0], arm)[-1], arm)
        return cls(carried.name, grasp_width(carried, np.linalg.inv(gripper) @ shape_pose(carried)))

    def fault(self, state: JointState, *, closed: bool, carries: bool, now: int) -> str:
        """Return that the closed gripper holds nothing, in words; empty while it may hold its object.

        Args:
            state: newest joint state of the arm in this execution.
            closed: whether the gripper is to be closed.
            carries: whether the object should be on its way, and not yet be taken.
            now: [ns], on any clock.
        """
        opening = state.gripper_opening
        if not (closed and state.gripper_closed) or opening is None or opening >= LEAST_SHARE * self._width:
            self._empty_since, self._was_reported, self._is_accepted = None, False, False
            return ""
        if self._empty_since is None:
            self._empty_since = now
        if now - self._empty_since < LOSS_TIME_NS or self._is_accepted:
            return ""
        self._was_reported = True
        measured = f"{1000 * opening:.0f} mm between the fingers, and {self.name} is {1000 * self._width:.0f} mm wide"
        what = f"has lost {self.name}" if carries else "closed on nothing"
        return f"the gripper {what} ({measured} there)"

    def accept(self) -> None:
        """Go on with a gripper that was reported to hold nothing, until its fingers have held something or opened."""
        self._is_accepted = self._was_reported
