"""Metrics in the form of Prometheus at `/metrics`: what is counted anyway, read when it is asked for."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from fastapi import APIRouter, Response
from prometheus_client import CollectorRegistry, Counter, Gauge, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.registry import Collector
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from teachpath.api.access import VIEW
from teachpath.api.parts import Parts
from teachpath.records import ExecutorStatus
from teachpath.robot.processes import ProcessState
from teachpath_proto.control import ExecutorState

PLACES: Final = ("view", "events", "joints", "trackers")  # of the WebSockets


def new_registry() -> CollectorRegistry:
    """Return a registry of one station's own, without what Prometheus' library counts of every process."""
    return CollectorRegistry()


class RequestMetrics:
    """Counts requests by method and status, and the open WebSockets; a middleware."""

    def __init__(self, app: ASGIApp, *, registry: CollectorRegistry) -> None:
        self._app = app
        self._requests = Counter(
            "teachpath_requests",
            "Requests that were answered, by method and status.",
            ("method", "status"),
            registry=registry,
        )
        self._sockets = Gauge("teachpath_open_sockets", "Open WebSockets.", ("place",), registry=registry)
        for place in PLACES:
            self._sockets.labels(place)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on."""
        if scope["type"] == "websocket":
            with self._sockets.labels(_place(scope["path"])).track_inprogress():
                await self._app(scope, receive, send)
            return

        async def counted(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._requests.labels(_method(scope["method"]), message["status"]).inc()
            await send(message)

        await self._app(scope, receive, counted if scope["type"] == "http" else send)


class StationMetrics(Collector):
    """Reads the parts of a station."""

    def __init__(self, parts: Parts) -> None:
        self._parts = parts

    def collect(self) -> Iterator[Metric]:
        """Yield every metric as it is now."""
        yield from self._recording()
        yield from self._processes()
        yield _labelled(
            GaugeMetricFamily("teachpath_jobs", "Jobs in the store, by kind and state.", labels=("kind", "state")),
            self._parts.store.lists.job_counts(),
        )
        stops = CounterMetricFamily("teachpath_stops", "Stops that were ordered, by outcome.", labels=("outcome",))
        yield _labelled(stops, {(outcome,): count for outcome, count in self._parts.executions.stops().items()})
        status = self._parts.executions.status
        yield GaugeMetricFamily(
            "teachpath_executor_up", "1 while the executor says how it is.", value=status is not None
        )
        yield from _execution(status or ExecutorStatus())

    def _recording(self) -> Iterator[Metric]:
        recorder = self._parts.recorder
        totals = recorder.totals()
        yield CounterMetricFamily("teachpath_samples", "Samples that were received in recordings.", totals.samples)
        losses = CounterMetricFamily(
            "teachpath_sample_losses", "Samples that were lost, late, doubled, refused ..., by kind.", labels=("kind",)
        )
        yield _labelled(losses, {(kind,): count for kind, count in totals.losses.items()})
        takes = CounterMetricFamily("teachpath_takes", "Demonstrations that were made.", labels=("verdict",))
        yield _labelled(takes, {(verdict,): count for verdict, count in totals.takes.items()})
        yield GaugeMetricFamily("teachpath_recordings", "Recordings that run.", len(recorder.statuses()))
        waiting, size = self._parts.store.spool.waiting()
        yield GaugeMetricFamily("teachpath_waiting_recordings", "Recordings that wait to be uploaded.", waiting)
        yield GaugeMetricFamily("teachpath_waiting_bytes", "Size of the recordings that wait to be uploaded.", size)
        yield GaugeMetricFamily("teachpath_trackers", "Trackers that are there.", len(recorder.trackers()))
        yield GaugeMetricFamily("teachpath_backlog_samples", "Samples that wait for the recorder.", recorder.backlog)

    def _processes(self) -> Iterator[Metric]:
        states = self._parts.health().processes
        up = GaugeMetricFamily(
            "teachpath_process_up", "1 while a process beside the service runs.", labels=("process",)
        )
        yield _labelled(up, {(name,): state is ProcessState.RUNNING for name, state in states.items()})


def metrics_router(parts: Parts, registry: CollectorRegistry) -> APIRouter:
    """Return the route of the metrics."""
    router = APIRouter(include_in_schema=False)
    registry.register(StationMetrics(parts))

    @router.get("/metrics", dependencies=VIEW)
    def get_metrics() -> Response:
        """Return the figures of the station in the text form of Prometheus."""
        return Response(generate_latest(registry), headers={"Content-Type": CONTENT_TYPE_LATEST})

    return router


def _execution(status: ExecutorStatus) -> Iterator[Metric]:
    """Yield how the newest execution goes; all 0 while there is none."""
    moving = GaugeMetricFamily("teachpath_arm_moving", "1 while an execution is under way, held ones too.")
    moving.add_metric((), status.state not in (ExecutorState.IDLE, ExecutorState.ENDED, ExecutorState.FAULTED))
    yield moving
    lateness = GaugeMetricFamily(
        "teachpath_setpoint_lateness_seconds",
        "Lateness of the setpoints of the newest execution.",
        labels=("quantile",),
    )
    values = {"0.5": status.lateness_p50_us, "0.99": status.lateness_p99_us, "1": status.lateness_max_us}
    yield _labelled(lateness, {(quantile,): 1e-6 * value for quantile, value in values.items()})
    setpoints = GaugeMetricFamily(
        "teachpath_setpoints", "Setpoints of the newest execution: sent, late, missed.", labels=("kind",)
    )
    yield _labelled(setpoints, {("sent",): status.cycles, ("late",): status.late, ("missed",): status.missed})
    yield GaugeMetricFamily("teachpath_limit_use", "Largest share of a limit that it used.", status.limit_use)
    yield GaugeMetricFamily("teachpath_tracking_error_radians", "Its largest tracking error.", status.tracking_error)


def _labelled(family: Metric, values: dict[tuple[str, ...], float]) -> Metric:
    assert isinstance(family, GaugeMetricFamily | CounterMetricFamily)
    for labels, value in values.items():
        family.add_metric(labels, value)
    return family


def _place(path: str) -> str:
    place = path.removeprefix("/api/v1/").partition("/")[0]
    return place if place in PLACES else "other"


def _method(method: str) -> str:
    return method if method in ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS") else "other"
