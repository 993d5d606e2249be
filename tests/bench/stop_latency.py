"""How soon a stop is answered while the station is busy: POST /stop, from the request to the executor's own status.

The load: a file of 64 MB is imported again and again, a job learns, pages listen on WebSockets, and connections hang
that have sent half a request.
"""

import io
import socket
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import get_context
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
ALLOWED = 50.0  # [ms] that 99 of 100 stops may take under load


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
        Figure("  99 of 100 within", (p99,), "ms", f"allowed: {ALLOWED:g} ms", p99 / ALLOWED),
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
    content = _file()
    over = threading.Event()
    works: dict[str, Callable[[Station], object]] = {
        "import": lambda station: station.import_file("bulk", content, name="bulk.csv"),
        "learn": lambda station: station.learn("demo"),
    }
    threads = [
        threading.Thread(target=_again, args=(service.url, name, work, over, ended)) for name, work in works.items()
    ]
    context = get_context("spawn")  # what reads for the pages must not delay who measures
    ready, left = context.Event(), context.Event()
    pages = context.Process(target=_open_pages, args=(service.url.removeprefix("http://"), ready, left))
    pages.start()
    ready.wait()
    try:
        for thread in threads:
            thread.start()
        yield
    finally:
        over.set()
        _cancel_jobs(service.url)
        for thread in threads:
            thread.join()
        left.set()
        pages.join()


def _open_pages(address: str, ready: Event, left: Event) -> None:
    """Open the pages and the connections that hang, until they may leave."""
    with ExitStack() as stack:
        for _ in range(PAGES):
            stack.enter_context(connect(f"ws://{address}/api/v1/events", max_queue=None))
        for _ in range(HALF_OPEN):
            half = stack.enter_context(socket.create_connection(("127.0.0.1", int(address.partition(":")[2]))))
            half.sendall(b"GET /api/v1/health HTTP/1.1\r\nHost: ")
        ready.set()
        left.wait()


def _cancel_jobs(url: str) -> None:
    with Station(url) as station:
        for task in ("bulk", "demo"):
            with suppress(ClientError):
                for job in station.jobs(task):
                    if not job.finished_ns:
                        station.cancel(job.id)


def _again(url: str, name: str, work: Callable[[Station], object], over: threading.Event, ended: list[str]) -> None:
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
