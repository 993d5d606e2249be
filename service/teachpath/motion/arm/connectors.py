"""What joins the links of a user's model where it is drawn.

A model says what may collide, often a cylinder a link with a gap at each joint: drawn alone, the arm falls to pieces. A
connector runs from a link's own joint to the next one: straight to that joint's axis, then along the axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.poses import pose_matrix
from teachpath.records import Array, SerialArm, Shape

RADIUS_SHARE: Final = 0.8  # share of the thinnest solid's half thickness: where there is no gap, nothing of it is seen
DEFAULT_RADIUS: Final = 0.03  # [m] between links without solids
MIN_LENGTH: Final = 0.001  # [m]


@dataclass(frozen=True, eq=False)
class Connector:
    """What joins a link to the next one, the last one to its tool.

    Attributes:
        link: 0 for the base, whose frame is the world, i for the link behind joint i.
        points: (n, 3) from the link's own joint to the next, in the link's frame [m]; one where both joints meet.
        radius: [m].
    """

    link: int
    points: Array
    radius: float


def connectors(arm: Arm) -> tuple[Connector, ...]:
    """Return a connector for each link of an arm that a user's model describes; none for a published one."""
    model = arm.model
    if model is None:
        return ()
    links = range(len(model.links) + 1)
    return tuple(Connector(link, _points(arm, model, link), _radius(model, link)) for link in links)


def _points(arm: Arm, model: SerialArm, link: int) -> Array:
    """Return the points (n, 3) of a link's connector, without those that coincide with the one before."""
    begin = np.array(model.links[link - 1].joint.anchor if link else (0.0, 0.0, 0.0))
    if link < len(model.links):
        ahead = model.links[link]
        pose = pose_matrix(ahead.pose)
        end = pose[:3, :3] @ ahead.joint.anchor + pose[:3, 3]
        axis = pose[:3, :3] @ ahead.joint.axis
        points = [begin, end + axis * (axis @ (begin - end)), end]
    else:
        mount = arm.gripper_mount
        points = [begin, np.array(model.tool[0]) if mount is None else mount[:3, 3]]
    kept = [point for k, point in enumerate(points) if not k or np.linalg.norm(point - points[k - 1]) > MIN_LENGTH]
    if link:
        return np.array(kept)
    base = pose_matrix(model.base)
    return np.array(kept) @ base[:3, :3].T + base[:3, 3]


def _radius(model: SerialArm, link: int) -> float:
    """Return the radius [m] of a link's connector: thinner than what it joins."""
    solids = [model.base_solids, *(one.solids for one in model.links)]
    joined = [*solids[link], *(solids[link + 1] if link + 1 < len(solids) else ())]
    return RADIUS_SHARE * min(map(_half_thickness, joined)) if joined else DEFAULT_RADIUS


def _half_thickness(shape: Shape) -> float:
    if shape.kind == "mesh":
        return float(shape.size[0] * np.ptp(np.array(shape.vertices), axis=0).min() / 2)
    if shape.kind == "cylinder":
        return min(shape.size[0], shape.size[1] / 2)
    return shape.size[0] if shape.kind == "sphere" else min(shape.size) / 2
