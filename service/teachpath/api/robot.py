"""The arm: how it is built, and how a plan would move it."""

from __future__ import annotations

from dataclasses import dataclass

from fastapi import APIRouter, Response

from teachpath.api.answers import json_response, model_of
from teachpath.api.parts import Parts
from teachpath.motion.arm.puma560 import FINGER_TRAVEL
from teachpath.records import Array, MotionPreview


@dataclass(frozen=True, slots=True)
class LinkGeometry:
    """A link by its standard Denavit-Hartenberg parameters: a and d [m], alpha [rad]."""

    a: float
    d: float
    alpha: float


@dataclass(frozen=True, eq=False)
class Robot:
    """How the arm is built.

    Attributes:
        name: of the arm in its keys.
        variant: the published table that its lengths and masses come from.
        links: from the base to the wrist.
        lower: (6,) limits of the joints [rad].
        upper: (6,) likewise.
        speed: (6,) limits [rad/s].
        acceleration: (6,) limits [rad/s^2].
        jerk: (6,) limits [rad/s^3].
        torque: (6,) limits [N m].
        tool_length: from the wrist's centre to the grasp point [m].
        finger_travel: of each finger [m].
        home: configuration in which the arm waits [rad].
    """

    name: str
    variant: str
    links: tuple[LinkGeometry, ...]
    lower: Array
    upper: Array
    speed: Array
    acceleration: Array
    jerk: Array
    torque: Array
    tool_length: float
    finger_travel: float
    home: tuple[float, ...]


def robot_router(parts: Parts) -> APIRouter:
    """Return the routes of the arm."""
    router = APIRouter(tags=["robot"])

    @router.get("/robot", response_model=model_of(Robot))
    def get_robot() -> Response:
        """Describe the arm: standard Denavit-Hartenberg links, joint limits, gripper, and where it waits."""
        arm, limits = parts.settings.arm, parts.settings.arm.limits
        return json_response(
            Robot(
                name=parts.settings.bus.robot,
                variant=arm.name,
                links=tuple(LinkGeometry(link.a, link.d, link.alpha) for link in arm.links),
                lower=limits.lower,
                upper=limits.upper,
                speed=limits.speed,
                acceleration=limits.acceleration,
                jerk=limits.jerk,
                torque=limits.torque,
                tool_length=arm.tool_length,
                finger_travel=FINGER_TRAVEL,
                home=parts.settings.motion.home,
            )
        )

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
