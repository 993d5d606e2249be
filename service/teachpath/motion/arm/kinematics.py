"""Forward kinematics, Jacobian and closed-form inverse kinematics of the arm."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, hypot, sin
from typing import Final

import numpy as np
from numpy.typing import NDArray

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.serial_kinematics import serial_jacobian, serial_link_frames, serial_tool_pose

Array = NDArray[np.float64]

# Below this sine of joint 5, the axes of joints 4 and 6 coincide, and only the sum of their angles is determined.
SINGULAR_WRIST_SINE: Final = 1e-9

BRANCH_NAMES: Final = tuple(
    f"{shoulder} {elbow} {wrist}"
    for shoulder in ("righty", "lefty")
    for elbow in ("up", "down")
    for wrist in ("noflip", "flip")
)


@dataclass(frozen=True)
class LinkLengths:
    """The lengths that the inverse kinematics uses [m]; `forearm_angle` is that between forearm and link 3 [rad]."""

    shoulder_height: float  # of joint 2 above the floor
    upper_arm: float
    shoulder_offset: float  # from the axis of joint 1 to the plane of the arm
    forearm: float  # from elbow to wrist
    forearm_angle: float
    wrist_in_tool: tuple[float, float, float]  # wrist centre in the tool's frame

    @classmethod
    def of_arm(cls, arm: Arm) -> LinkLengths:
        """Return the lengths of an arm."""
        rows = arm.links
        forearm, bend = hypot(rows[2].a, rows[3].d), atan2(rows[3].d, rows[2].a)
        wrist = (0.0, 0.0, -(rows[5].d + arm.tool_length))
        if arm.tool is not None:
            x, y, z = (float(v) for v in (np.linalg.inv(arm.tool_matrix) @ (0.0, 0.0, -rows[5].d, 1.0))[:3])
            wrist = (x, y, z)
        return cls(rows[0].d, rows[1].a, rows[2].d, forearm, bend, wrist)


def link_frames(q: Array, arm: Arm) -> Array:
    """Compute the frames of all links (standard Denavit-Hartenberg; Paul, Robot Manipulators, MIT Press 1981, ch. 2).

    Args:
        q: (..., 6) configurations [rad].
        arm: whose links they are.

    Returns:
        (..., 7, 4, 4) poses to world from link 0 (the world itself) to link 6 (the flange).
    """
    q = np.asarray(q, dtype=np.float64)
    if arm.model is not None:
        world = np.broadcast_to(np.eye(4), (*q.shape[:-1], 1, 4, 4))
        return np.concatenate([world, serial_link_frames(q, arm.model)], axis=-3)
    frames = np.zeros((*q.shape[:-1], 7, 4, 4))
    frames[..., 0, :, :] = np.eye(4)
    for i, link in enumerate(arm.links):
        frames[..., i + 1, :, :] = frames[..., i, :, :] @ _link_matrix(q[..., i], link.d, link.a, link.alpha)
    return frames


def tool_pose(q: Array, arm: Arm) -> Array:
    """Compute the pose (..., 4, 4) to world from the tool (origin: tool centre point, z: out of the gripper)."""
    if arm.model is not None:
        return serial_tool_pose(q, arm.model)
    pose = gripper_frame(link_frames(q, arm)[..., 6, :, :], arm).copy()
    pose[..., :3, 3] += arm.tool_length * pose[..., :3, 2]
    return pose


def gripper_frame(flange: Array, arm: Arm) -> Array:
    """Return the poses (..., 4, 4) of the gripper where those of the flange are known."""
    return flange if arm.gripper_mount is None else np.asarray(flange @ arm.gripper_mount)


def jacobian(q: Array, arm: Arm) -> Array:
    """Compute the geometric Jacobian of the tool centre point in world axes.

    Args:
        q: (..., 6) configurations [rad].

    Returns:
        (..., 6, 6): rows velocity x y z [m/rad], then angular velocity x y z [1].
    """
    if arm.model is not None:
        return serial_jacobian(q, arm.model)
    frames = link_frames(q, arm)
    gripper = gripper_frame(frames[..., 6, :, :], arm)
    tool = gripper[..., :3, 3] + arm.tool_length * gripper[..., :3, 2]
    axes = frames[..., :6, :3, 2]  # (..., 6 joints, 3)
    lever_arms = tool[..., None, :] - frames[..., :6, :3, 3]
    return np.concatenate([np.swapaxes(np.cross(axes, lever_arms), -1, -2), np.swapaxes(axes, -1, -2)], axis=-2)


def downward_poses(positions: Array, roll: float) -> Array:
    """Build tool poses that point straight down.

    Args:
        positions: (..., 3) grasp points [m], world.
        roll: angle about the vertical [rad]; at 0 the fingers close along y of the world.

    Returns:
        (..., 4, 4) poses to world from the tool.
    """
    c, s = cos(roll), sin(roll)
    poses = np.zeros((*np.shape(positions)[:-1], 4, 4))
    poses[..., :3, :3] = np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])
    poses[..., :3, 3] = positions
    poses[..., 3, 3] = 1.0
    return poses


@dataclass(frozen=True, eq=False)
class IkSolutions:
    """All inverse kinematics of n poses.

    Attributes:
        joints: (n, 8, 6) [rad], each in (-pi, pi], in the order of `BRANCH_NAMES`. Where a pose is out of reach, the
            arm is stretched or folded towards it, and misses it.
        reach_excess: (n, 8) how far the wrist centre lies outside the reach [m]; at most 0 for a pose within reach.
        beyond_outer_reach: (n,) True where the wrist centre is too far away, False where it is too near.
    """

    joints: Array
    reach_excess: Array
    beyond_outer_reach: NDArray[np.bool_]


def inverse_kinematics(poses: Array, arm: Arm, *, previous_q4: float = 0.0) -> IkSolutions:
    """Solve the inverse kinematics in closed form, all 8 branches (after Paul 1981, ch. 3, and Lee & Ziegler 1984).

    The tool's pose to the flange is removed first. At a singular wrist (joint 5 zero), joint 4 keeps the value of the
    pose before it.

    Args:
        poses: (n, 4, 4) to world from the tool.
        arm: that is to bring its tool there.
        previous_q4: joint 4 before the first pose [rad], for a path that begins at a singular wrist.
    """
    lengths = LinkLengths.of_arm(arm)
    joints = np.zeros((len(poses), 8, 6))
    reach = _Reach.of(poses, lengths)
    for branch in range(8):
        side = 1.0 if branch < 4 else -1.0
        up = (branch // 2) % 2 == 0
        joints[:, branch, :3] = reach.shoulder_and_elbow(side, (-1.0 if up else 1.0) * side)
        joints[:, branch, 3:] = wrist_joints(
            joints[:, branch, :3], poses[:, :3, :3], arm, flip=branch % 2 == 1, previous_q4=previous_q4
        )
    joints = np.pi - np.mod(np.pi - joints, 2 * np.pi)
    return IkSolutions(joints, np.repeat(reach.excess[:, None], 8, axis=1), reach.beyond)


def wrist_joints(arm_joints: Array, orientations: Array, arm: Arm, *, flip: bool, previous_q4: float = 0.0) -> Array:
    """Solve for joints 4 to 6, which give the tool its orientation where joints 1 to 3 are known.

    Args:
        arm_joints: (n, 3) joints 1 to 3 [rad].
        orientations: (n, 3, 3) to world from the tool.
        flip: which of the two solutions.
        previous_q4: joint 4 before the first row [rad], for a way that begins at a singular wrist.

    Returns:
        (n, 3) joints 4 to 6 [rad], each in (-pi, pi] but for rounding.
    """
    frame = np.broadcast_to(np.eye(4), (len(arm_joints), 4, 4))
    for i, link in enumerate(arm.links[:3]):
        frame = frame @ _link_matrix(arm_joints[:, i], link.d, link.a, link.alpha)
    flange = orientations if arm.tool is None else orientations @ arm.tool_matrix[:3, :3].T
    turn = np.swapaxes(frame[:, :3, :3], 1, 2) @ flange  # R of joints 4, 5, 6: Rz(q4) Ry(-q5) Rz(q6)
    sign = -1.0 if flip else 1.0
    sine = np.hypot(turn[:, 0, 2], turn[:, 1, 2])
    q5 = np.arctan2(sign * sine, turn[:, 2, 2])
    q4 = np.arctan2(-sign * turn[:, 1, 2], -sign * turn[:, 0, 2])
    for k in np.flatnonzero(sine < SINGULAR_WRIST_SINE):
        q4[k] = q4[k - 1] if k else previous_q4
        q5[k] = 0.0 if turn[k, 2, 2] > 0 else np.pi
    # With joint 4 known, the rest of the turn is Ry(-q5) Rz(q6), whose middle row is that of Rz(q6).
    c4, s4 = np.cos(q4), np.sin(q4)
    row = -s4[:, None] * turn[:, 0, :] + c4[:, None] * turn[:, 1, :]
    return np.column_stack([q4, q5, np.arctan2(row[:, 0], row[:, 1])])


def min_singular_value(q: Array, arm: Arm) -> Array:
    """Compute the least singular value (...,) of the Jacobian at configurations (..., 6)."""
    return np.asarray(np.linalg.svd(jacobian(q, arm), compute_uv=False)[..., -1], dtype=np.float64)


def describe_reach(excess: float, beyond: bool, s: float) -> str:
    """Describe why no configuration reaches a pose at arc length `s` [m].

    Args:
        excess: how far the wrist centre lies outside the reach [m].
        beyond: whether it is too far away, and not too near.
        s: arc length [m].
    """
    where = "outside the reach" if beyond else "too near to the arm's own axis"
    return f"wrist centre {100 * excess:.1f} cm {where} at s = {s:.3f} m"


@dataclass(frozen=True, eq=False)
class _Reach:
    """Positions of n wrist centres relative to the shoulder [m]."""

    lengths: LinkLengths
    wrist: Array  # (n, 3)
    along: Array  # (n,) horizontal distance in the plane of the arm
    height: Array
    far: Array  # (n,) distance from the shoulder

    @classmethod
    def of(cls, poses: Array, lengths: LinkLengths) -> _Reach:
        wrist = poses[:, :3, 3].copy()
        for axis, distance in enumerate(lengths.wrist_in_tool):
            wrist += distance * poses[:, :3, axis]
        along = np.sqrt(np.maximum(wrist[:, 0] ** 2 + wrist[:, 1] ** 2 - lengths.shoulder_offset**2, 0.0))
        height = wrist[:, 2] - lengths.shoulder_height
        return cls(lengths, wrist, along, height, np.hypot(along, height))

    @property
    def beyond(self) -> NDArray[np.bool_]:
        return np.asarray(self.far > self.lengths.upper_arm + self.lengths.forearm)

    @property
    def excess(self) -> Array:
        """How far each wrist centre lies outside the reach; at most 0 inside."""
        long, short = self.lengths.upper_arm, self.lengths.forearm
        inner = self.lengths.shoulder_offset - np.hypot(self.wrist[:, 0], self.wrist[:, 1])
        return np.maximum(np.maximum(inner, self.far - (long + short)), abs(long - short) - self.far)

    def shoulder_and_elbow(self, side: float, elbow: float) -> Array:
        """Return joints 1 to 3 (n, 3).

        Args:
            side: of the shoulder, 1 for righty, -1 for lefty.
            elbow: sign of the elbow's angle.
        """
        of = self.lengths
        bend = np.clip((self.far**2 - of.upper_arm**2 - of.forearm**2) / (2 * of.upper_arm * of.forearm), -1.0, 1.0)
        # Along joint 2, the wrist lies ahead for righty and behind for lefty; z of frame 1 points to the arm's side.
        q1 = np.arctan2(self.wrist[:, 1], self.wrist[:, 0]) + np.arctan2(of.shoulder_offset, side * self.along)
        inside = elbow * np.arccos(bend)
        across, onward = of.forearm * np.sin(inside), of.upper_arm + of.forearm * np.cos(inside)
        q2 = np.arctan2(self.height, side * self.along) - np.arctan2(across, onward)
        return np.column_stack([q1, q2, inside - of.forearm_angle])


def _link_matrix(angle: Array, d: float, a: float, alpha: float) -> Array:
    c, s, ca, sa = np.cos(angle), np.sin(angle), cos(alpha), sin(alpha)
    matrix = np.zeros((*np.shape(angle), 4, 4))
    matrix[..., 0, 0], matrix[..., 0, 1], matrix[..., 0, 2], matrix[..., 0, 3] = c, -s * ca, s * sa, a * c
    matrix[..., 1, 0], matrix[..., 1, 1], matrix[..., 1, 2], matrix[..., 1, 3] = s, c * ca, -c * sa, a * s
    matrix[..., 2, 1], matrix[..., 2, 2], matrix[..., 2, 3] = sa, ca, d
    matrix[..., 3, 3] = 1.0
    return matrix
