"""The station as a whole: health and scenes; and the application that holds all resources."""

from __future__ import annotations

from fastapi import APIRouter, Depends, FastAPI
from starlette.middleware.trustedhost import TrustedHostMiddleware

from teachpath import __version__
from teachpath.api.adaptations import adaptations_router
from teachpath.api.assessments import assessments_router
from teachpath.api.calibrations import calibrations_router
from teachpath.api.control import control_router
from teachpath.api.curves import curves_router
from teachpath.api.demonstrations import demonstrations_router
from teachpath.api.executions import executions_router, stops_router
from teachpath.api.exports import exports_router
from teachpath.api.faults import REFUSALS, answer_errors
from teachpath.api.imports import imports_router
from teachpath.api.joints import joints_router
from teachpath.api.metrics import RequestMetrics, metrics_router, new_registry
from teachpath.api.middleware import AnswersAtTheEnd, RequestLimits
from teachpath.api.objects import objects_router
from teachpath.api.parts import Health, Parts
from teachpath.api.probes import probes_router
from teachpath.api.recording import recording_router
from teachpath.api.request_numbers import RequestNumbers
from teachpath.api.robot import robot_router
from teachpath.api.strict_requests import refuse_unknown
from teachpath.api.tasks import tasks_router
from teachpath.api.trackers import trackers_router
from teachpath.api.versions import versions_router
from teachpath.api.work import jobs_router, results_router
from teachpath.records import Scene

PREFIX = "/api/v1"

DESCRIPTION = """Show a task a few times; teachpath finds the different ways it was done, learns a path for each, proves
that the arm can follow it, and moves the arm. Metres, radians, seconds; quaternions w, x, y, z; times ending in `_ns`
are nanoseconds since the Unix epoch. Every refusal has a sentence in `detail`."""


def build_api(parts: Parts, *pages: APIRouter) -> FastAPI:
    """Return the web application: the REST API under /api/v1, and what the page needs beside it."""
    app = FastAPI(title="teachpath", version=__version__, description=DESCRIPTION, docs_url=None, redoc_url=None)
    # Another name for this address is how a foreign page would reach a loopback service (DNS rebinding).
    hosts = ["127.0.0.1", "localhost", "[::1]", parts.settings.web.host, *parts.settings.web.hosts]
    app.add_middleware(RequestLimits, settings=parts.settings.web)
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=hosts)
    app.add_middleware(AnswersAtTheEnd)
    registry = new_registry()
    app.add_middleware(RequestMetrics, registry=registry)
    app.add_middleware(RequestNumbers)
    answer_errors(app)
    routers = (
        tasks_router,
        imports_router,
        demonstrations_router,
        recording_router,
        exports_router,
        calibrations_router,
        jobs_router,
        results_router,
        versions_router,
        curves_router,
        adaptations_router,
        objects_router,
        assessments_router,
        executions_router,
        control_router,
        robot_router,
        station_router,
        probes_router,
    )
    app.include_router(stops_router(parts), prefix=PREFIX, responses=REFUSALS)  # never refused for what comes with it
    closed = [Depends(refuse_unknown)]
    for router in routers:
        app.include_router(router(parts), prefix=PREFIX, responses=REFUSALS, dependencies=closed)
    for socket in (trackers_router, joints_router):
        app.include_router(socket(parts), prefix=PREFIX)
    app.include_router(metrics_router(parts, registry))
    for page in pages:
        app.include_router(page)
    return app


def station_router(parts: Parts) -> APIRouter:
    """Return the routes of the station itself."""
    router = APIRouter(tags=["station"])

    @router.get("/health")
    def get_health() -> Health:
        """Say which parts run, and what an operator should know."""
        return parts.health()

    @router.get("/scenes")
    def list_scenes() -> list[Scene]:
        """List the scenes: table, obstacles and the object where it lies."""
        return [parts.objects.scene(scene.name) for scene in parts.settings.scenes]

    return router
