"""The arm: how it is built, and how a plan would move it."""

from __future__ import annotations

from dataclasses import replace

from fastapi import APIRouter, Response

from teachpath.api.access import VIEW
from teachpath.api.answers import json_response, model_of
from teachpath.api.parts import Parts
from teachpath.motion.arm.description import Robot, describe_arm
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import VARIANTS
from teachpath.motion.settings import MotionSettings
from teachpath.records import ArmSummary, MotionPreview, StoredArm


def robot_router(parts: Parts) -> APIRouter:
    """Return the routes of the arm."""
    router = APIRouter(tags=["robot"])

    @router.get("/robot", response_model=model_of(Robot), dependencies=VIEW)
    def get_robot() -> Response:
        """Describe the arm: links, joints with their axes and limits, gripper, and where it waits."""
        settings = parts.settings
        return json_response(describe_arm(settings.arm, name=settings.bus.robot, home=settings.motion.home))

    @router.get("/arms", response_model=model_of(list[Robot]), dependencies=VIEW)
    def list_arms() -> Response:
        """List the arms that the setting `motion.variant` may name, each as it would be here; `/robot` is the one."""
        settings = parts.settings
        published = Arm.of_settings(replace(settings.motion, arm=None))
        arms = [replace(published, name=name, links=variant.links) for name, variant in VARIANTS.items()]
        home = (settings.motion if settings.motion.arm is None else MotionSettings()).home
        described = [describe_arm(arm, name=settings.bus.robot, home=home) for arm in arms]
        return json_response(described)

    @router.get("/arms/stored", dependencies=VIEW)
    def list_stored_arms() -> list[ArmSummary]:
        """List the arms that were added from models in URDF or MJCF; the setting `motion.arm` may name one."""
        return [stored.summary for stored in parts.store.arms.newest()]

    @router.get("/arms/stored/{name}", response_model=model_of(StoredArm), dependencies=VIEW)
    def get_stored_arm(name: str) -> Response:
        """Return the newest version of an arm that was added: links, joints with limits and who gave them, solids."""
        return json_response(parts.store.arms.versions(name)[0])

    @router.get("/plans/{plan}/motion", response_model=model_of(MotionPreview), dependencies=VIEW)
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
