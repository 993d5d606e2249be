"""Whether a gripper can be mounted where the tool's pose has it: it may not stand in the wrist."""

from __future__ import annotations

import numpy as np

from teachpath.errors import UnusableSettings
from teachpath.motion.arm.geometry import LinkSolid, collision_solids
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.rotations import rotation_matrices


def check_mounting(arm: Arm) -> None:
    """Check that the gripper does not stand in the wrist.

    The wrist is a ball on the axis of joint 6, so that its distance to what the flange carries is always the same.

    Raises:
        UnusableSettings: it does.
    """
    if arm.tool is None:
        return
    solids = {solid.name: solid for solid in collision_solids(arm)}
    wrist = solids["wrist"]
    gap = min(_distance_to_wrist(solid, arm) for solid in solids.values() if solid.kind == "box" and solid.link == 6)
    if gap < wrist.size[0]:
        raise UnusableSettings(
            f"with motion.tool_position {list(arm.tool.position)} and motion.tool_orientation "
            f"{[round(value, 4) for value in arm.tool.orientation]} the gripper would stand "
            f"{1e3 * (wrist.size[0] - gap):.1f} mm in the wrist: it sits tool_length ({1e3 * arm.tool_length:g} mm) "
            "behind that point along the tool's z; move the point away from the wrist, or turn the tool"
        )


def _distance_to_wrist(box: LinkSolid, arm: Arm) -> float:
    """Return the distance [m] of a box on the flange from the wrist's centre, where the axes of joints 4 to 6 meet."""
    centre = np.array([0.0, 0.0, -arm.links[5].d])
    seen = rotation_matrices(np.array([box.orientation]))[0].T @ (centre - box.position)
    return float(np.linalg.norm(np.maximum(np.abs(seen) - np.array(box.size) / 2, 0.0)))
