"""Inverse kinematics for a live hand: the arm stays on the branch on which it began to follow.

The last three joints are the wrist, which alone gives the tool its orientation where the joints before it are known. Of
the Puma 560 all of it has a closed form; for an arm that a user's model describes, Newton's method follows from pose to
pose. Of seven joints, all move as little as they can.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import PathRefused
from teachpath.motion.arm.kinematics import (
    BRANCH_NAMES,
    inverse_kinematics,
    min_singular_value,
    tool_pose,
    wrist_joints,
)
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.newton import turn_wrists
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.serial_ik import POSE_TOLERANCE, RESIDUAL, follow_poses, geometry, pose_errors
from teachpath.motion.arm.serial_kinematics import serial_jacobian

WRIST: Final = 3  # joints of the wrist, the last ones
ITERATIONS: Final = 12  # of Newton's method, from the pose before


@dataclass(frozen=True, eq=False)
class HandKinematics:
    """Inverse kinematics of one arm on one branch.

    Attributes:
        arm: that follows.
        branch: in `BRANCH_NAMES`; of a user's model, 0.
    """

    arm: Arm
    branch: int

    @classmethod
    def at(cls, here: Array, arm: Arm, least_singular: float) -> HandKinematics:
        """Return those of the branch that a configuration (joints,) is on.

        Raises:
            PathRefused: it is on none, or, of a user's model, it is singular.
        """
        if arm.model is not None:
            made = cls(arm, 0)
            if (value := float(made.singular_values(here[None])[0])) < least_singular:
                raise PathRefused(
                    f"{arm.name} rests in a singular pose (least singular value {value:.3f}, limit {least_singular:g})"
                    ", from where no hand leads it; say another home (motion.home)"
                )
            return made
        solved = inverse_kinematics(tool_pose(here, arm)[None], arm, previous_q4=float(here[3])).joints[0]
        off = np.abs(np.angle(np.exp(1j * (solved - here)))).max(axis=1)
        if off.min() > 1e-3:
            raise PathRefused(
                f"the arm stands on none of its {len(BRANCH_NAMES)} branches; bring it nearer to its home first"
            )
        return cls(arm, int(np.argmin(off)))

    def follow(self, begin: Array, poses: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Follow ways of the tool from one configuration.

        Args:
            begin: (joints,) where all begin [rad].
            poses: (k, n, 4, 4) to world from the tool, one after another behind the begin.

        Returns:
            (k, n + 1, joints) configurations, the begin first; and (k, n) which poses are out of reach.
        """
        ways, count = poses.shape[:2]
        if (model := self.arm.model) is not None:
            first = np.broadcast_to(tool_pose(begin, self.arm), (ways, 1, 4, 4))
            joints = follow_poses(np.concatenate([first, poses], axis=1), np.tile(begin, (ways, 1)), model, ITERATIONS)
            off = pose_errors(poses.reshape(-1, 4, 4), joints[:, 1:].reshape(-1, len(begin)), model)
            return joints, (np.abs(off).max(axis=1) > POSE_TOLERANCE).reshape(ways, count)
        solved = inverse_kinematics(poses.reshape(-1, 4, 4), self.arm, previous_q4=float(begin[3]))
        joints = solved.joints[:, self.branch].reshape(ways, count, len(begin))
        excess = solved.reach_excess[:, self.branch].reshape(ways, count)
        return np.unwrap(np.concatenate([np.tile(begin, (ways, 1, 1)), joints], axis=1), axis=1), excess > 0

    def singular_values(self, q: Array) -> Array:
        """Return how far configurations (..., joints) are from singular ones: the least singular value (...,).

        Of a user's model it is the smaller one of the whole arm and of the wrist, which must turn the tool alone.
        """
        values = min_singular_value(q, self.arm)
        if self.arm.model is None:
            return values
        axes = serial_jacobian(q, self.arm.model)[..., 3:, -WRIST:]
        return np.asarray(np.minimum(values, np.linalg.svd(axes, compute_uv=False)[..., -1]))

    def wrist(self, before: Array, orientations: Array, begin: Array) -> Array | None:
        """Return the joints of the wrist (n, 3) that give the tool its orientations; None where they do not follow.

        Args:
            before: (n, joints - 3) those before the wrist [rad], each near to the one before.
            orientations: (n, 3, 3) to world from the tool.
            begin: configuration (joints,) before the first.
        """
        if (model := self.arm.model) is not None:
            found = np.empty((len(before), WRIST))
            given = (*geometry(model), ITERATIONS, RESIDUAL)
            off = turn_wrists(np.ascontiguousarray(before), np.ascontiguousarray(orientations), begin, *given, found)
            return found if off <= POSE_TOLERANCE else None
        flip = self.branch % 2 == 1
        solved = wrist_joints(before, orientations, self.arm, flip=flip, previous_q4=float(begin[3]))
        return np.unwrap(np.concatenate([begin[None, -WRIST:], solved]), axis=0)[1:]


def warm_up_hand(arm: Arm) -> None:
    """Compile the kernels that lead an arm from a user's model, or load them, so that no hand waits for them."""
    if arm.model is not None:
        q = (arm.limits.lower + arm.limits.upper) / 2
        pose, kinematics = tool_pose(q, arm), HandKinematics(arm, 0)
        kinematics.follow(q, pose[None, None])
        kinematics.wrist(q[None, :-WRIST], pose[None, :3, :3], q)
