"""Computes the whole motion of a plan over time, so that somebody can look at it before anything moves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.execution.segments import Segment, plan_segments
from teachpath.motion.planning.digest import verify
from teachpath.motion.settings import MotionSettings
from teachpath.records import MotionPreview, Plan, SegmentInterval

MAX_INSTANTS: Final = 6000  # a longer motion has its instants farther apart


def preview_motion(
    plan: Plan, settings: MotionSettings, arm: Arm, *, dwell: float, rate: float = 50.0
) -> MotionPreview:
    """Return the motion that an execution of `plan` makes at full speed from home; nothing is sent.

    Args:
        plan: certified; checked again here.
        settings: as for planning.
        arm: that the plan is for.
        dwell: how long the gripper takes to close or open [s].
        rate: instants a second [Hz].

    Raises:
        PathRefused: the plan has changed since it was certified, or the way from home to its start is not free.
    """
    verify(plan, arm)
    parts = plan_segments(plan, np.array(settings.home), settings, arm, dwell)
    begins = np.concatenate([[0.0], np.cumsum([_duration(part) for part in parts])])
    times = np.linspace(0.0, begins[-1], min(int(np.ceil(begins[-1] * rate)) + 1, MAX_INSTANTS))
    which = np.clip(np.searchsorted(begins, times, side="right") - 1, 0, len(parts) - 1)
    rows = _rows(parts, begins, times, which, np.array(settings.home))
    taught = next(index for index, part in enumerate(parts) if part.is_path)
    share = np.clip(rows[:, -1] / plan.lengths[-1], 0.0, 1.0)  # the trajectory ends within rounding of the length
    positions, orientations = _object(plan, arm, rows[:, :-1], which - taught)
    return MotionPreview(
        plan=plan.id,
        times=times,
        joints=rows[:, :-1],
        progress=np.where(which == taught, share, np.where(which < taught, 0.0, 1.0)),
        gripper_closed=tuple(parts[index].gripper_closed for index in which),
        object_position=positions,
        object_orientation=orientations,
        segments=tuple(
            SegmentInterval(part.name, float(a), float(b))
            for part, a, b in zip(parts, begins[:-1], begins[1:], strict=True)
        ),
    )


def _rows(parts: Sequence[Segment], begins: Array, times: Array, which: NDArray[np.intp], home: Array) -> Array:
    """Return joints and length (n, joints + 1) at `times` (n,), each in the segment of the index `which` (n,)."""
    rows = np.zeros((len(times), len(home) + 1))
    here = np.append(home, 0.0)
    for index, (part, begin) in enumerate(zip(parts, begins[:-1], strict=True)):
        mine = which == index
        if part.trajectory is None:
            rows[mine] = here
        else:
            rows[mine] = part.trajectory(times[mine] - begin)
            here = part.trajectory(np.array([part.trajectory.duration]))[0]
    return rows


def _duration(part: Segment) -> float:
    return part.trajectory.duration if part.trajectory is not None else part.rest_time


def _object(plan: Plan, arm: Arm, joints: Array, since: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return the carried object's positions and orientations; `since` (n,) is negative before the path, 0 on it."""
    if plan.scene.carried is None:
        return np.zeros((0, 3)), np.zeros((0, 4))
    away = since[:, None]
    carrying = np.where(away < 0, plan.joints[0], np.where(away > 0, plan.joints[-1], joints))
    at_start = np.eye(4)
    at_start[:3, 3] = plan.scene.carried.position
    poses = tool_pose(carrying, arm) @ np.linalg.inv(tool_pose(plan.joints[0], arm)) @ at_start
    return poses[:, :3, 3], Rotation.from_matrix(poses[:, :3, :3]).as_quat(scalar_first=True)
