"""Writes arm and scene as a MuJoCo model (MJCF), from the table of the arm and the list of its solids."""

from __future__ import annotations

from math import pi
from typing import Final
from xml.sax.saxutils import quoteattr

import numpy as np

from teachpath.motion.arm.convex_pieces import convex_shapes
from teachpath.motion.arm.geometry import LinkSolid, collision_solids, gripper_solids
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.mjcf_shapes import color_text, mesh_asset, numbers, shape_attributes
from teachpath.motion.arm.model import Arm, Payload
from teachpath.motion.arm.object_mass import OBJECT_DENSITY, object_mass
from teachpath.motion.arm.puma560 import GRIPPER_COM, GRIPPER_INERTIA, GRIPPER_MASS, Array, Link
from teachpath.motion.arm.serial_mjcf import serial_bodies, serial_meshes, serial_motors
from teachpath.records import Scene, Shape

CARRIED_BODY: Final = "carried"  # body and geom of the carried object
GRASP_WELD: Final = "grasp"  # the weld that holds it: set its relative pose, then eq_active

# The arm has contacts with obstacles, but not with itself or its object: the certificate keeps it clear of itself.
_OBSTACLE_CONTACTS: Final = 'contype="1" conaffinity="1"'
ARM_CONTACTS: Final = 'contype="0" conaffinity="1"'
_OBJECT_CONTACTS: Final = 'contype="2" conaffinity="1"'
_ZONE_CONTACTS: Final = 'contype="0" conaffinity="0"'  # a zone is a rule: nothing stands there


def write_mjcf(scene: Scene, arm: Arm, *, timestep: float = 0.001, held: str = "") -> str:
    """Write the MJCF of arm and scene.

    Bodies `link1` to `link6` lie in the Denavit-Hartenberg frames, so that a body's pose is that of `link_frames`;
    joints are `joint1` to `joint6`, torque motors `motor1` to `motor6` [N m]. A geom of the arm has the name of its
    solid, an obstacle's geom is `obstacle:<name>`, a keep-out zone's `zone:<name>`, with `/<number>` where it has
    several convex pieces, and the carried object's body is `carried`.

    Args:
        scene: floor, obstacles, keep-out zones and carried object, in the world.
        arm: that stands in the scene.
        timestep: of the simulation [s].
        held: a body that is fixed to the last link.

    Raises:
        UnusableInput: a shape of the scene is neither box, cylinder, sphere nor mesh.
    """
    return "\n".join(
        [
            '<mujoco model="puma560">',
            '<compiler angle="radian" autolimits="true"/>',
            f'<option timestep="{timestep}" gravity="0 0 -9.81" integrator="implicitfast"/>',
            "<asset>",
            *_meshes(arm),
            *[mesh_asset(shape, name) for name, shape in _bodies(scene) if shape.kind == "mesh"],
            "</asset>",
            "<worldbody>",
            *(_solids_of(0, arm) if arm.model is None else []),
            f'<geom name="floor" type="plane" size="0 0 1" pos="0 0 {float(scene.floor)!r}" {_OBSTACLE_CONTACTS}/>',
            *[_fixed(f"obstacle:{shape.name}", shape, _OBSTACLE_CONTACTS) for shape in convex_shapes(scene.obstacles)],
            *[_fixed(f"zone:{shape.name}", shape, _ZONE_CONTACTS) for shape in convex_shapes(scene.keep_out)],
            *_arm(arm, held),
            *([_carried(scene.carried)] if scene.carried else []),
            "</worldbody>",
            *([_grasp(arm)] if scene.carried else []),
            "<actuator>",
            *_motors(arm),
            "</actuator>",
            "</mujoco>",
        ]
    )


def physical_inertia(link: Link) -> Array:
    """Return moments of inertia (3,) that a rigid body can have, nearest to the published ones of `link`.

    No moment of a rigid body exceeds the sum of the other two. Of link 1, only the middle moment was published; of link
    3, the published middle moment is too large. All other moments keep their published values.
    """
    moments = np.array(link.inertia)
    if link.mass == 0.0:
        return np.array([moments[1] / 2, moments[1], moments[1] / 2])
    largest = int(np.argmax(moments))
    moments[largest] = min(moments[largest], (1.0 - 1e-9) * (moments.sum() - moments[largest]))
    return moments


def _meshes(arm: Arm) -> list[str]:
    if arm.model is not None:
        return list(serial_meshes(arm.model))
    return [_mesh(part) for part in collision_solids(arm) if part.kind == "prism"]


def _motors(arm: Arm) -> list[str]:
    if arm.model is not None:
        return list(serial_motors(arm.model))
    return [_motor(i + 1, link) for i, link in enumerate(arm.links)]


