"""The station as a whole: its health; and the application that holds all resources."""

from __future__ import annotations

from typing import Any, Final

from fastapi import APIRouter, Depends, FastAPI
from fastapi.routing import APIRoute
from starlette.middleware.trustedhost import TrustedHostMiddleware

from teachpath import __version__
from teachpath.api.access import NO_CAPABILITY, VIEW
from teachpath.api.access_routes import access_router
from teachpath.api.adaptations import adaptations_router
from teachpath.api.assessments import assessments_router
from teachpath.api.audit import AuditRequests, audit_router
from teachpath.api.authority import authority_router
from teachpath.api.calibrations import calibrations_router
from teachpath.api.compressed_documents import CompressedDocuments
from teachpath.api.control import control_router
from teachpath.api.curves import curves_router
from teachpath.api.demonstrations import demonstrations_router
from teachpath.api.description import DESCRIPTION, DescribedApi
from teachpath.api.executions import executions_router, stops_router
from teachpath.api.exports import exports_router
from teachpath.api.faults import answer_errors
from teachpath.api.https_only import HttpsOnly
from teachpath.api.imports import imports_router
from teachpath.api.joints import joints_router
from teachpath.api.limits import LimitSubjects
from teachpath.api.live_description import live_description
from teachpath.api.loopback_only import LoopbackOnly
from teachpath.api.meshes import meshes_router
from teachpath.api.metrics import RequestMetrics, metrics_router, new_registry
from teachpath.api.middleware import AnswersAtTheEnd, HeadRequests, RequestLimits
from teachpath.api.objects import objects_router
from teachpath.api.parts import Health, Parts
from teachpath.api.people_routes import people_router
from teachpath.api.probes import probes_router
from teachpath.api.programs import programs_router
from teachpath.api.provider_routes import provider_router
from teachpath.api.recording import recording_router
from teachpath.api.request_numbers import RequestNumbers
from teachpath.api.revocable_sockets import RevocableSockets
from teachpath.api.robot import robot_router
from teachpath.api.scenes import scenes_router
from teachpath.api.strict_requests import refuse_unknown
from teachpath.api.tasks import tasks_router
from teachpath.api.touches import touches_router
from teachpath.api.trackers import trackers_router
from teachpath.api.uploads import uploads_router
from teachpath.api.versions import versions_router
from teachpath.api.work import jobs_router, results_router
from teachpath.web.server import possible_connections

PREFIX: Final = "/api/v1"
UNSPECIFIED_HOSTS: Final = {"0.0.0.0", "::", ""}  # where to listen, and no name of a station


def build_api(parts: Parts, *pages: APIRouter) -> FastAPI:
    """Return the web application: the REST API under /api/v1, and what the page needs beside it."""
    app = DescribedApi(
        title="teachpath",
        version=__version__,
        description=DESCRIPTION,
        contact={"name": "whoever runs this station"},
        license_info={"name": "MIT", "identifier": "MIT"},
        servers=[{"url": ".", "description": "the station that gave this description"}],
        docs_url=None,
        redoc_url=None,
        openapi_url=None,
        generate_unique_id_function=_operation_id,
    )
    app.state.access = parts.access
    registry = new_registry()
    _add_guards(app, parts)
    app.add_middleware(RequestMetrics, registry=registry)
    app.add_middleware(RequestNumbers)
    app.add_middleware(AuditRequests, audit=parts.audit, is_proxied=parts.access.mode == "proxy")
    answer_errors(app)
    app.include_router(stops_router(parts), prefix=PREFIX)  # never refused for what comes with it
    closed = [Depends(refuse_unknown)]
    for router in ROUTERS:
        app.include_router(router(parts), prefix=PREFIX, dependencies=closed)
    for socket in (trackers_router, joints_router):
        app.include_router(socket(parts), prefix=PREFIX)
    app.include_router(metrics_router(parts, registry))
    app.include_router(description_router(app))
    app.include_router(authority_router(parts))
    for page in pages:
        app.include_router(page)
    return app


def _add_guards(app: FastAPI, parts: Parts) -> None:
    """Add what may refuse a request; the last one that is added comes first."""
    # Another name for this address is how a foreign page would reach a loopback service (DNS rebinding).
    web = parts.settings.web
    hosts = ["127.0.0.1", "localhost", "[::1]", *({web.host} - UNSPECIFIED_HOSTS), *web.hosts]
    app.add_middleware(CompressedDocuments)
    app.add_middleware(HeadRequests)
    app.add_middleware(RevocableSockets, access=parts.access)
    if parts.access.mode == "none":
        app.add_middleware(LoopbackOnly)
    app.add_middleware(RequestLimits, settings=web)
    connections = possible_connections(web.max_connections)
    app.add_middleware(LimitSubjects, access=parts.access, settings=parts.settings.limits, max_connections=connections)
    if parts.certificate:
        app.add_middleware(HttpsOnly)
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=hosts)
    app.add_middleware(AnswersAtTheEnd)


def _operation_id(route: APIRoute) -> str:
    return route.name


def description_router(app: FastAPI) -> APIRouter:
    """Return the routes of the descriptions: of the REST API in OpenAPI, of the WebSockets in AsyncAPI."""
    router = APIRouter(include_in_schema=False)

    @router.get("/openapi.json", dependencies=NO_CAPABILITY)
    def get_description() -> dict[str, Any]:
        """Return the description of this API in OpenAPI."""
        return app.openapi()

    @router.get("/asyncapi.json", dependencies=NO_CAPABILITY)
    def get_live_description() -> dict[str, Any]:
        """Return the description of the WebSockets in AsyncAPI."""
        return live_description()

    return router


def station_router(parts: Parts) -> APIRouter:
    """Return the routes of the station itself."""
    router = APIRouter(tags=["station"])

    @router.get("/health", dependencies=VIEW)
    def get_health() -> Health:
        """Say which parts run, and what an operator should know."""
        return parts.health()

    return router


ROUTERS: Final = (  # of the REST API, in the order of its description
    tasks_router,
    imports_router,
    uploads_router,
    demonstrations_router,
    recording_router,
    exports_router,
    calibrations_router,
    touches_router,
    jobs_router,
    results_router,
    versions_router,
    curves_router,
    adaptations_router,
    scenes_router,
    meshes_router,
    objects_router,
    assessments_router,
    executions_router,
    programs_router,
    control_router,
    robot_router,
    station_router,
    access_router,
    provider_router,
    people_router,
    audit_router,
    probes_router,
)
