"""How soon a stop is answered while the station is busy: POST /stop, from the request to the executor's own status.

The load: a file of 64 MB is imported again and again, a job learns, pages listen on WebSockets, and connections hang
that have sent half a request; one that the station closes is opened anew.
"""

from __future__ import annotations

import io
import selectors
import socket
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Event
from pathlib import Path

import httpx
import numpy as np
from websockets.sync.client import connect

from teachpath_client import ClientError, Station
from tests.bench.motion import show
from tests.bench.report import Figure
from tests.system.processes import Service

FILE_SIZE = 64_000_000  # bytes
PAGES, HALF_OPEN = 200, 1000
INTERVAL = 0.05  # [s] between two stops
ALLOWED_MS = 50.0  # [ms] that 99 of 100 stops may take under load


def measure(*, stops: int) -> list[Figure]:
    """Return the figures of so many stops at rest, and as many under load."""
    with (
        tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder,
        Service(Path(folder) / "data") as service,
    ):
        show(service.endpoint)
        service.station.wait_for_arm()
        figures = _figures("nothing else", _stops(service.url, stops))
        ended: list[str] = []
        with _load(service, ended):
            figures += _figures("under load", _stops(service.url, stops))
        for work in ("import", "learn"):
            figures.append(Figure(f"  {work} jobs that ended meanwhile", (float(ended.count(work)),), "jobs"))
        return figures


def _figures(load: str, times: list[float]) -> list[Figure]:
    p99 = float(np.percentile(times, 99))
    return [
        Figure(f"{len(times)} stops, {load}", tuple(times), "ms"),
        Figure("  99 of 100 within", (p99,), "ms", f"allowed: {ALLOWED_MS:g} ms", p99 / ALLOWED_MS),
    ]


def _stops(url: str, count: int) -> list[float]:
    """Stop again and again on one connection; returns how long each took [ms]."""
    times = []
    with httpx.Client(base_url=url, trust_env=False, timeout=30.0) as http:
        for _ in range(count):
            start = time.monotonic()
            http.post("/api/v1/stop").raise_for_status()
            times.append(1e3 * (time.monotonic() - start))
            time.sleep(INTERVAL)
    return times


@contextmanager
def _load(service: Service, ended: list[str]) -> Iterator[None]:
    """Load the service from another process, so that nothing delays who measures; fills `ended` on leaving."""
    context = get_context("spawn")
    ready, left, outcomes = context.Event(), context.Event(), context.Queue()
    process = context.Process(target=_work, args=(service.url, ready, left, outcomes))
    process.start()
    ready.wait()
    try:
        yield
    finally:
        left.set()
        _cancel_jobs(service.url)
        ended += iter(outcomes.get, "")
        process.join()


def _work(url: str, ready: Event, left: Event, outcomes: Queue[str]) -> None:
    """Import and learn again and again while pages listen and connections hang, until it is over."""
    content, ended = _file(), list[str]()
    works: dict[str, Callable[[Station], object]] = {
        "import": lambda station: station.import_file("bulk", content, name="bulk.csv"),
        "learn": lambda station: station.learn("demo"),
    }
    threads = [threading.Thread(target=_again, args=(url, name, work, left, ended)) for name, work in works.items()]
    address = url.removeprefix("http://")
    with ExitStack() as stack, selectors.DefaultSelector() as hanging:
        for _ in range(PAGES):
            stack.enter_context(connect(f"ws://{address}/api/v1/events", max_queue=None))
        for _ in range(HALF_OPEN):
            hanging.register(_half_open(address), selectors.EVENT_READ)
        for thread in threads:
            thread.start()
        ready.set()
        while not left.is_set():
            for closed, _ in hanging.select(timeout=0.1):
                _leave(hanging, closed.fileobj)
                hanging.register(_half_open(address), selectors.EVENT_READ)
        for thread in threads:
            thread.join()
        for each in list(hanging.get_map().values()):
            _leave(hanging, each.fileobj)
    for name in (*ended, ""):
        outcomes.put(name)


def _half_open(address: str) -> socket.socket:
    """Open a connection and send half a request."""
    connection = socket.create_connection(("127.0.0.1", int(address.partition(":")[2])))
    connection.sendall(b"GET /api/v1/health HTTP/1.1\r\nHost: ")
    return connection


def _leave(hanging: selectors.BaseSelector, connection: object) -> None:
    assert isinstance(connection, socket.socket)
    hanging.unregister(connection)
    connection.close()


def _cancel_jobs(url: str) -> None:
    with Station(url) as station:
        for task in ("bulk", "demo"):
            with suppress(ClientError):
                for job in station.jobs(task):
                    if not job.finished_ns:
                        station.cancel(job.id)


def _again(url: str, name: str, work: Callable[[Station], object], over: Event, ended: list[str]) -> None:
    with Station(url, timeout=120.0) as station:
        while not over.is_set():
            try:
                work(station)
                ended.append(name)
            except ClientError as error:
                if not over.is_set():
                    print(f"{name}: {error}", flush=True)
                    over.wait(1.0)


def _file() -> bytes:
    """Return a CSV file of one long motion, within the limits of an import."""
    random = np.random.default_rng(1)
    text = io.StringIO()
    text.write("t,x,y,z,qw,qx,qy,qz\n")
    row = 0
    while text.tell() < FILE_SIZE - 200:
        x, y, z = (0.4 + 0.1 * random.random(3)).tolist()
        text.write(f"{row * 0.02:.24f},{x:.24f},{y:.24f},{z:.24f},1.000000000000000000,0.0,0.0,0.0\n")
        row += 1
    return text.getvalue().encode()
