"""The arm: how it is built, and how a plan would move it."""

from __future__ import annotations

from fastapi import APIRouter, Response

from teachpath.api.answers import json_response, model_of
from teachpath.api.parts import Parts
from teachpath.motion.arm.description import Robot, describe_arm
from teachpath.records import MotionPreview


def robot_router(parts: Parts) -> APIRouter:
    """Return the routes of the arm."""
    router = APIRouter(tags=["robot"])

    @router.get("/robot", response_model=model_of(Robot))
    def get_robot() -> Response:
        """Describe the arm: standard Denavit-Hartenberg links, joint limits, gripper, and where it waits."""
        settings = parts.settings
        return json_response(describe_arm(settings.arm, name=settings.bus.robot, home=settings.motion.home))

    @router.get("/plans/{plan}/motion", response_model=model_of(MotionPreview))
    def get_motion(plan: str) -> Response:
        """Return the whole motion of a plan at full speed, from the arm's home and back; nothing moves.

        Times [s], joints [rad], pose of the carried object [m, world], and what the arm does when, in words.
        """
        from teachpath.motion.execution.motion_preview import (
            preview_motion,  # with the libraries of planning, which nothing else here needs
        )

        stored, settings = parts.store.plan(plan), parts.settings
        return json_response(preview_motion(stored, settings.motion, settings.arm, dwell=settings.executor.dwell))

    return router
