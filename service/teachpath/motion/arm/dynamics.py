"""Torques of the motors along a motion: inverse dynamics of the arm (MuJoCo), with friction and what it holds."""

from __future__ import annotations

from typing import Final, NamedTuple

import mujoco
import numpy as np

from teachpath.motion.arm.held_object import HELD_BODY, GraspPointMotion, RigidBody, UnknownGrasp
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.mjcf import write_mjcf
from teachpath.motion.arm.mjcf_shapes import mesh_asset, shape_attributes
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.object_mass import object_mass
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.torque_variation import MovingMass, TorqueVariation
from teachpath.records import Scene, Shape

COULOMB_FADE_SPEED: Final = 0.02  # rad/s, joint speed below which Coulomb friction fades out


class Dynamics:
    """The arm without surroundings; what it holds is a rigid body.

    Args:
        arm: with its payload.
        carried: the object in the gripper; None: it carries none.
        grasp_pose: (4, 4) to the tool from the object; None: it is not known. Then the object counts as a point at the
            grasp point, and all bounds hold wherever it is held within `MAX_GRASP_DISTANCE`, however it is turned.

    Attributes:
        carried_mass: of the object [kg]; 0: it carries none.
    """

    def __init__(self, arm: Arm, carried: Shape | None = None, grasp_pose: Array | None = None) -> None:
        self._arm, held = arm, ""
        self.carried_mass: float = 0.0
        self._grasp: UnknownGrasp | None = None
        if carried is not None:
            body = solid_body(carried)
            self.carried_mass = body.mass
            if grasp_pose is None:
                self._grasp = UnknownGrasp(body)
                body, grasp_pose = body.as_point(), np.eye(4)
            held = body.write_mjcf(arm.tool_matrix @ grasp_pose)
        self._model = mujoco.MjModel.from_xml_string(write_mjcf(Scene("nothing"), arm, held=held))
        self._model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT  # of the floor, which would only cost time
        self._data = mujoco.MjData(self._model)
        if arm.model is None:
            # Coulomb friction at the joint is the mean of both directions, as the simulated arm has it.
            self._coulomb = np.array([abs(link.gear) * sum(link.coulomb) / 2 for link in arm.links])
            self._viscous = np.array([link.viscous * link.gear**2 for link in arm.links])
        else:
            self._coulomb = np.array([joint.friction for joint in arm.model.joints])
            self._viscous = np.array([joint.damping for joint in arm.model.joints])
        self._variation = TorqueVariation(self._moving_masses(), arm)

    def torques(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """Return the torques (n, joints) [N m] at configurations, velocities and accelerations (n, joints).

        Siciliano et al., Robotics, Springer 2009, eq. (7.42), with the motors' inertia, viscous and Coulomb friction.
        """
        inertia, gravity, coriolis, _ = self._terms(q, velocity)
        friction = self._viscous * velocity + self._coulomb * np.tanh(velocity / COULOMB_FADE_SPEED)
        return np.asarray(np.einsum("nij,nj->ni", inertia, acceleration) + gravity + coriolis + friction)

    def torque_bounds(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """Return upper bounds (n, joints) [N m] of the torques that any sequence of commands can need on a path.

        Args:
            q: (n, joints) configurations on the path.
            velocity: (n, joints) at full speed; the arm may be slower, forward or backward.
            acceleration: (joints,) limits, which may be used in any combination of signs.
        """
        inertia, gravity, coriolis, grasp_point = self._terms(q, velocity)
        # Gravity does not depend on the rate, Coriolis and centrifugal torques grow with its square.
        steady = np.maximum(np.abs(gravity), np.abs(gravity + coriolis))
        if self._grasp is not None:
            steady = steady + self._grasp.largest_torques(grasp_point, acceleration)
        return np.asarray(np.abs(inertia) @ acceleration + steady + np.abs(self._viscous * velocity) + self._coulomb)

    def motion_bounds(self, states: Array, turns: Array, period: float, stride: int = 1) -> Array:
        """Return upper bounds (m, joints) [N m] of the torques at any moment of n periods, a row for each stride.

        Args:
            states: (n + 1, 3, 6) position, velocity and acceleration of the joints at the ends of the periods, in each
                of which the acceleration is linear in time.
            turns: (n, joints) bounds of how far each joint turns in a period [rad].
            period: [s].
            stride: periods from one configuration whose torques are computed to the next; the more, the looser.
        """
        begins = np.arange(0, len(turns), stride)
        q, velocity, acceleration = states[begins, 0], states[:, 1], states[:, 2]
        inertia, gravity, coriolis, grasp_point = self._terms(q, velocity[begins])
        # What is linear in time is largest at an end of a period.
        ends = acceleration[np.minimum(begins[:, None] + np.arange(stride + 1), len(turns))]
        torques = np.abs(np.einsum("nij,nkj->nki", inertia, ends) + (gravity + coriolis)[:, None])
        if self._grasp is not None:
            torques += self._grasp.torques(grasp_point, ends)
        largest = torques.max(axis=1)
        speeds, accelerations = np.abs(velocity).max(axis=0), np.abs(acceleration).max(axis=0)
        changes = stride * period * accelerations
        turned = np.add.reduceat(turns, begins).max(axis=0)
        variation = self._variation.bound(turned, speeds, changes, accelerations)
        friction = self._viscous * (speeds + changes) + self._coulomb
        return np.asarray(largest + variation + friction, dtype=np.float64)

    def acceleration_share(self, q: Array, velocity: Array, acceleration: Array) -> float:
        """Return the largest share of the acceleration limits (joints,) at which `torque_bounds` keep those of torque.

        At zero or less, the motors cannot even hold the arm.
        """
        steady = self.torque_bounds(q, velocity, 0.0 * acceleration)
        moving = self.torque_bounds(q, velocity, acceleration) - steady
        return float(np.min((self._arm.limits.torque - steady) / moving))

    def _moving_masses(self) -> list[MovingMass]:
        model, data = self._model, self._data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        origins, found = link_frames(np.zeros(self._arm.joint_count), self._arm)[:, :3, 3], []
        for body in range(1, model.nbody):
            link = _link_of(model, body)
            if link:
                radius = float(np.linalg.norm(data.xipos[body] - origins[link]))
                inertia = float(model.body_inertia[body].max())
                if self._grasp is not None and model.body(body).name == HELD_BODY:
                    radius, inertia = radius + self._grasp.distance, self._grasp.inertia
                found.append(MovingMass(link, radius, model.body_mass[body], inertia))
        return found

    def _terms(self, q: Array, velocity: Array) -> _Terms:
        model, data = self._model, self._data
        count, rows = self._arm.joint_count, len(q)
        inertia, gravity, coriolis = np.empty((rows, count, count)), np.empty_like(q), np.empty_like(q)
        jacobians, felt = np.empty((rows, 2, 3, model.nv)), np.empty((rows, 6))
        whole, held = np.empty((model.nv, model.nv)), -1 if self._grasp is None else model.body(HELD_BODY).id
        for row, (at, speed) in enumerate(zip(q, velocity, strict=True)):
            data.qpos[:count], data.qvel[:count] = at, 0.0
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            gravity[row] = data.qfrc_bias[:count]
            data.qvel[:count] = speed
            mujoco.mj_fwdVelocity(model, data)
            coriolis[row] = data.qfrc_bias[:count] - gravity[row]
            mujoco.mj_fullM(model, data, whole)
            inertia[row] = whole[:count, :count]
            if held >= 0:
                mujoco.mj_jacBody(model, data, *jacobians[row], held)
                mujoco.mj_rnePostConstraint(model, data)  # accelerations: those of joints at a constant speed
                mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_BODY, held, felt[row], 0)
        translation, turning = jacobians[:, 0, :, :count], jacobians[:, 1, :, :count]
        spin = np.linalg.norm(np.einsum("nij,nj->ni", turning, velocity), axis=1) if held >= 0 else np.empty(rows)
        return _Terms(
            inertia, gravity, coriolis, GraspPointMotion(translation, turning, felt[:, 3:], felt[:, :3], spin)
        )


class _Terms(NamedTuple):
    """Of n configurations: inertia matrices (n, joints, joints), torques (n, joints) of gravity and of speed.

    `grasp_point` has numbers only where the grasp is unknown.
    """

    inertia: Array
    gravity: Array
    coriolis: Array
    grasp_point: GraspPointMotion


def _link_of(model: mujoco.MjModel, body: int) -> int:
    """Return the link, counted from 1, to which a body of the arm belongs; 0 for what stands still."""
    while body and not model.body_jntnum[body]:
        body = model.body_parentid[body]
    return int(model.body_jntadr[body]) + 1 if body else 0


def solid_body(shape: Shape) -> RigidBody:
    """Return how an object resists that is solid, of one density."""
    meshes = mesh_asset(shape, HELD_BODY) if shape.kind == "mesh" else ""
    geom = f'<geom {shape_attributes(shape, HELD_BODY)} mass="{object_mass(shape)!r}"/>'
    body = f"<worldbody><body><freejoint/>{geom}</body></worldbody>"
    model = mujoco.MjModel.from_xml_string(f"<mujoco><asset>{meshes}</asset>{body}</mujoco>")
    return RigidBody(float(model.body_mass[1]), model.body_ipos[1], model.body_iquat[1], model.body_inertia[1])
