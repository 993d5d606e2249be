"""A whole station in this process, without the executor and the simulated arm."""

import ssl
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from teachpath.app import Station
from teachpath.commands.serving import listen
from teachpath.config import Settings, load
from teachpath.web.server import web_server
from teachpath.web.settings import WebSettings
from tests.ports import free_port
from tests.waiting import HANG


def settings(folder: Path, *, database: str = "", **changes: Any) -> Settings:
    """Return the defaults with small limits, data in `folder`, free ports, and further changes.

    No tracker is lost because the machine was slow: one that is silent is one that waits for its turn.
    """
    return load(
        document={
            "bus": {"endpoint": f"tcp/127.0.0.1:{free_port()}"},
            "store": {"data_dir": str(folder), "database": database},
            "recording": {"handshake_timeout": 0.2, "shortest_transport": 8, "longest_silence": 3600.0},
            "web": {"largest_upload": 2_000_000},
        }
        | changes
    )


@contextmanager
def station(**changes: Any) -> Iterator[Station]:
    """Open a station whose arm is missing: recorder, jobs and executions run, nobody executes."""
    with tempfile.TemporaryDirectory() as folder, station_in(Path(folder), **changes) as station:
        yield station


@contextmanager
def station_in(folder: Path, **changes: Any) -> Iterator[Station]:
    """Open a station without an arm on a data folder."""
    station = Station(settings(folder, **changes))
    try:
        parts = (
            station.access,
            station.recorder,
            station.executions,
            station.certificate_status,
            station.joints,
            station.jobs,
        )
        for part in parts:
            part.start()
        yield station
    finally:
        station.__exit__(None, None, None)


@contextmanager
def web_port(station: Station) -> Iterator[int]:
    """Serve a station on a real port, by https where it has a certificate."""
    context = station.certificate.context if station.certificate else None
    with served(station.web, station.settings.web, context) as port:
        yield port


@contextmanager
def served(web: Any, settings: WebSettings, context: ssl.SSLContext | None = None) -> Iterator[int]:
    """Serve a web application on a real port."""
    port = free_port()
    server = web_server(web, settings, context)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listen("127.0.0.1", port)]}, daemon=True)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield port
    server.should_exit = True
    thread.join(HANG)