def _arm(arm: Arm, held: str) -> list[str]:
    if arm.model is not None:
        solids = [_link_solid(solid) for solid in gripper_solids(arm)]
        return list(serial_bodies(arm.model, [*([*solids, *_gripper(arm)] if arm.has_gripper else []), held]))
    zero = link_frames(np.zeros(arm.joint_count), arm)
    lines: list[str] = []
    for i, link in enumerate(arm.links, start=1):
        relative = np.linalg.inv(zero[i - 1]) @ zero[i]
        anchor = -relative[:3, :3].T @ relative[:3, 3]  # origin and z of the frame before, seen from this one
        lines += [
            f'<body name="link{i}" pos="{numbers(relative[:3, 3])}" xyaxes="{numbers(relative[:3, :2].T.ravel())}">',
            f'<joint name="joint{i}" pos="{numbers(anchor)}" axis="{numbers(relative[2, :3])}" '
            f'range="{link.lower!r} {link.upper!r}" armature="{link.motor_inertia * link.gear**2!r}" '
            f'damping="{link.viscous * link.gear**2!r}" '
            f'frictionloss="{abs(link.gear) * sum(link.coulomb) / 2!r}"/>',
            f'<inertial pos="{numbers(link.com)}" mass="{max(link.mass, 1e-3)!r}" '
            f'diaginertia="{numbers(physical_inertia(link))}"/>',
            *_solids_of(i, arm),
        ]
    lines += [*_gripper(arm), *_payload(arm.payload), held]
    return lines + ["</body>"] * len(arm.links)


def _gripper(arm: Arm) -> list[str]:
    if arm.gripper == "none":
        return []  # what the flange carries is its payload alone
    return [
        f'<body name="gripper"{_mount(arm)}>',
        f'<inertial pos="{numbers(GRIPPER_COM)}" mass="{GRIPPER_MASS}" diaginertia="{numbers(GRIPPER_INERTIA)}"/>',
        "</body>",
    ]


def _mount(arm: Arm) -> str:
    """Return where the gripper sits, as attributes of its body; none where it sits on the flange."""
    mount = arm.gripper_mount
    return "" if mount is None else f' pos="{numbers(mount[:3, 3])}" xyaxes="{numbers(mount[:3, :2].T.ravel())}"'


def _payload(payload: Payload) -> list[str]:
    """Return the payload as a ball of wood, without any solid; nothing where it has no mass."""
    if payload.mass == 0.0:
        return []
    radius = (3.0 * payload.mass / (4.0 * pi * OBJECT_DENSITY)) ** (1 / 3)
    moments = np.full(3, 0.4 * payload.mass * radius**2)
    inertial = f'pos="{numbers(payload.center)}" mass="{payload.mass!r}" diaginertia="{numbers(moments)}"'
    return [f'<body name="payload"><inertial {inertial}/></body>']


def _solids_of(link: int, arm: Arm) -> list[str]:
    return [_link_solid(part) for part in collision_solids(arm) if part.link == link]


def _link_solid(solid: LinkSolid) -> str:
    sizes = {
        "box": f'type="box" size="{numbers(np.array(solid.size) / 2)}"',
        "sphere": f'type="sphere" size="{numbers(solid.size)}"',
        "prism": f'type="mesh" mesh={quoteattr(solid.name)}',
    }
    size = sizes.get(solid.kind) or f'type="cylinder" size="{solid.size[0]!r} {solid.size[1] / 2!r}"'
    return (
        f'<geom name={quoteattr(solid.name)} {size} pos="{numbers(solid.position)}" '
        f'quat="{numbers(solid.orientation)}" rgba="{color_text(solid.color)}" mass="0" {ARM_CONTACTS}/>'
    )


def _mesh(solid: LinkSolid) -> str:
    half = solid.size[0] / 2
    corners = [[x, y, z] for x, y in solid.outline for z in (-half, half)]
    return f'<mesh name={quoteattr(solid.name)} vertex="{numbers(np.ravel(corners))}"/>'


def _bodies(scene: Scene) -> list[tuple[str, Shape]]:
    carried = [(CARRIED_BODY, scene.carried)] if scene.carried else []
    zones = [(f"zone:{shape.name}", shape) for shape in convex_shapes(scene.keep_out)]
    return [(f"obstacle:{shape.name}", shape) for shape in convex_shapes(scene.obstacles)] + zones + carried


def _fixed(name: str, shape: Shape, contacts: str) -> str:
    return (
        f'<geom name={quoteattr(name)} {shape_attributes(shape, name)} pos="{numbers(shape.position)}" '
        f'quat="{numbers(shape.orientation)}" rgba="{color_text(shape.color)}" {contacts}/>'
    )


def _carried(shape: Shape) -> str:
    return (
        f'<body name="{CARRIED_BODY}" pos="{numbers(shape.position)}" quat="{numbers(shape.orientation)}">'
        f'<freejoint name="{CARRIED_BODY}"/><geom name="{CARRIED_BODY}" {shape_attributes(shape, CARRIED_BODY)} '
        f'mass="{object_mass(shape)!r}" rgba="{color_text(shape.color)}" {_OBJECT_CONTACTS}/></body>'
    )


def _grasp(arm: Arm) -> str:
    hand = f"link{arm.joint_count}"
    return f'<equality><weld name="{GRASP_WELD}" body1="{hand}" body2="{CARRIED_BODY}" active="false"/></equality>'


def _motor(number: int, link: Link) -> str:
    return f'<motor name="motor{number}" joint="joint{number}" ctrlrange="{-link.torque} {link.torque}"/>'
