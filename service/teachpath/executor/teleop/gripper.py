"""The gripper of an arm that follows a hand: it closes and opens with the hand, and what it holds is kept clear."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.held_object import MAX_GRASP_DISTANCE
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.collision.collision_model import Load
from teachpath.recording.phases import hand_closure
from teachpath.records import JointState, Sample

CLOSING_THRESHOLD: Final = 0.6  # closure of the hand above which the gripper closes
OPENING_THRESHOLD: Final = 0.4  # closure of the hand below which the gripper opens


class GripperFollower:
    """Closes and opens the gripper with the hand, or with its grasp button, while the clutch is engaged.

    Only a change of the hand counts. So the gripper keeps its object when the clutch is released and pressed again,
    whether the hand is closed or open then.

    Attributes:
        closed: whether the gripper is to be closed.
    """

    def __init__(self, closed: bool) -> None:
        self.closed: bool = closed
        self._hand_closed = closed

    def engage(self, sample: Sample) -> None:
        """Take the hand as it is now; only its changes from here on move the gripper."""
        self._hand_closed = hand_closure(sample) > (CLOSING_THRESHOLD + OPENING_THRESHOLD) / 2

    def follow(self, sample: Sample) -> None:
        """Close or open the gripper when the hand has closed or opened."""
        closure = hand_closure(sample)
        opens = self._hand_closed and closure < OPENING_THRESHOLD
        closes = not self._hand_closed and closure > CLOSING_THRESHOLD
        if opens or closes:
            self._hand_closed = self.closed = not self._hand_closed


def observed_load(state: JointState, arm: Arm, before: Load | None) -> Load | None:
    """Return where the object is by the arm's own account: in its gripper, or in the world.

    Args:
        state: newest joint state of the arm; an orientation of zeros says that it knows of no object.
        arm: whose state it is.
        before: returned when the arm knows of no object.
    """
    if not any(state.object_orientation):
        return before
    pose = np.eye(4)
    pose[:3, :3] = rotation_matrices(np.array([state.object_orientation]))[0]
    pose[:3, 3] = state.object_position
    tool = tool_pose(state.position, arm)
    if state.gripper_closed and np.linalg.norm(pose[:3, 3] - tool[:3, 3]) <= MAX_GRASP_DISTANCE:
        return Load(grasp_pose=np.linalg.inv(tool) @ pose)
    return Load(position=state.object_position, rotation=pose[:3, :3])
