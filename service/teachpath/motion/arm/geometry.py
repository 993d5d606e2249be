"""The arm's solids: one list for drawing, simulation and collision checking.

A Puma 560 has a slim column with a drum across its top, a long tapered upper arm at one end of the drum, beside the
column, a thinner forearm on the inner side of the elbow, and a slender wrist.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import atan2, cos, hypot, pi, radians, sin, sqrt
from typing import Final

import numpy as np

from teachpath.motion.arm.connectors import Connector, connectors
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.poses import pose_matrix, turned
from teachpath.motion.arm.puma560 import FINGER_TRAVEL, Array
from teachpath.records import Quaternion, SerialArm, Vector

SHELL_COLOR: Final = 0xF7F2E6  # the shell
JOINT_COLOR: Final = 0x2F343B  # joints, foot and gripper
STEEL_COLOR: Final = 0xA3ABB4
PLATE_COLOR: Final = 0x1F4E87

FINGER_END: Final = 0.135  # [m] from the flange
ROD_RADIUS: Final = 0.011  # [m]
CUP_RADIUS: Final = 0.015  # [m] of a suction cup, whose lip is at the tool centre point
CUP_HEIGHT: Final = 0.015  # [m]
PALM_HEIGHT: Final = 0.035  # [m]
CUP: Final = "suction cup"  # its name
ADAPTER_RADIUS: Final = 0.02  # [m] of what holds a gripper that does not sit on the flange
MIN_ADAPTER: Final = 0.001  # [m] between flange and gripper, below which there is none

# Pairs of links that are neighbours, or between which the joints' limits keep a nearly constant distance.
_IGNORED_LINK_PAIRS: Final = {(0, 1), (0, 2), (1, 2), (2, 3), (3, 4), (3, 5), (4, 5), (4, 6), (5, 6)}

IDENTITY_ROTATION: Final[Quaternion] = (1.0, 0.0, 0.0, 0.0)
Z_TO_Y_ROTATION: Final[Quaternion] = (
    cos(radians(45)),
    sin(radians(-45)),
    0.0,
    0.0,
)  # turns the solid's z to the link's y


@dataclass(frozen=True, slots=True)
class LinkSolid:
    """One solid, fixed to a link.

    Attributes:
        name: unique, e.g. "upper arm".
        link: 0 for the fixed base (frame `world`), i for the Denavit-Hartenberg frame behind joint i.
        kind: `box` (size = full edges x, y, z), `cylinder` (radius, height; axis along its z), `sphere` (radius),
            `prism` (thickness along its z, convex `outline` in its xy plane, counter-clockwise) or `mesh` (factor from
            the units of its `vertices`, three a triangle, to metres).
        position: of the solid's centre in the link's frame [m].
        orientation: of the solid in the link's frame.
        opening_offset: displacement in the link's frame while the gripper is open [m].
        visual_only: whether it is only drawn. Such a solid stands out of another one of its link by a few millimetres,
            where nothing can touch it, or closes the gap that a user's model leaves at a joint.
    """

    name: str
    link: int
    kind: str
    size: tuple[float, ...]
    position: Vector
    orientation: Quaternion = IDENTITY_ROTATION
    color: int = SHELL_COLOR
    outline: tuple[tuple[float, float], ...] = ()
    opening_offset: Vector = (0.0, 0.0, 0.0)
    visual_only: bool = False
    vertices: tuple[Vector, ...] = ()


def collision_solids(arm: Arm | None = None) -> tuple[LinkSolid, ...]:
    """Return the solids that are simulated and checked for collisions; see `visual_solids`."""
    return tuple(solid for solid in visual_solids(arm) if not solid.visual_only)


def visual_solids(arm: Arm | None = None) -> tuple[LinkSolid, ...]:
    """Return all solids of an arm and its gripper; of a user's model, what may collide and what joins it.

    The proportions of the Puma 560 are our own, after photographs of the arm. What holds a tool centre point beyond the
    fingers is taken as a rod as thick as a finger, and what holds a gripper that does not sit on the flange as a
    straight adapter.

    Args:
        arm: whose solids they are; None for the Puma 560 with its gripper on the flange.
    """
    if arm is not None and arm.model is not None:
        rods = [solid for one in connectors(arm) for solid in _rods(one)]
        return (*_model_solids(arm.model), *rods, *gripper_solids(arm))
    gripper = _GRIPPER if arm is None else _tool_solids(arm)
    if arm is None or arm.tool is None or arm.gripper_mount is None:
        return _ARM + gripper
    mount, turn = arm.gripper_mount, arm.tool.orientation
    return _ARM + _adapter(mount[:3, 3]) + tuple(_mounted(solid, mount, turn) for solid in gripper)


def gripper_solids(arm: Arm) -> tuple[LinkSolid, ...]:
    """Return the solids of the gripper on the last link of a user's model; none where it has no gripper."""
    if arm.model is None or arm.gripper_mount is None:
        return ()
    mounted = (_mounted(solid, arm.gripper_mount, arm.model.tool[1]) for solid in _tool_solids(arm))
    return tuple(replace(solid, link=len(arm.model.links)) for solid in mounted)


