"""What a hand sample may hold: the limits that the recorder, and the check of trackers, hold every sample to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

MAX_SAMPLE_SIZE: Final = 4096  # bytes; an honest sample has about 200
FLEXION_COUNTS: Final = (0, 18, 22)
JOINT_COUNTS: Final = (0, 6, 7)
UNIT_TOLERANCE: Final = 0.01  # by which the norm of a quaternion may differ from 1
NOT_MEASURED: Final = (0.0, 0.0, 0.0, 0.0)  # an orientation
MAX_COORDINATE: Final = 100.0  # [m or tracker units]; beyond it the units are wrong
MAX_ANGLE: Final = 4 * math.pi  # [rad] of a joint; beyond it the units are wrong
GRASP_BUTTON: Final = 1  # bit of `buttons`; held while a hand without a glove grasps


def sample_fault(
    position: Sequence[float],
    orientation: Sequence[float],
    flexions: Sequence[float],
    device_ns: int,
    joints: Sequence[float] = (),
) -> str:
    """Say what is wrong with the values of a hand sample, or nothing.

    Args:
        position: x, y, z [m, tracker frame].
        orientation: w, x, y, z of a unit quaternion, or `NOT_MEASURED`.
        flexions: 18 or 22 from 0 (open) to 1 (closed), or none.
        device_ns: the device's clock [ns since the Unix epoch].
        joints: of an arm that shows the task [rad], 6 or 7, or none.
    """
    x, y, z = position
    limit = MAX_COORDINATE
    if not (-limit <= x <= limit and -limit <= y <= limit and -limit <= z <= limit):
        if not math.isfinite(x + y + z):
            return f"position {tuple(position)} is not finite"
        return f"position {tuple(position)} is over {limit:g} m away; are its units metres?"
    if len(flexions) not in FLEXION_COUNTS:
        return f"{len(flexions)} flexions; a glove has 18 or 22, or send none"
    if flexions and not (min(flexions) >= 0.0 and max(flexions) <= 1.0 and math.isfinite(sum(flexions))):
        return "a flexion is outside 0 (open) to 1 (closed); is the glove calibrated?"
    if joints and (fault := _joint_fault(joints)):
        return fault
    if device_ns <= 0:
        return f"device time {device_ns} ns; send nanoseconds since the Unix epoch"
    if orientation != NOT_MEASURED and not abs(math.hypot(*orientation) - 1.0) <= UNIT_TOLERANCE:
        return "orientation ({:g}, {:g}, {:g}, {:g}) is no unit quaternion".format(*orientation)
    return ""


def _joint_fault(joints: Sequence[float]) -> str:
    if len(joints) not in JOINT_COUNTS:
        return f"{len(joints)} joints; an arm has 6 or 7, or send none"
    wrong = next((angle for angle in joints if not -MAX_ANGLE <= angle <= MAX_ANGLE), None)
    if wrong is None:
        return ""
    return f"a joint is at {wrong:g} rad, limit {MAX_ANGLE:.1f}; are its units radians?"
