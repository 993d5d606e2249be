"""The arm: how it is built, and how a plan would move it."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter

from teachpath.api.parts import Parts
from teachpath.io.documents import to_document
from teachpath.motion.arm.puma560 import ACCELERATION, FINGER_TRAVEL, JERK, LOWER, SPEED, TOOL_LENGTH, TORQUE, UPPER
from teachpath.motion.arm.variants import arm


def robot_router(parts: Parts) -> APIRouter:
    """Return the routes of the arm."""
    router = APIRouter(tags=["robot"])

    @router.get("/robot")
    def get_robot() -> dict[str, Any]:
        """Describe the arm: standard Denavit-Hartenberg links, joint limits, gripper, and where it waits."""
        return {
            "name": parts.settings.bus.robot,
            "variant": arm().name,
            "links": [{"a": link.a, "d": link.d, "alpha": link.alpha} for link in arm().links],
            "lower": LOWER.tolist(),
            "upper": UPPER.tolist(),
            "speed": SPEED.tolist(),
            "acceleration": ACCELERATION.tolist(),
            "jerk": JERK.tolist(),
            "torque": TORQUE.tolist(),
            "tool_length": TOOL_LENGTH,
            "finger_travel": FINGER_TRAVEL,
            "home": list(parts.settings.motion.home),
        }

    @router.get("/plans/{plan}/motion")
    def get_motion(plan: str) -> dict[str, Any]:
        """Return the whole motion of a plan at full speed, from the arm's home and back; nothing moves.

        Times [s], joints [rad], pose of the carried object [m, world], and what the arm does when, in words.
        """
        from teachpath.motion.execution.motion_preview import (
            preview_motion,  # with the libraries of planning, which nothing else here needs
        )

        stored = parts.store.plan(plan)
        return to_document(preview_motion(stored, parts.settings.motion, dwell=parts.settings.executor.dwell))

    return router
