"""How near a way of the joints is to the one that a demonstration showed."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.paths.tool_path import ToolPath
from teachpath.records import Array, Extreme, Posture, ShownPosture

WEIGHT: Final = 10.0  # 1/rad, by which the mean distance from the shown joints raises the cost: above all else


def toward_shown(path: ToolPath, shown: ShownPosture) -> ToolPath:
    """Return a tool path whose joints are to be near those that were shown, at the same shares of the way's length."""
    return path.preferring(_shown_at(path.lengths, shown))


def posture_cost(joints: Array, posture: Array | None) -> Array:
    """Return the cost (...) of configurations (..., joints) that are away from those preferred (..., joints)."""
    if posture is None:
        return np.zeros(joints.shape[:-1])
    return np.asarray(WEIGHT * np.abs(joints - posture).max(axis=-1), dtype=np.float64)


def distance_from_shown(lengths: Array, joints: Array, shown: ShownPosture, names: tuple[str, ...]) -> Posture:
    """Return how far configurations along a path are from those that were shown.

    Args:
        lengths: (n,) of the path, from 0 to its end [m].
        joints: (n, joints) there [rad].
        shown: in a demonstration.
        names: of the joints.
    """
    off = np.abs(joints - _shown_at(lengths, shown))
    node, joint = (int(k) for k in np.unravel_index(int(np.argmax(off)), off.shape))
    s = float(lengths[node])
    return Posture(shown.demonstration, Extreme(float(off[node, joint]), f"{names[joint]} at s = {s:.3f} m", s))


def _shown_at(lengths: Array, shown: ShownPosture) -> Array:
    """Return the joints (n, joints) that were shown at the same shares of the way as lengths (n,) [m]."""
    shares = np.linspace(0.0, 1.0, len(shown.joints))
    return np.stack([np.interp(lengths / lengths[-1], shares, joint) for joint in shown.joints.T], axis=1)
