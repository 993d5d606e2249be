"""How near a way of the joints is to the one that a demonstration showed."""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.paths.tool_path import ToolPath
from teachpath.records import Array, Extreme, Posture, ShownPosture

WEIGHT: Final = 10.0  # 1/rad, by which the mean distance from the shown joints raises the cost: above all else


def toward_shown(path: ToolPath, shown: ShownPosture) -> ToolPath:
    """Return a tool path whose joints are to be near those that were shown, at the same shares of the way's length."""
    shares = np.linspace(0.0, 1.0, len(shown.joints))
    at = path.lengths / path.lengths[-1]
    return path.preferring(np.stack([np.interp(at, shares, joint) for joint in shown.joints.T], axis=1))


def posture_cost(joints: Array, posture: Array | None) -> Array:
    """Return the cost (...) of configurations (..., joints) that are away from those preferred (..., joints)."""
    if posture is None:
        return np.zeros(joints.shape[:-1])
    return WEIGHT * np.abs(joints - posture).max(axis=-1)


def distance_from_shown(path: ToolPath, joints: Array, shown: ShownPosture, names: tuple[str, ...]) -> Posture:
    """Return how far configurations (n, joints) at the nodes of a path are from those that were shown.

    Args:
        path: that they follow.
        joints: at its nodes [rad].
        shown: in a demonstration.
        names: of the joints.
    """
    wanted = toward_shown(path, shown).posture
    assert wanted is not None, "it was given just now"
    off = np.abs(joints - wanted)
    node, joint = (int(k) for k in np.unravel_index(int(np.argmax(off)), off.shape))
    s = float(path.lengths[node])
    return Posture(shown.demonstration, Extreme(float(off[node, joint]), f"{names[joint]} at s = {s:.3f} m", s))
