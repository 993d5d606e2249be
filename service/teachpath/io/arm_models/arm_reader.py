"""Reads an arm from a user's model in URDF or MJCF, with what the operator says beside it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.arm_models.chain import Chain, find_chain, joint_name
from teachpath.io.arm_models.examples import model_file
from teachpath.io.arm_models.joint_limits import limits_of
from teachpath.io.arm_models.links import (
    Inertial,
    bodies_of,
    joined_inertial,
    link_pose,
    product,
    solids_of,
    tool_pose,
)
from teachpath.io.arm_models.model_file import ModelFile, read_model_file
from teachpath.io.arm_models.operator_limits import OperatorLimits, read_limits
from teachpath.records import Array, Pose, RevoluteJoint, SerialArm, SerialLink, Vector
from teachpath.records.serial_arms import NO_POSE

GRAVITY = 9.81  # m/s^2


def read_arm(
    path: str | Path,
    *,
    name: str = "",
    base: Pose = NO_POSE,
    tool: str | Pose | None = None,
    limits: str | Path | None = None,
    gripper_length: float = 0.0,
) -> SerialArm:
    """Read an arm of six or seven revolute joints.

    Args:
        path: of a model in URDF or MJCF, whose meshes lie where it says; or `six-axis`, `seven-axis`: examples that
            come with the package.
        name: of the arm; that of the file when empty.
        base: pose of the model to the world.
        tool: name of the body or site that is the tool; or the tool's pose to the last link; None: the frame tool0,
            tcp, tool_center_point, attachment_site or flange of the model, else that of the last link.
        limits: TOML file with what the operator says of joints and payload (see `operator_limits`).
        gripper_length: from that tool's frame, on which teachpath's own gripper sits then, to the point between its
            fingers [m], 0.05 to 0.5; 0: there is no gripper.

    Raises:
        UnusableInput: the model cannot be read, is none of such an arm, or lacks what a plan needs.
    """
    if gripper_length and not 0.05 <= gripper_length <= 0.5:
        raise UnusableInput(f"a gripper of {gripper_length:g} m is outside 0.05 to 0.5; its fingers end at 0.135")
    file = read_model_file(model_file(path))
    chain = find_chain(file, tool if isinstance(tool, str) else None)
    operator = read_limits(
        None if limits is None else Path(limits), [joint_name(file.model, joint) for joint in chain.joints]
    )
    flange = tool if isinstance(tool, tuple) else tool_pose(file.model, chain)
    end = product(flange, ((0.0, 0.0, gripper_length), NO_POSE[1])) if gripper_length else flange
    groups = bodies_of(file, chain)
    arm = SerialArm(
        name=name or file.path.stem,
        links=_links(file, chain, groups[1:], end, operator),
        tool=end,
        base=base,
        base_solids=solids_of(file, groups[0], 0),
        payload_mass=operator.payload_mass,
        payload_center=operator.payload_center,
        held=tuple(joint_name(file.model, k) for k in range(file.model.njnt) if k not in chain.joints),
        gripper_length=gripper_length,
    )
    if not any(link.solids for link in arm.links):
        raise UnusableInput(
            f"{file.path}: no link has a solid that may collide; give each a <collision> (MJCF: a geom)"
        )
    return arm


def _links(
    file: ModelFile, chain: Chain, groups: list[list[int]], tool: Pose, operator: OperatorLimits
) -> tuple[SerialLink, ...]:
    model = file.model
    bodies = [int(model.jnt_bodyid[joint]) for joint in chain.joints]
    poses = [link_pose(model, chain, number) for number in range(len(chain.joints))]
    inertials = [joined_inertial(model, group, body) for group, body in zip(groups, bodies, strict=True)]
    if inertials[-1].mass == 0.0:
        raise UnusableInput(f"{file.path}: the last link has no mass; give it an <inertial>")
    payload = Inertial(
        operator.payload_mass, np.array(product(tool, (operator.payload_center, NO_POSE[1]))[0]), np.eye(3)
    )
    links = []
    for number, joint in enumerate(chain.joints):
        torque = _holding_torque(model.jnt_pos[joint], poses[number + 1 :], [*inertials[number:], payload])
        joint_limits = limits_of(file, joint, operator.joints.get(joint_name(model, joint), {}), torque)
        links.append(
            SerialLink(
                name=str(model.body(bodies[number]).name) or f"link {number + 1}",
                pose=poses[number],
                joint=RevoluteJoint(
                    joint_name(model, joint),
                    _vector(model.jnt_pos[joint]),
                    _vector(model.jnt_axis[joint] / np.linalg.norm(model.jnt_axis[joint])),
                    **joint_limits,
                    armature=float(model.dof_armature[model.jnt_dofadr[joint]]),
                    damping=_damping(file, joint),
                    friction=float(model.dof_frictionloss[model.jnt_dofadr[joint]]),
                ),
                mass=inertials[number].mass,
                center=_vector(inertials[number].center),
                inertia=_moments(inertials[number].inertia),
                solids=solids_of(file, groups[number], bodies[number]),
            )
        )
    return tuple(links)


def _damping(file: ModelFile, joint: int) -> float:
    return float(np.ravel(file.model.dof_damping[file.model.jnt_dofadr[joint]])[0])


def _holding_torque(anchor: Array, poses: list[Pose], inertials: list[Inertial]) -> float:
    """Return a torque [N m] with which a joint holds all behind it stretched out: no real arm has less.

    Args:
        anchor: (3,) of the joint in its link's frame [m].
        poses: of the links behind, each to the one before.
        inertials: of the joint's link, of the links behind, and of the payload in the last link's frame.
    """
    far = [float(np.linalg.norm(anchor))]
    for position, _ in poses:
        far.append(far[-1] + float(np.linalg.norm(position)))
    far.append(far[-1])  # the payload is on the last link
    return GRAVITY * sum(
        part.mass * (out + float(np.linalg.norm(part.center))) for part, out in zip(inertials, far, strict=True)
    )


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _moments(inertia: Array) -> tuple[float, ...]:
    return tuple(float(inertia[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
