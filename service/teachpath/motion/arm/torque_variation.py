"""Bounds how much the torques of the motors change while the joints go on for a moment.

A body whose centre lies within R_i of the axis of joint i moves there by at most R_i a radian; what it moves by changes
by at most R_max(i, j) a radian of joint j, for the joint nearer to the body turns the arm that is left, and so on for
every further derivative. So the derivatives of the inertia matrix and of the torques of gravity have bounds that hold
in every configuration (Siciliano et al., Robotics, Springer 2009, section 7.1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.serial_kinematics import lever_arms as serial_lever_arms

GRAVITY: Final = 9.81  # [m/s^2]
INERTIA_TURNS: Final = (4.0, 16.0)  # times a body's inertia, that its first and second derivative have at most


@dataclass(frozen=True)
class MovingMass:
    """A body that the arm moves.

    Attributes:
        link: to which it is fixed, from 1.
        radius: of its centre of mass from the origin of that link's frame [m].
        mass: [kg].
        inertia: its largest moment of inertia about its centre of mass [kg m^2].
    """

    link: int
    radius: float
    mass: float
    inertia: float


class TorqueVariation:
    """Bounds for one arm with all that it carries."""

    def __init__(self, masses: Sequence[MovingMass], arm: Arm) -> None:
        count = arm.joint_count
        self._gravity = np.zeros((count, count))  # [N m/rad]
        self._first = np.zeros((count,) * 3)  # of the inertia matrix [kg m^2/rad]
        self._second = np.zeros((count,) * 4)
        for body in masses:
            self._add(body, _lever_arms(body, arm))

    def bound(self, turns: Array, speeds: Array, speed_changes: Array, accelerations: Array) -> Array:
        """Return by how much torques without friction change at most (joints,) [N m], the accelerations being the same.

        Args:
            turns: (joints,) by how much the joints turn at most [rad].
            speeds: (joints,) largest speeds at the begin [rad/s].
            speed_changes: (joints,) by which they change at most [rad/s].
            accelerations: (joints,) largest ones [rad/s^2].
        """
        shift = self._gravity @ turns + np.einsum("ilj,l,j->i", self._first, accelerations, turns)
        # Torques by speeds: the sum over j and k of (dM_ij / dq_k - dM_jk / dq_i / 2) v_j v_k.
        pairs = np.outer(speeds, speed_changes)
        pairs = pairs + pairs.T + np.outer(speed_changes, speed_changes)
        shift += np.einsum("ijk,jk->i", self._first, pairs) + np.einsum("jki,jk->i", self._first, pairs) / 2
        fast = np.einsum("j,k,l->jkl", speeds, speeds, turns)
        shift += np.einsum("ijkl,jkl->i", self._second, fast) + np.einsum("jkil,jkl->i", self._second, fast) / 2
        return np.asarray(shift)

    def _add(self, body: MovingMass, lever_arms: Array) -> None:
        joints = np.arange(body.link)
        one, two = lever_arms[np.maximum.outer(joints, joints)], lever_arms[: body.link]
        m, part = body.mass, np.ix_(joints, joints)
        self._gravity[part] += GRAVITY * m * one
        first = np.einsum("ij,l->ilj", one, two) + np.einsum("lj,i->ilj", one, two)
        self._first[np.ix_(joints, joints, joints)] += m * first + INERTIA_TURNS[0] * body.inertia
        third = lever_arms[np.maximum(np.maximum.outer(joints, joints)[:, :, None], joints)]
        second = np.einsum("ijk,l->iljk", third, two) + np.einsum("ljk,i->iljk", third, two)
        second += np.einsum("ij,lk->iljk", one, one) + np.einsum("ik,lj->iljk", one, one)
        self._second[np.ix_(joints, joints, joints, joints)] += m * second + INERTIA_TURNS[1] * body.inertia


def _lever_arms(body: MovingMass, arm: Arm) -> Array:
    """Return bounds (joints,) on the distance of the body's centre of mass to each joint's axis, wherever it is [m]."""
    lever_arms, far = np.zeros(arm.joint_count), body.radius
    if arm.model is not None:
        radii = np.zeros(body.link)
        radii[-1] = body.radius
        lever_arms[: body.link] = serial_lever_arms(radii, arm.model)
        return lever_arms
    for joint in range(body.link - 1, -1, -1):
        link = arm.links[joint]
        lever_arms[joint] = abs(link.a) + far
        far += float(np.hypot(link.a, link.d))
    return lever_arms
