"""What stands in the way of a motion that a live hand asks for: the joints' ranges, the motors, and what is near."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.execution.teleop_goal import describe_limit
from teachpath.motion.settings import MotionSettings

MAX_SAMPLE_STEP: Final = 0.03  # [rad] between two configurations that are checked
SAMPLING_CLEARANCE: Final = 0.015  # [m] besides `clearance_min`, for what lies between two checked configurations


def samples_to_check(positions: Array) -> Array:
    """Return configurations (n, 6) of a motion (m, 6), no two neighbours farther apart than `MAX_SAMPLE_STEP`."""
    kept, last = [], positions[0]
    for k, q in enumerate(positions):
        if k == len(positions) - 1 or np.abs(positions[k + 1] - last).max() > MAX_SAMPLE_STEP:
            kept.append(q)
            last = q
    return np.array(kept)


def limit_passed(positions: Array, arm: Arm) -> str:
    """Say which joint would pass its range in configurations (n, 6), or nothing."""
    beyond = np.maximum(positions - arm.limits.upper, arm.limits.lower - positions)
    if beyond.max() <= 0.0:
        return ""
    row, joint = np.unravel_index(int(np.argmax(beyond)), beyond.shape)
    return describe_limit(int(joint), float(positions[row, joint]), arm)


class PayloadCheck:
    """Says where the motors are too weak for the payload; a live hand carries no other load that weighs on them.

    Args:
        accelerations: (6,) that motions may use [rad/s^2].
    """

    def __init__(self, arm: Arm, accelerations: Array) -> None:
        self._dynamics = Dynamics(arm) if arm.payload.mass else None
        self._accelerations = accelerations
        self._torque = arm.limits.torque

    def __call__(self, samples: Array) -> str:
        """Say that the motors are too weak in one of configurations (n, 6), however they accelerate, or nothing."""
        if self._dynamics is None:
            return ""
        torques = self._dynamics.torque_bounds(samples, np.zeros_like(samples), self._accelerations)
        return "the motors are too weak for the payload there" if np.any(torques > self._torque) else ""


def obstruction(model: CollisionModel, samples: Array, load: Load | None, settings: MotionSettings) -> str:
    """Say what arm, gripper or load would come too near to in configurations (n, 6), or nothing."""
    rows = model.clearances(samples, load=load, gripper_open=True)  # the wider of both
    least = min(rows, key=lambda row: row.distance)
    if least.distance < settings.clearance_min + SAMPLING_CLEARANCE:
        return f"{least.body} would come within {1000 * least.distance:.0f} mm of {least.other_body}"
    if load is not None and load.grasp_pose is not None:
        deep = min(row.distance for row in model.support_distances(samples, load))
        if deep < -settings.contact_tolerance:
            return f"the object would be pressed {-1000 * deep:.0f} mm into what it stood on"
    return ""
