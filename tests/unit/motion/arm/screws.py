"""An independent Puma 560: screws instead of frames, momentum instead of MuJoCo; lengths are its only inputs.

Forward kinematics is a product of exponentials of the joints' screws where all joints are zero, inverse dynamics sums
the forces of all bodies at the world's origin (Murray, Li, Sastry: A Mathematical Introduction to Robotic Manipulation,
CRC 1994, ch. 3 and 4; Featherstone: Rigid Body Dynamics Algorithms, Springer 2008, ch. 2 and 5).
"""

from dataclasses import dataclass

import numpy as np

GRAVITY = 9.81


def cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def motion_cross(v: np.ndarray) -> np.ndarray:
    """The matrix of the cross product of a spatial velocity (angular, linear at the world's origin) with another."""
    return np.block([[cross(v[:3]), np.zeros((3, 3))], [cross(v[3:]), cross(v[:3])]])


@dataclass
class Body:
    """A rigid body where all joints are zero: what moves it, its mass, centre and inertia about it, in the world."""

    joint: int
    mass: float
    centre: np.ndarray
    inertia: np.ndarray

    def spatial(self, pose: np.ndarray) -> np.ndarray:
        """Its spatial inertia (6, 6) at the world's origin after a motion `pose` from zero."""
        turn, centre = pose[:3, :3], pose[:3, :3] @ self.centre + pose[:3, 3]
        c = cross(centre)
        about = turn @ self.inertia @ turn.T + self.mass * c @ c.T
        return np.block([[about, self.mass * c], [self.mass * c.T, self.mass * np.eye(3)]])


class Screws:
    """The arm as six lines in space where all joints are zero.

    There the upper arm points along x, the forearm straight up, and the arm lies to the right of the column (-y).

    Args:
        height: of joint 2 above the floor [m].
        upper, offset, elbow, forearm, hand: a2, d3, a3, d4, and wrist to grasp point [m].
    """

    def __init__(
        self, *, height: float, upper: float, offset: float, elbow: float, forearm: float, hand: float
    ) -> None:
        up, right = np.array([0.0, 0.0, 1.0]), np.array([0.0, -1.0, 0.0])
        shoulder = np.array([0.0, 0.0, height])
        at_elbow = shoulder + np.array([upper, -offset, 0.0])
        wrist = at_elbow + np.array([elbow, 0.0, forearm])
        self.axes = np.array([up, right, right, up, right, up])
        self.points = np.array([shoulder, shoulder, at_elbow, wrist, wrist, wrist])
        self.tool = np.eye(4)
        self.tool[:3, 3] = wrist + hand * up

    def motions(self, q: np.ndarray) -> list[np.ndarray]:
        """What joints 1 to i do together to the space behind them, for i = 0 to 6."""
        done = [np.eye(4)]
        for axis, point, angle in zip(self.axes, self.points, q, strict=True):
            k = cross(axis)
            step = np.eye(4)
            step[:3, :3] += np.sin(angle) * k + (1 - np.cos(angle)) * k @ k  # Rodrigues
            step[:3, 3] = point - step[:3, :3] @ point
            done.append(done[-1] @ step)
        return done

    def tool_pose(self, q: np.ndarray) -> np.ndarray:
        return self.motions(q)[6] @ self.tool

    def moved_screws(self, q: np.ndarray) -> np.ndarray:
        """The screws (6, 6) as they lie at q; they are the columns of the Jacobian at the world's origin."""
        moved = []
        for axis, point, motion in zip(self.axes, self.points, self.motions(q)[:6], strict=True):
            turned = motion[:3, :3] @ axis
            moved.append([*turned, *np.cross(motion[:3, :3] @ point + motion[:3, 3], turned)])
        return np.array(moved)

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Rows of the grasp point's velocity, then of the angular velocity, in world axes."""
        tool, screws = self.tool_pose(q)[:3, 3], self.moved_screws(q)
        return np.array([[*(s[3:] + np.cross(s[:3], tool)), *s[:3]] for s in screws]).T

    def torques(
        self, q: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray, bodies: list[Body], armature: np.ndarray
    ) -> np.ndarray:
        """The torques (6,) without friction."""
        screws, motions = self.moved_screws(q), self.motions(q)
        speed, change = np.zeros(6), np.array([0.0, 0.0, 0.0, 0.0, 0.0, GRAVITY])
        speeds, changes = [], []
        for screw, rate, more in zip(screws, velocity, acceleration, strict=True):
            speed = speed + screw * rate
            change = change + screw * more + motion_cross(speed) @ screw * rate
            speeds.append(speed)
            changes.append(change)
        total = armature * acceleration
        for body in bodies:
            inertia = body.spatial(motions[body.joint])
            v, a = speeds[body.joint - 1], changes[body.joint - 1]
            force = inertia @ a - motion_cross(v).T @ inertia @ v
            total[: body.joint] += screws[: body.joint] @ force
        return total
