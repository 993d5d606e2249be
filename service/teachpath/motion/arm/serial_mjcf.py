"""Writes an arm that a user's model describes as an MJCF, alone in the world."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import pi
from typing import Final
from xml.sax.saxutils import quoteattr

from teachpath.motion.arm.mjcf_shapes import color_text, mesh_asset, numbers, shape_attributes
from teachpath.records import Pose, RevoluteJoint, SerialArm, SerialLink, Shape

PAYLOAD_DENSITY: Final = 300.0  # kg/m^3, of the payload, which is taken as a ball


def write_serial_mjcf(arm: SerialArm) -> str:
    """Write the MJCF of an arm.

    Bodies `link1` and on have the frames of the links, so that a body's pose is that of `serial_link_frames`; joints
    are `joint1` and on, torque motors `motor1` and on [N m]. A geom has the name of its solid, and contacts
    with obstacles alone.
    """
    return "\n".join(
        [
            '<mujoco model="arm">',
            '<compiler angle="radian" autolimits="true"/>',
            "<asset>",
            *serial_meshes(arm),
            "</asset>",
            "<worldbody>",
            *serial_bodies(arm),
            "</worldbody>",
            "<actuator>",
            *serial_motors(arm),
            "</actuator>",
            "</mujoco>",
        ]
    )


def serial_meshes(arm: SerialArm) -> Iterator[str]:
    """Yield the meshes of an arm's solids, each under the name of its solid."""
    return (mesh_asset(shape, shape.name) for shape in _solids(arm) if shape.kind == "mesh")


def serial_bodies(arm: SerialArm, mounted: Iterable[str] = ()) -> Iterator[str]:
    """Yield the bodies of an arm, base and all links within each other, and what is mounted on the last one."""
    yield f'<body name="base" {_placed(arm.base)}>'
    yield from map(_geom, arm.base_solids)
    for number, link in enumerate(arm.links, start=1):
        yield from _link(number, link)
    yield from _payload(arm)
    yield from mounted
    yield from ["</body>"] * (len(arm.links) + 1)


def serial_motors(arm: SerialArm) -> Iterator[str]:
    """Yield a torque motor for every joint."""
    return (_motor(number, joint) for number, joint in enumerate(arm.joints, start=1))


def _solids(arm: SerialArm) -> Iterator[Shape]:
    yield from arm.base_solids
    for link in arm.links:
        yield from link.solids


def _link(number: int, link: SerialLink) -> Iterator[str]:
    joint = link.joint
    yield f'<body name="link{number}" {_placed(link.pose)}>'
    yield (
        f'<joint name="joint{number}" pos="{numbers(joint.anchor)}" axis="{numbers(joint.axis)}" '
        f'range="{joint.lower.value!r} {joint.upper.value!r}" armature="{joint.armature!r}" '
        f'damping="{joint.damping!r}" frictionloss="{joint.friction!r}"/>'
    )
    if link.mass:
        inertia = numbers(link.inertia)
        yield f'<inertial pos="{numbers(link.center)}" mass="{link.mass!r}" fullinertia="{inertia}"/>'
    yield from map(_geom, link.solids)


def _payload(arm: SerialArm) -> Iterator[str]:
    if arm.payload_mass:
        radius = (3.0 * arm.payload_mass / (4.0 * pi * PAYLOAD_DENSITY)) ** (1 / 3)
        moments = numbers([0.4 * arm.payload_mass * radius**2] * 3)
        center = numbers(arm.payload_center)
        yield f'<body name="payload" {_placed(arm.tool)}>'
        yield f'<inertial pos="{center}" mass="{arm.payload_mass!r}" diaginertia="{moments}"/></body>'


def _placed(pose: Pose) -> str:
    return f'pos="{numbers(pose[0])}" quat="{numbers(pose[1])}"'


def _geom(shape: Shape) -> str:
    return (
        f"<geom name={quoteattr(shape.name)} {shape_attributes(shape, shape.name)} "
        f'{_placed((shape.position, shape.orientation))} rgba="{color_text(shape.color)}" mass="0" contype="0" '
        'conaffinity="1"/>'
    )


def _motor(number: int, joint: RevoluteJoint) -> str:
    limit = joint.torque.value
    return f'<motor name="motor{number}" joint="joint{number}" ctrlrange="{-limit!r} {limit!r}"/>'