def may_meet(a: LinkSolid, b: LinkSolid, arm: Arm) -> bool:
    """Tell whether two solids of an arm may come together; a gripper mounted off the flange may even meet link 4."""
    low, high = sorted((a.link, b.link))
    at_wrist = arm.tool is not None and (low, high) == (4, 6) and "flange" not in (a.name, b.name)
    return at_wrist or (low != high and (low, high) not in _IGNORED_LINK_PAIRS)


def grips(solid: LinkSolid) -> bool:
    """Tell whether a solid is a finger or a suction cup, which touches the object that it takes."""
    return any(solid.opening_offset) or solid.name == CUP


def _tool_solids(arm: Arm) -> tuple[LinkSolid, ...]:
    """Return the gripper as it sits on the flange, or the rod that holds a tool centre point without one."""
    if arm.gripper == "parallel":
        return _fingers(arm.tool_length)
    if arm.gripper == "none":
        return (_stem("tool", 0.0, arm.tool_length),)
    palm = LinkSolid("palm", 6, "box", (0.044, 0.044, PALM_HEIGHT), (0.0, 0.0, PALM_HEIGHT / 2), color=JOINT_COLOR)
    begin = arm.tool_length - CUP_HEIGHT
    cup = replace(_stem(CUP, begin, arm.tool_length), size=(CUP_RADIUS, CUP_HEIGHT), color=JOINT_COLOR)
    return (palm, *([_stem("tool", PALM_HEIGHT, begin)] if begin > PALM_HEIGHT else []), cup)


def _stem(name: str, begin: float, end: float) -> LinkSolid:
    """Return a rod along z of the gripper's frame, between two heights [m]."""
    return LinkSolid(name, 6, "cylinder", (ROD_RADIUS, end - begin), (0.0, 0.0, (begin + end) / 2), color=STEEL_COLOR)


def _fingers(tool_length: float) -> tuple[LinkSolid, ...]:
    """Return the gripper with fingers as it sits on the flange, with what reaches beyond them."""
    if (beyond := tool_length - FINGER_END) <= 0.0:
        return _GRIPPER
    return (*_GRIPPER, _stem("tool", FINGER_END, FINGER_END + beyond))


def _model_solids(model: SerialArm) -> tuple[LinkSolid, ...]:
    """Return the solids of a user's model, those that do not move in the world."""
    base = pose_matrix(model.base)
    shapes = [(number, shape) for number, link in enumerate(model.links, start=1) for shape in link.solids]
    for shape in model.base_solids:
        place = _vector(base[:3, :3] @ shape.position + base[:3, 3])
        shapes.append((0, replace(shape, position=place, orientation=turned(model.base[1], shape.orientation))))
    return tuple(
        LinkSolid(s.name, link, s.kind, s.size, s.position, s.orientation, s.color, vertices=s.vertices)
        for link, s in shapes
    )


def _mounted(solid: LinkSolid, mount: Array, orientation: Quaternion) -> LinkSolid:
    """Return a solid of the gripper, none of which is turned in it, where a mount (4, 4) holds it."""
    position = _vector(mount[:3, :3] @ solid.position + mount[:3, 3])
    opening = _vector(mount[:3, :3] @ solid.opening_offset) if any(solid.opening_offset) else solid.opening_offset
    return replace(solid, position=position, orientation=orientation, opening_offset=opening)


def _adapter(place: Array) -> tuple[LinkSolid, ...]:
    """Return the adapter between the flange, on which it lies, and a gripper at a place (3,) [m]."""
    begin = np.array([0.0, 0.0, ADAPTER_RADIUS])
    if min(float(np.linalg.norm(place - begin)), float(np.linalg.norm(place))) < MIN_ADAPTER:
        return ()
    return (_rod("adapter", 6, begin, place, ADAPTER_RADIUS, STEEL_COLOR),)


def _rods(connector: Connector) -> tuple[LinkSolid, ...]:
    """Return what is drawn of a connector: rods with a ball at each end but the first."""
    link, radius, made = connector.link, connector.radius, []
    for k, (begin, end) in enumerate(pairwise(connector.points), start=1):
        rod = _rod(f"rod {link}.{k}", link, begin, end, radius, JOINT_COLOR)
        ball = LinkSolid(f"ball {link}.{k}", link, "sphere", (radius,), _vector(end), color=JOINT_COLOR)
        made += [replace(one, visual_only=True) for one in (rod, ball)]
    return tuple(made)


