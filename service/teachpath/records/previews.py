"""A plan's whole motion against time, to be looked at before anything moves."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.records.arrays import Array, Matrix


@dataclass(frozen=True, slots=True)
class SegmentInterval:
    """When a stretch of the motion lasts, in words and seconds.

    Attributes:
        name: what the arm does, in words.
        begin: from the start of the motion [s].
        end: from the start of the motion [s].
    """

    name: str
    begin: float
    end: float


@dataclass(frozen=True, eq=False)
class MotionPreview:
    """The motion at full speed from the arm's home, at even instants.

    Attributes:
        plan: id of the plan.
        times: (n,) [s], from 0.
        joints: (n, joints) configurations [rad].
        progress: (n,) share of the learned path's length that is done.
        gripper_closed: (n,) whether the gripper is closed.
        object_position: (n, 3) centre of the carried object [m, world]; (0, 3) when the scene has none.
        object_orientation: (n, 4) to world from object, quaternion w, x, y, z; (0, 4) when the scene has none.
        segments: what the arm does when.
    """

    plan: str
    times: Array
    joints: Matrix
    progress: Array
    gripper_closed: tuple[bool, ...]
    object_position: Matrix
    object_orientation: Matrix
    segments: tuple[SegmentInterval, ...]
