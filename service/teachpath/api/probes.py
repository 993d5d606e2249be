"""Probes for whoever supervises the service: whether it lives, and whether it is ready for work."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fastapi import APIRouter

from teachpath import __version__
from teachpath.api.access import NO_CAPABILITY
from teachpath.api.parts import Parts
from teachpath.errors import TeachpathError, Unreachable
from teachpath.robot.processes import ProcessState


@dataclass(frozen=True, slots=True)
class Probe:
    """That the service lives, or is ready.

    Attributes:
        version: of the service.
    """

    version: str


def probes_router(parts: Parts) -> APIRouter:
    """Return the routes of the probes."""
    router = APIRouter(tags=["station"])

    @router.get("/health/live", dependencies=NO_CAPABILITY)
    async def get_liveness() -> Probe:
        """Say that the service answers; it does even while every other request waits."""
        return Probe(__version__)

    @router.get("/health/ready", dependencies=NO_CAPABILITY)
    def get_readiness() -> Probe:
        """Say that the station is ready to record, learn and move the arm; 503 with the reasons while it is not."""
        if reasons := list(_reasons(parts)):
            raise Unreachable(f"not ready: {'; '.join(reasons)}")
        return Probe(__version__)

    return router


def _reasons(parts: Parts) -> Iterator[str]:
    try:
        parts.store.tasks()
    except TeachpathError as error:
        yield str(error)
        return
    health = parts.health()
    yield from (
        f"the {name} is {state}" for name, state in health.processes.items() if state is not ProcessState.RUNNING
    )
    if health.executor is None:
        yield "the executor has said nothing for over a second"
