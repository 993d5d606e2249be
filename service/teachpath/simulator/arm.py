"""The physics of the simulated arm: a dynamic arm, its gripper, the object and the obstacles, in MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import mujoco
import numpy as np

from teachpath.errors import UnusableInput
from teachpath.motion.arm.mjcf import CARRIED_BODY, GRASP_WELD, write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.grasp import HALF_OPENING, grasp_fault, grasp_width
from teachpath.records import Array, Quaternion, Scene, Vector
from teachpath.simulator.settings import SimulatorSettings

STEP_NS: Final = 1_000_000
REST_SPEED: Final = 1e-3  # [rad/s and m/s] below which a body stands still


class SimulatedArm:
    """The physics: arm, gripper, object and obstacles, advanced by 1 ms a step.

    Attributes:
        gripper_opening: between the fingers [m]: the object's width while they hold it, else all or nothing; None
            without fingers.
    """

    def __init__(self, scene: Scene, arm: Arm, settings: SimulatorSettings, position: Sequence[float]) -> None:
        """Build the model of `scene`; raises UnusableInput when MuJoCo cannot."""
        try:
            self._model = mujoco.MjModel.from_xml_string(write_mjcf(scene, arm, timestep=STEP_NS / 1e9))
        except ValueError as error:
            raise UnusableInput(f"scene {scene.name!r} cannot be simulated: {error}") from None
        self._settings, self._start = settings, np.array(position)
        self._max_torque = arm.limits.torque
        self._object, self._arm = scene.carried, arm
        self._count = arm.joint_count
        self._friction = np.array(self._model.dof_frictionloss[: self._count])
        self._acceleration = np.zeros(self._model.nv)
        self._rate = np.zeros(self._model.nv)
        self._force = np.zeros(self._model.nv)
        self._integral = np.zeros(self._count)  # [N m]
        self.gripper_opening: float | None = None
        self.data: Any = mujoco.MjData(self._model)
        self.reset()

    def reset(self) -> None:
        """Put the arm where it began, at rest and with its gripper open, and the object at its start."""
        mujoco.mj_resetData(self._model, self.data)
        self.data.qpos[: self._count] = self._start
        self._integral[:] = 0.0
        self._open()
        mujoco.mj_forward(self._model, self.data)

    @property
    def position(self) -> Array:
        """Joint angles (joints,) [rad]."""
        return np.array(self.data.qpos[: self._count])

    @property
    def velocity(self) -> Array:
        """Joint velocities (joints,) [rad/s]."""
        return np.array(self.data.qvel[: self._count])

    @property
    def at_rest(self) -> bool:
        """Whether arm and object stand still."""
        return bool(np.abs(self.data.qvel).max() < REST_SPEED)

    @property
    def torque(self) -> Array:
        """Torques of the motors at the joints (joints,) [N m]."""
        return np.array(self.data.qfrc_actuator[: self._count])

    @property
    def object_pose(self) -> tuple[Vector, Quaternion]:
        """Position [m] and orientation of the carried object; all zeros when the scene has none."""
        if self._object is None:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
        x, y, z, w, i, j, k = (float(v) for v in self.data.qpos[self._count : self._count + 7])
        return (x, y, z), (w, i, j, k)

    def step(self, position: Array, velocity: Array, acceleration: Array) -> None:
        """Follow a target motion for 1 ms by computed torque (Siciliano et al., Robotics, Springer 2009, 8.5.2).

        Coulomb friction is compensated along the target's velocity, so that the motors do not chatter at rest. What is
        left of it there, an integral of the error takes up, which grows to twice the friction at most: without it an
        arm that stops on its way would rest beside its path.
        """
        mujoco.mj_step1(self._model, self.data)
        w = self._settings.bandwidth
        error = position - self.data.qpos[: self._count]
        self._acceleration[: self._count] = (
            acceleration + 3 * w * (velocity - self.data.qvel[: self._count]) + 3 * w**2 * error
        )
        force = self._force_of(self._acceleration)
        self._rate[: self._count] = w**3 * error
        integral = self._integral + self._force_of(self._rate) * (STEP_NS / 1e9)
        self._integral = np.clip(integral, -2 * self._friction, 2 * self._friction)
        torque = force + self.data.qfrc_bias[: self._count] - self.data.qfrc_passive[: self._count]
        torque += self._friction * np.tanh(velocity / 0.02) + self._integral
        self.data.ctrl[: self._count] = np.clip(torque, -self._max_torque, self._max_torque)
        mujoco.mj_step2(self._model, self.data)

    def _force_of(self, acceleration: Array) -> Array:
        """Return the torques (joints,) that inertia asks for at accelerations (nv,) of all degrees of freedom."""
        mujoco.mj_mulM(self._model, self.data, self._force, acceleration)
        return np.array(self._force[: self._count])

    def grasp(self) -> bool:
        """Grasp the object as it lies between the fingers; return False when the gripper does not take it there."""
        if not self._arm.has_gripper:
            return False
        has_fingers = self._arm.gripper == "parallel"
        self.gripper_opening = 0.0 if has_fingers else None
        if self._object is None:
            return False
        hand, carried = self.data.body(f"link{self._count}"), self.data.body(CARRIED_BODY)
        rotation = hand.xmat.reshape(3, 3)
        pose = np.eye(4)
        pose[:3, :3] = rotation.T @ carried.xmat.reshape(3, 3)
        pose[:3, 3] = rotation.T @ (carried.xpos - hand.xpos)
        mount = self._arm.gripper_mount
        in_gripper = pose if mount is None else np.linalg.inv(mount) @ pose
        if grasp_fault(self._object, in_gripper, self._arm):
            return False
        if has_fingers:
            self.gripper_opening = grasp_width(self._object, in_gripper)
        back, turn = np.empty(4), np.empty(4)
        mujoco.mju_negQuat(back, hand.xquat)
        mujoco.mju_mulQuat(turn, back, carried.xquat)
        weld = self._model.equality(GRASP_WELD)
        weld.data[:3] = 0.0  # anchor, in the object
        weld.data[3:6] = pose[:3, 3]
        weld.data[6:10] = turn
        self.data.eq_active[weld.id] = True
        return True

    def release(self) -> None:
        """Let the object go."""
        self._open()
        if self._object is not None:
            self.data.eq_active[self._model.equality(GRASP_WELD).id] = False

    def _open(self) -> None:
        has_fingers = self._arm.has_gripper and self._arm.gripper == "parallel"
        self.gripper_opening = 2 * HALF_OPENING if has_fingers else None
