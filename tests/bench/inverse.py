"""Closed-form inverse kinematics beside EAIK's: the same eight answers, and the time of one.

EAIK is no dependency of the project: `.venv/bin/pip install --no-deps EAIK` brings it for this.
"""

import time

import numpy as np

from teachpath.motion.arm.kinematics import inverse_kinematics, tool_pose
from teachpath.motion.arm.model import Arm
from tests.bench.report import Figure, against

ARM = Arm.of_variant()

POSES = 1000


def measure(*, repeats: int) -> list[Figure]:
    """Return how far the answers are apart, whether any is missing, and how long a pose takes."""
    poses = tool_pose(np.random.default_rng(2).uniform(ARM.limits.lower, ARM.limits.upper, (POSES, 6)), ARM)
    ours, seconds = [], []
    for _ in range(repeats):
        began = time.process_time()
        ours = inverse_kinematics(poses, ARM).joints
        seconds.append(1e6 * (time.process_time() - began) / POSES)
    back = np.abs(tool_pose(ours, ARM) - poses[:, None]).max()
    figures = [Figure(f"8 branches of {POSES} poses put through forward kinematics, farthest", (float(back),), "m, 1")]
    try:
        from eaik.IK_DH import DhRobot
    except ImportError:
        what = "inverse kinematics of a pose, 8 branches (EAIK is not installed)"
        return [*figures, Figure(what, tuple(seconds), "us")]
    rows = ARM.links
    robot = DhRobot(*(np.array([getattr(link, column) for link in rows]) for column in ("alpha", "a", "d")))
    flanges = poses.copy()
    flanges[:, :3, 3] -= ARM.tool_length * poses[:, :3, 2]
    began = time.process_time()
    answers = [robot.IK(pose) for pose in flanges]
    theirs = 1e6 * (time.process_time() - began) / POSES
    worst, missing = _compared(ours, [np.array(answer.Q)[~np.array(answer.is_LS)] for answer in answers])
    return [
        *figures,
        Figure("answers that only one of both has", (float(missing),), "answers"),
        Figure("answers of both apart, at most", (worst,), "rad"),
        against("inverse kinematics of a pose, 8 branches", seconds, "us", name="EAIK, pose by pose", value=theirs),
    ]


def _compared(ours: np.ndarray, theirs: list[np.ndarray]) -> tuple[float, int]:
    """Return how far answers to the same pose are apart at most [rad], and how many have no counterpart."""
    worst, missing = 0.0, 0
    for mine, other in zip(ours, theirs, strict=True):
        apart = np.abs(np.angle(np.exp(1j * (mine[:, None] - other[None])))).max(axis=2)
        alone = (apart.min(axis=1) > 1e-6).sum() + (apart.min(axis=0) > 1e-6).sum() if len(other) else len(mine)
        missing += int(alone)
        if not alone:
            worst = max(worst, float(apart.min(axis=1).max()))
    return worst, missing
