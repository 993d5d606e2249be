"""The proof behind a plan: its digest, and how much of each limit its setpoints use, measured on the setpoints."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict
from typing import Final

import numpy as np

from teachpath.errors import PathRefused
from teachpath.motion.governor import Governor
from teachpath.motion.puma560 import ACCELERATION, JERK, LOWER, SPEED, UPPER, Array
from teachpath.motion.timing import JointPath, Limits
from teachpath.records import Extreme, Plan, Scene

LONGEST: Final = 600.0  # s, of a path at full speed


def digest(plan: Plan) -> str:
    """Compute the SHA-256 (hex) over all that decides the motion: path, scene, configurations, limits and timing."""
    total = hashlib.sha256()
    total.update(f"{plan.path}|{plan.path_version}|".encode())
    total.update(_scene_text(plan.scene).encode())
    numbers = (plan.lengths, plan.joints, plan.limits, plan.above_start, plan.above_goal, plan.duration)
    for value in (*numbers, LOWER, UPPER, SPEED, ACCELERATION, JERK):
        array = np.ascontiguousarray(value, dtype="<f8")
        total.update(f"{array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()


def verify(plan: Plan) -> None:
    """Check that a plan is the one that was certified.

    Raises:
        PathRefused: the digest does not match: path, scene, limits or timing have changed since.
    """
    if digest(plan) != plan.certificate.digest:
        raise PathRefused(
            f"plan {plan.id} has changed since it was certified (or the arm's limits have); plan the path again"
        )


def stream(path: JointPath, limits: Limits, rate: float) -> tuple[Array, Array]:
    """Run the path at full speed as the executor does.

    Args:
        path: what to follow.
        limits: of its length.
        rate: setpoints a second [Hz].

    Returns:
        (n,) lengths and (n, 6) configurations of the setpoints, with the standstill before and behind.
    """
    governor = Governor(path.end, limits)
    lengths = [0.0] * 4
    while not governor.progress.finished:
        lengths.append(governor.step(1.0 / rate).s)
        if len(lengths) > LONGEST * rate:
            raise PathRefused(f"the path takes longer than {LONGEST:.0f} s at full speed; smooth its sharpest turn")
    samples = np.array(lengths + [path.end] * 3)
    return samples, path(samples)


def uses(lengths: Array, joints: Array, rate: float) -> tuple[Extreme, Extreme, Extreme, Extreme]:
    """Measure how much of the joints' position, speed, acceleration and jerk limits setpoints use.

    Args:
        lengths: (n,) where on the path each setpoint lies [m].
        joints: (n, 6) setpoints [rad].
        rate: setpoints a second [Hz].
    """
    middle, half = (LOWER + UPPER) / 2, (UPPER - LOWER) / 2
    shares = [np.abs(joints - middle) / half]
    shares += [np.abs(np.diff(joints, order, axis=0)) * rate**order / limit
               for order, limit in ((1, SPEED), (2, ACCELERATION), (3, JERK))]  # fmt: skip
    position, velocity, acceleration, jerk = (_extreme(share, lengths) for share in shares)
    return position, velocity, acceleration, jerk


def _extreme(share: Array, lengths: Array) -> Extreme:
    row, joint = np.unravel_index(int(np.argmax(share)), share.shape)
    s = float(lengths[row])
    return Extreme(float(share[row, joint]), f"joint {joint + 1} at s = {s:.3f} m", s)


def _scene_text(scene: Scene) -> str:
    def plain(value: object) -> object:
        if isinstance(value, dict):
            return {key: plain(inner) for key, inner in value.items()}
        if isinstance(value, list | tuple):
            return [plain(inner) for inner in value]
        return float(value) if isinstance(value, int | float) else value

    return json.dumps(plain(asdict(scene)), sort_keys=True)