def _rod(name: str, link: int, begin: Array, end: Array, radius: float, color: int) -> LinkSolid:
    """Return a cylinder from one point (3,) to another [m], in the frame of its link."""
    length = float(np.linalg.norm(end - begin))
    x, y, z = (float(v) for v in (end - begin) / length)
    lean = hypot(1.0 + z, y, x)  # the shortest turn of z towards the end
    turn = ((1.0 + z) / lean, -y / lean, x / lean, 0.0) if lean > 1e-9 else (0.0, 1.0, 0.0, 0.0)
    return LinkSolid(name, link, "cylinder", (radius, length), _vector((begin + end) / 2), turn, color)


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _tapered(x0: float, r0: float, x1: float, r1: float, corners: int = 12) -> tuple[tuple[float, float], ...]:
    """Outline around two circles on the x axis, x0 < x1, joined by their outer tangents."""
    lean = atan2(r0 - r1, sqrt((x1 - x0) ** 2 - (r0 - r1) ** 2))
    quarter = pi / 2 - lean
    right = [-quarter + 2 * quarter * k / (corners - 1) for k in range(corners)]
    left = [quarter + (2 * pi - 2 * quarter) * k / (corners - 1) for k in range(corners)]
    return tuple([(x1 + r1 * cos(t), r1 * sin(t)) for t in right] + [(x0 + r0 * cos(t), r0 * sin(t)) for t in left])


_ARM: Final = (
    LinkSolid("foot", 0, "cylinder", (0.16, 0.03), (0.0, 0.0, 0.015), color=JOINT_COLOR),
    LinkSolid("pedestal", 0, "cylinder", (0.085, 0.47), (0.0, 0.0, 0.265)),
    LinkSolid("collar", 0, "cylinder", (0.088, 0.016), (0.0, 0.0, 0.494), color=JOINT_COLOR, visual_only=True),
    LinkSolid("trunk", 1, "cylinder", (0.09, 0.27), (0.0, -0.035, 0.0), Z_TO_Y_ROTATION),
    LinkSolid("shoulder", 1, "cylinder", (0.1, 0.285), (0.0, 0.0, 0.0425)),
    LinkSolid("shoulder cap", 1, "cylinder", (0.075, 0.03), (0.0, 0.0, -0.115), color=JOINT_COLOR),
    LinkSolid("shoulder ring", 1, "cylinder", (0.1015, 0.014), (0.0, 0.0, 0.183), color=JOINT_COLOR, visual_only=True),
    LinkSolid("upper arm", 2, "prism", (0.085,), (0.0, 0.0, 0.2325), outline=_tapered(-0.4318, 0.125, 0.0, 0.075)),
    LinkSolid("shoulder cover", 2, "cylinder", (0.08, 0.02), (-0.4318, 0.0, 0.285), color=JOINT_COLOR),
    LinkSolid("elbow cover", 2, "cylinder", (0.05, 0.02), (0.0, 0.0, 0.285), color=JOINT_COLOR),
    LinkSolid("name plate", 2, "box", (0.16, 0.022, 0.004), (-0.2, 0.0, 0.275), color=PLATE_COLOR, visual_only=True),
    LinkSolid("elbow ring", 2, "cylinder", (0.06, 0.008), (0.0, 0.0, 0.1885), color=JOINT_COLOR, visual_only=True),
    # The prism's x runs along z of frame 3 (the forearm), its z along -y, its y along -x.
    LinkSolid("forearm", 3, "prism", (0.07,), (0.0, 0.0, 0.0), (0.5, 0.5, -0.5, 0.5),
         outline=_tapered(-0.02, 0.08, 0.31, 0.05)),
    LinkSolid("wrist roll", 4, "cylinder", (0.038, 0.075), (0.0, -0.075, 0.0), Z_TO_Y_ROTATION, JOINT_COLOR),
    LinkSolid("wrist yoke", 4, "cylinder", (0.034, 0.09), (0.0, 0.0, 0.0)),
    LinkSolid("wrist", 5, "sphere", (0.037,), (0.0, 0.0, 0.0), color=JOINT_COLOR),
    LinkSolid("flange", 6, "cylinder", (0.028, 0.025), (0.0, 0.0, -0.0125), color=STEEL_COLOR),
)  # fmt: skip
_GRIPPER: Final = (
    LinkSolid("palm", 6, "box", (0.044, 0.11, 0.035), (0.0, 0.0, 0.0175), color=JOINT_COLOR),
    LinkSolid("left finger", 6, "box", (0.022, 0.012, 0.1), (0.0, 0.026, 0.085), color=STEEL_COLOR,
         opening_offset=(0.0, FINGER_TRAVEL, 0.0)),
    LinkSolid("right finger", 6, "box", (0.022, 0.012, 0.1), (0.0, -0.026, 0.085), color=STEEL_COLOR,
         opening_offset=(0.0, -FINGER_TRAVEL, 0.0)),
)  # fmt: skip
