"""The gripper of an arm that mirrors a hand: it closes and opens with the hand, and what it holds is kept clear too."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.kinematics import rotation_matrices, tool_pose
from teachpath.motion.collision.collision_model import Load
from teachpath.recording.phases import hand_closure
from teachpath.records import JointState, Sample

CLOSING_THRESHOLD: Final = 0.6  # closure of the hand above which the gripper closes
OPENING_THRESHOLD: Final = 0.4  # and below which it opens
MAX_GRASP_DISTANCE: Final = 0.05  # m, from the grasp point to the object's centre: farther off it is not in the gripper


class GripperFollower:
    """Follows how far a hand is closed, or its grasp button, while the clutch is pressed.

    Only a change counts: who lets the clutch go with the object in the gripper, and presses it again with the hand
    closed or open, still has it.
    """

    def __init__(self, closed: bool) -> None:
        """Begin with the gripper as it is."""
        self.closed = closed
        self._hand_closed = closed  # whether the hand is

    def engage(self, sample: Sample) -> None:
        """Take the hand as it is now; what it does from here on counts."""
        self._hand_closed = hand_closure(sample) > (CLOSING_THRESHOLD + OPENING_THRESHOLD) / 2

    def follow(self, sample: Sample) -> None:
        """Close or open the gripper when the hand has closed or opened."""
        how = hand_closure(sample)
        if (self._hand_closed and how < OPENING_THRESHOLD) or (not self._hand_closed and how > CLOSING_THRESHOLD):
            self._hand_closed = self.closed = not self._hand_closed


def observed_load(arm: JointState, before: Load | None) -> Load | None:
    """Return where the arm says that the object is: in its gripper, or in the world.

    Args:
        arm: its newest joint state; an orientation of zeros says that it knows of no object.
        before: what was known until now, and is still, when the arm knows of none.
    """
    if not any(arm.object_orientation):
        return before
    pose = np.eye(4)
    pose[:3, :3] = rotation_matrices(np.array([arm.object_orientation]))[0]
    pose[:3, 3] = arm.object_position
    tool = tool_pose(arm.position)
    if arm.gripper_closed and np.linalg.norm(pose[:3, 3] - tool[:3, 3]) <= MAX_GRASP_DISTANCE:
        return Load(grasp_pose=np.linalg.inv(tool) @ pose)
    return Load(position=arm.object_position, rotation=pose[:3, :3])
