"""Decides whether a suction cup takes an object, and how far its tool stays away from the object's middle.

The cup touches a flat face of the object, of a box or at the end of a cylinder. Its lip lies on the face, not more than
`CUP_REACH` off it, and all of it, and is turned against it by `MAX_TILT` at most.
"""

from __future__ import annotations

from math import cos, degrees, radians
from typing import Final

import numpy as np

from teachpath.lengths import describe_length, describe_lengths
from teachpath.motion.arm.geometry import CUP_RADIUS
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.records import Shape

CUP_REACH: Final = 0.003  # m, by which a cup gives way, or draws an object near
MAX_TILT: Final = radians(3.0)  # of the lip against the face

_FLAT_KINDS: Final = ("box", "cylinder")


def suction_fault(shape: Shape, pose: Array, arm: Arm, *, margin: float = 0.0) -> str:
    """Return why a suction cup does not take an object, in words; empty when it does.

    Args:
        shape: of the object.
        pose: (4, 4) to the gripper's frame from the object.
        arm: whose cup it is.
        margin: by which the rule must be exceeded [m].
    """
    if shape.kind not in _FLAT_KINDS:
        return f"a suction cup takes flat faces of boxes and cylinders, and {shape.name} is a {shape.kind}"
    rotation = pose[:3, :3]
    toward = -rotation[2]  # from the object to the cup, in the object's frame
    axis = int(np.argmax(np.abs(toward)))
    tilt = float(np.arccos(min(abs(float(toward[axis])), 1.0)))
    if shape.kind == "cylinder" and axis != 2:
        return f"{shape.name} turns its round side to the suction cup"
    if abs(toward[axis]) < cos(MAX_TILT):
        turned = f"{degrees(tilt):.0f} deg against the suction cup, at most {degrees(MAX_TILT):.0f}"
        return f"{shape.name} is turned by {turned}"
    lip = rotation.T @ (np.array([0.0, 0.0, arm.tool_length]) - pose[:3, 3])
    gap = float(np.sign(toward[axis]) * lip[axis]) - _half(shape, axis)
    if abs(gap) > CUP_REACH - margin:
        off, reach = describe_lengths(abs(gap), CUP_REACH - margin)
        where = "above" if gap > 0 else "below"
        return f"the suction cup ends {off} {where} the face of {shape.name}, at most {reach}"
    beyond = CUP_RADIUS + margin - _room(shape, axis, lip)
    if beyond > 0:
        return f"the suction cup sticks out over the edge of {shape.name} by {describe_length(beyond)}"
    return ""


def _half(shape: Shape, axis: int) -> float:
    """Return how far the face across an axis is from the middle [m]."""
    return shape.size[axis] / 2 if shape.kind == "box" else shape.size[1] / 2


def _room(shape: Shape, axis: int, lip: Array) -> float:
    """Return how far the middle of the lip (3,) is from the edge of the face across an axis [m]."""
    if shape.kind == "cylinder":
        return shape.size[0] - float(np.hypot(lip[0], lip[1]))
    return min(shape.size[k] / 2 - abs(float(lip[k])) for k in range(3) if k != axis)
