"""The limits of a model's joints: what the model says, what the operator says instead, and defaults for the rest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import mujoco
import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.arm_models.chain import joint_name
from teachpath.io.arm_models.model_file import ModelFile
from teachpath.records import JointLimit, LimitSource

# Where neither model nor operator says anything:
DEFAULT_SPEED: Final = 1.0  # rad/s
ACCELERATION_PER_SPEED: Final = 4.0  # 1/s: full speed is reached in a quarter of a second
JERK_PER_ACCELERATION: Final = 10.0  # 1/s: full acceleration is reached in a tenth of a second
MAX_TURN: Final = 4 * np.pi  # [rad] from the zero position to a limit


def limits_of(
    file: ModelFile, joint: int, operator: Mapping[str, float], holding_torque: float
) -> dict[str, JointLimit]:
    """Return the limits of a joint by kind: `lower`, `upper`, `speed`, `acceleration`, `jerk`, `torque`.

    Args:
        file: the model.
        joint: its number in the model.
        operator: what an operator says, by kind.
        holding_torque: the torque limit [N m] where nobody says one.

    Raises:
        UnusableInput: it has no limits of position, or one that no joint can work with.
    """
    lower, upper = _range(file, joint, operator)
    limits = {"lower": lower, "upper": upper}
    said = {"speed": _speed(file, joint), "torque": _torque(file, joint)}
    for kind, name in (("speed", "velocity"), ("torque", "effort")):
        value = said[kind]
        if kind not in operator and value is not None and not 0.0 < value < np.inf:
            raise UnusableInput(
                f"{file.path}: joint {joint_name(file.model, joint)} has the limit {name} {value:g}; write a {kind} "
                "above zero in the model, or in a file for --limits"
            )
    limits["speed"] = _chosen("speed", said["speed"], operator, DEFAULT_SPEED)
    limits["acceleration"] = _chosen("acceleration", None, operator, ACCELERATION_PER_SPEED * limits["speed"].value)
    limits["jerk"] = _chosen("jerk", None, operator, JERK_PER_ACCELERATION * limits["acceleration"].value)
    limits["torque"] = _chosen("torque", said["torque"], operator, holding_torque)
    return limits


def _range(file: ModelFile, joint: int, operator: Mapping[str, float]) -> tuple[JointLimit, JointLimit]:
    model, name = file.model, joint_name(file.model, joint)
    limited = bool(model.jnt_limited[joint])
    if not limited and not {"lower", "upper"} <= set(operator):
        raise UnusableInput(
            f"{file.path}: joint {name} is continuous, or has no limits of position; write lower and upper [rad] of "
            f"[joints.{name}] in a file for --limits"
        )
    low, high = (
        JointLimit(operator[kind], LimitSource.OPERATOR)
        if kind in operator
        else JointLimit(float(model.jnt_range[joint, side]), LimitSource.MODEL)
        for side, kind in enumerate(("lower", "upper"))
    )
    if not -MAX_TURN <= low.value < high.value <= MAX_TURN:
        raise UnusableInput(
            f"{file.path}: joint {name} may turn from {low.value:g} to {high.value:g} rad; write limits in order, each "
            f"at most {MAX_TURN:.2f} from zero"
        )
    return low, high


def _chosen(kind: str, model: float | None, operator: Mapping[str, float], default: float) -> JointLimit:
    if kind in operator:
        return JointLimit(operator[kind], LimitSource.OPERATOR)
    if model is not None:
        return JointLimit(model, LimitSource.MODEL)
    return JointLimit(default, LimitSource.DEFAULT)


def _speed(file: ModelFile, joint: int) -> float | None:
    urdf = file.urdf_joints.get(file.model.joint(joint).name)
    return urdf.speed if urdf else None


def _torque(file: ModelFile, joint: int) -> float | None:
    """Return the torque limit that a URDF states as effort, an MJCF at the joint or by its actuator."""
    model = file.model
    if (urdf := file.urdf_joints.get(model.joint(joint).name)) is not None:
        return urdf.effort
    if model.jnt_actfrclimited[joint]:
        return float(np.abs(model.jnt_actfrcrange[joint]).max())
    for actuator in range(model.nu):
        at_joint = model.actuator_trntype[actuator] == int(mujoco.mjtTrn.mjTRN_JOINT)
        if at_joint and model.actuator_trnid[actuator, 0] == joint:
            gear = abs(float(model.actuator_gear[actuator, 0]))
            if model.actuator_forcelimited[actuator]:
                return gear * float(np.abs(model.actuator_forcerange[actuator]).max())
            if model.actuator_ctrllimited[actuator] and model.actuator_biastype[actuator] == 0:
                gain = abs(float(model.actuator_gainprm[actuator, 0]))
                return gear * gain * float(np.abs(model.actuator_ctrlrange[actuator]).max())
    return None
