"""The object in the gripper as a rigid body where its pose is known; elsewhere a bound over all poses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import mujoco
import numpy as np

from teachpath.motion.arm.mjcf_shapes import mesh_asset, numbers, shape_attributes
from teachpath.motion.arm.object_mass import object_mass
from teachpath.motion.arm.puma560 import Array
from teachpath.records import Shape

HELD_BODY: Final = "held"
MAX_GRASP_DISTANCE: Final = 0.05  # [m] from grasp point to object's centre; an object farther off is not in the gripper
GRAVITY: Final = 9.81  # [m/s^2]
POINT_INERTIA: Final = 1e-9  # [kg m^2], of what counts as a point: MuJoCo wants some


@dataclass(frozen=True, eq=False)
class RigidBody:
    """How an object resists: its mass [kg], and in its own frame, centre of mass [m] and moments about that.

    Attributes:
        axes: quaternion (w, x, y, z) of the principal axes.
        moments: of inertia about them [kg m^2].
    """

    mass: float
    center: Array
    axes: Array
    moments: Array

    @classmethod
    def of_shape(cls, shape: Shape) -> RigidBody:
        """Take an object as solid, of one density."""
        meshes = mesh_asset(shape, HELD_BODY) if shape.kind == "mesh" else ""
        geom = f'<geom {shape_attributes(shape, HELD_BODY)} mass="{object_mass(shape)!r}"/>'
        body = f"<worldbody><body><freejoint/>{geom}</body></worldbody>"
        model = mujoco.MjModel.from_xml_string(f"<mujoco><asset>{meshes}</asset>{body}</mujoco>")
        return cls(float(model.body_mass[1]), model.body_ipos[1], model.body_iquat[1], model.body_inertia[1])

    def write_mjcf(self, pose: Array) -> str:
        """Write it as a body at a pose (4, 4), without any solid."""
        inertial = f'pos="{numbers(self.center)}" quat="{numbers(self.axes)}" diaginertia="{numbers(self.moments)}"'
        place = f'pos="{numbers(pose[:3, 3])}" xyaxes="{numbers(pose[:3, :2].T.ravel())}"'
        return f'<body name="{HELD_BODY}" {place}><inertial {inertial} mass="{self.mass!r}"/></body>'

    def as_point(self) -> RigidBody:
        """Return the same mass at the origin."""
        return RigidBody(self.mass, np.zeros(3), self.axes, np.full(3, POINT_INERTIA))


class UnknownGrasp:
    """Bounds what an object asks of the motors that is held near the grasp point, nobody knows how.

    Against the same mass at the grasp point, its weight and inertia act off that by its distance, and it resists
    turning. With the sums of the joints' speeds s and accelerations a, the arm's last link turns by s at most, and that
    changes by a + s^2; a point within L of every axis accelerates by at most L (a + s^2).

    Args:
        body: the object.
        lever_arms: (joints,) bounds of the distance of the grasp point to each joint's axis [m].

    Attributes:
        distance: of the object's centre of mass from the grasp point, at most [m].
        inertia: its largest moment about its centre of mass [kg m^2].
    """

    def __init__(self, body: RigidBody, lever_arms: Array) -> None:
        self.distance: float = MAX_GRASP_DISTANCE + float(np.linalg.norm(body.center))
        self.inertia: float = float(body.moments.max())
        self._mass, self._lever_arms = body.mass, lever_arms

    def torques(self, velocity: Array, acceleration: Array) -> Array:
        """Return by how much torques (n, joints) [N m] can differ from those of the same mass at the grasp point.

        Args:
            velocity: (n, joints) [rad/s].
            acceleration: (n, joints) or (joints,), of any signs [rad/s^2].
        """
        speed = np.abs(velocity).sum(axis=-1, keepdims=True)
        turning = np.abs(acceleration).sum(axis=-1, keepdims=True) + speed**2
        pull = GRAVITY + self._lever_arms.max() * turning  # [m/s^2] of the grasp point
        shifted = self._mass * self.distance * (pull + (self._lever_arms + self.distance) * (turning + speed**2))
        return np.asarray(shifted + self.inertia * (turning + speed**2), dtype=np.float64)
