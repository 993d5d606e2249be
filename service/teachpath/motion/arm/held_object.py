"""The object in the gripper as a rigid body where its pose is known; elsewhere a bound over all poses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.mjcf_shapes import numbers
from teachpath.motion.arm.puma560 import Array

HELD_BODY: Final = "held"
MAX_GRASP_DISTANCE: Final = 0.05  # [m] from grasp point to object's centre; an object farther off is not in the gripper
GRAVITY: Final = 9.81  # [m/s^2]
UPWARD_ACCELERATION: Final = np.array([0.0, 0.0, GRAVITY])  # [m/s^2] that a body at rest feels
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

    def write_mjcf(self, pose: Array) -> str:
        """Write it as a body at a pose (4, 4), without any solid."""
        inertial = f'pos="{numbers(self.center)}" quat="{numbers(self.axes)}" diaginertia="{numbers(self.moments)}"'
        place = f'pos="{numbers(pose[:3, 3])}" xyaxes="{numbers(pose[:3, :2].T.ravel())}"'
        return f'<body name="{HELD_BODY}" {place}><inertial {inertial} mass="{self.mass!r}"/></body>'

    def as_point(self) -> RigidBody:
        """Return the same mass at the origin."""
        return RigidBody(self.mass, np.zeros(3), self.axes, np.full(3, POINT_INERTIA))


@dataclass(frozen=True, eq=False)
class GraspPointMotion:
    """How the grasp point moves in n configurations, with the joints at a constant speed.

    Attributes:
        translation: (n, 3, joints) by which the joints move it [m/rad].
        turning: (n, 3, joints) by which they turn the arm's last link [1].
        pull: (n, 3) its acceleration, as a body feels it: with gravity [m/s^2].
        bend: (n, 3) angular acceleration of the last link [rad/s^2].
        spin: (n,) angular speed of the last link [rad/s].
    """

    translation: Array
    turning: Array
    pull: Array
    bend: Array
    spin: Array


class UnknownGrasp:
    """Bounds what an object asks of the motors that is held near the grasp point, nobody knows how.

    Against the same mass at the grasp point, its weight and inertia act off that by its distance, and it resists
    turning.

    Args:
        body: the object.

    Attributes:
        distance: of the object's centre of mass from the grasp point, at most [m].
        inertia: its largest moment about its centre of mass [kg m^2].
    """

    def __init__(self, body: RigidBody) -> None:
        self.distance: float = MAX_GRASP_DISTANCE + float(np.linalg.norm(body.center))
        self.inertia: float = float(body.moments.max())
        self._mass = body.mass

    def torques(self, motion: GraspPointMotion, accelerations: Array) -> Array:
        """Return by how much torques (n, k, joints) [N m] can differ from those of the same mass at the grasp point.

        Args:
            motion: in n configurations.
            accelerations: (n, k, joints) of the joints in each of them [rad/s^2].
        """
        pull = motion.pull[:, None] + np.einsum("nij,nkj->nki", motion.translation, accelerations)
        bend = motion.bend[:, None] + np.einsum("nij,nkj->nki", motion.turning, accelerations)
        return self._bounds(motion, np.linalg.norm(pull, axis=2), np.linalg.norm(bend, axis=2))

    def largest_torques(self, motion: GraspPointMotion, acceleration: Array) -> Array:
        """Return the same (n, joints) for all accelerations up to `acceleration` (joints,), of any signs.

        The arm may be slower, too: `motion` is that at full speed.
        """
        still = np.linalg.norm(motion.pull - UPWARD_ACCELERATION, axis=1) + GRAVITY
        pull = still + np.linalg.norm(motion.translation, axis=1) @ acceleration
        bend = np.linalg.norm(motion.bend, axis=1) + np.linalg.norm(motion.turning, axis=1) @ acceleration
        return np.asarray(self._bounds(motion, pull[:, None], bend[:, None])[:, 0])

    def _bounds(self, motion: GraspPointMotion, pull: Array, bend: Array) -> Array:
        """Return bounds (n, k, joints) for an acceleration `pull` and an angular one `bend` (n, k).

        The object's centre accelerates otherwise than the grasp point by its distance times `whirl`; a moment of
        inertia asks for at most that much, too.
        """
        whirl = (bend + motion.spin[:, None] ** 2)[:, :, None]
        lever_arms = np.linalg.norm(motion.translation, axis=1)[:, None] + self.distance
        shifted = self._mass * self.distance * (pull[:, :, None] + lever_arms * whirl)
        return np.asarray(shifted + self.inertia * whirl, dtype=np.float64)
