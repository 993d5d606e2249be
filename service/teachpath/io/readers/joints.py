"""Recorded joint angles as motions of the tool of the station's arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableRecording
from teachpath.io.readers.contract import FileMotions, JointTrack, Track
from teachpath.records import Array

TOLERANCE = 0.05  # [rad] by which a measured angle may be outside the limits of its joint


@dataclass(frozen=True, eq=False)
class ToolKinematics:
    """The arm whose joint angles a file may hold.

    Attributes:
        arm: its name.
        joints: names of its joints (j,), from the base to the tool.
        lower: least angles (j,) [rad].
        upper: largest angles (j,) [rad].
        tool_poses: returns poses (n, 4, 4) to world from the tool, of angles (n, j) [rad].
    """

    arm: str
    joints: tuple[str, ...]
    lower: Array
    upper: Array
    tool_poses: Callable[[Array], Array]


def with_tool_motions(found: FileMotions, arm: ToolKinematics | None, name: str) -> FileMotions:
    """Return what was found in a file, with the motions of the tool where it holds joint angles.

    Raises:
        UnusableRecording: the angles are of another arm, outside its limits, or not finite; or no arm is known.
    """
    if not found.joint_tracks:
        return found
    if arm is None:
        raise UnusableRecording(f"{name}: it holds joint angles, which are read where an arm is known: at a station")
    usable = [track for track in found.joint_tracks if set(arm.joints) <= set(track.names)]
    if not usable:
        held = "; ".join(", ".join(track.names) for track in found.joint_tracks)
        raise UnusableRecording(
            f"{name}: its joints are {held}; the station's arm {arm.arm} has {', '.join(arm.joints)}; let motion.arm "
            "be the arm that was recorded, or name the joints as its model does"
        )
    tool = f"tool of {arm.arm} by its kinematics, in the robot's frame; a calibration does not count"
    return replace(
        found, tracks=[_tool_track(each, arm, name) for each in usable], understood=(*found.understood, tool)
    )


def _tool_track(track: JointTrack, arm: ToolKinematics, name: str) -> Track:
    angles = track.angles[:, [track.names.index(joint) for joint in arm.joints]]
    inside = (angles >= arm.lower - TOLERANCE) & (angles <= arm.upper + TOLERANCE)  # what is no number is outside
    if not inside.all():
        row, column = (int(k) for k in np.argwhere(~inside)[0])
        raise UnusableRecording(
            f"{name}, sample {row}: {arm.joints[column]} is at {angles[row, column]:.4g} rad, outside "
            f"{arm.lower[column]:.4g} to {arm.upper[column]:.4g} of the station's arm {arm.arm}; are its zeros those "
            "of the arm that was recorded, and its angles in radians?"
        )
    poses = arm.tool_poses(angles)
    turns = Rotation.from_matrix(poses[:, :3, :3]).as_quat(scalar_first=True)
    return Track(track.stamps_ns, poses[:, :3, 3], np.asarray(turns), closure=track.closure, joints=angles)
