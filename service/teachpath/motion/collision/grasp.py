"""Decides whether the gripper takes an object: the rule of planning, and the one by which the simulated gripper holds.

The object is measured by its extents along the fingers' axes: across their width (x), where they close (y) and along
their length (z), in the frame of the gripper. It must fit between the open fingers, and the fingers must overlap it
along z and x by `Arm.grasp_depth`, or all of it where it is smaller. A round object touches each finger along a line or
at a point, which must lie on the finger. A suction cup has a rule of its own (`suction.py`).
"""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np

from teachpath.lengths import describe_length, describe_lengths
from teachpath.motion.arm.geometry import collision_solids
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.collision.boundaries import Extent
from teachpath.motion.collision.suction import suction_fault
from teachpath.records import Scene, Shape

PLANNED_MARGIN: Final = 0.001  # m, by which a plan does more than the rule asks for: an arm is not exactly on its path
ROUND_AXIS_SHARE: Final = 0.7  # of a cylinder's axis along a finger's axis, above which it counts as along it

_FINGER: Final = next(solid for solid in collision_solids() if solid.opening_offset[1] > 0)
HALF_OPENING: Final = _FINGER.position[1] - _FINGER.size[1] / 2 + _FINGER.opening_offset[1]  # m, to an open finger
_FINGER_LOWER_CORNER: Final = np.array(_FINGER.position) - np.array(_FINGER.size) / 2
_FINGER_UPPER_CORNER: Final = np.array(_FINGER.position) + np.array(_FINGER.size) / 2


def grasp_fault(shape: Shape, pose: Array, arm: Arm, *, margin: float = 0.0) -> str:
    """Return why closing fingers, or a suction cup, do not take an object, in words; empty when they take it.

    Args:
        shape: of the object.
        pose: (4, 4) to the gripper's frame from the object.
        arm: whose gripper closes.
        margin: by which the rule must be exceeded [m].
    """
    if arm.gripper == "suction":
        return suction_fault(shape, pose, arm, margin=margin)
    centre = pose[:3, 3]
    low, high = _bounds(shape, pose)
    room = HALF_OPENING - margin
    if high[1] - low[1] > 2 * room:
        width, opening = describe_lengths(high[1] - low[1], 2 * room)
        return f"{shape.name} is {width} wide there, the fingers open {opening}"
    if (out := max(high[1], -low[1]) - room) > 0:
        return f"{shape.name} sticks out from between the open fingers by {describe_length(out)}"
    for axis, where in ((2, "along their length"), (0, "across their width")):
        overlap = min(high[axis], _FINGER_UPPER_CORNER[axis]) - max(low[axis], _FINGER_LOWER_CORNER[axis])
        if overlap < 0:
            return f"the fingers miss {shape.name} by {describe_length(-overlap)} {where}"
        needed = min(
            arm.grasp_depth + margin, high[axis] - low[axis], _FINGER_UPPER_CORNER[axis] - _FINGER_LOWER_CORNER[axis]
        )
        if overlap < needed - 1e-9:
            depth, least = describe_lengths(overlap, needed)
            return f"the fingers overlap {shape.name} by {depth} {where}, less than {least} (motion.grasp_depth)"
        if _is_round(shape, pose, axis):
            beyond = max(_FINGER_LOWER_CORNER[axis] - centre[axis], centre[axis] - _FINGER_UPPER_CORNER[axis]) + margin
            if beyond > 0:
                return f"the fingers end {describe_length(beyond)} before the middle of {shape.name} {where}"
    return ""


def tool_offset_of(scene: Scene, arm: Arm) -> float:
    """Return how far the tool stays above the middle of a scene's object [m]: a suction cup touches its top."""
    if scene.carried is None or arm.gripper != "suction":
        return 0.0
    turned = rotation_matrices(np.array([scene.carried.orientation]))[0]
    return float(shape_extent(scene.carried).along(turned)[2])


def grasp_width(shape: Shape, pose: Array) -> float:
    """Return how far an object keeps the fingers apart [m]; `pose` (4, 4) is to the gripper's frame from the object."""
    low, high = _bounds(shape, pose)
    return float(high[1] - low[1])


def _bounds(shape: Shape, pose: Array) -> tuple[Array, Array]:
    extent, centre = shape_extent(shape), pose[:3, 3]
    return centre - extent.along(-pose[:3, :3]), centre + extent.along(pose[:3, :3])


def shape_extent(shape: Shape) -> Extent:
    """Return how far a shape of a scene reaches from its position."""
    if shape.kind == "sphere":
        return Extent(np.zeros((1, 3)), ball=shape.size[0])
    if shape.kind == "cylinder":
        return Extent(np.outer([-shape.size[1] / 2, shape.size[1] / 2], [0.0, 0.0, 1.0]), disc=shape.size[0])
    if shape.kind == "box":
        return Extent(np.array(list(product((-0.5, 0.5), repeat=3))) * shape.size)
    return Extent(shape.size[0] * np.array(shape.vertices))


def _is_round(shape: Shape, pose: Array, axis: int) -> bool:
    """Tell whether an object curves away from the fingers along one of their axes."""
    along = np.abs(pose[:3, 2])
    lying = shape.kind == "cylinder" and max(along[axis], along[1]) < ROUND_AXIS_SHARE
    return shape.kind == "sphere" or lying
