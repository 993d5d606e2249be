import asyncio
import importlib.util
import threading
import time
from collections.abc import Iterator

import pytest

from teachpath.commands.serving import free_port, listen
from teachpath.web.server import web_server
from tests.contract import stations
from tests.contract.desk import Desk
from tests.postgres import MISSING, Server, find_programs, serving


@pytest.fixture(scope="session")
def postgres() -> Iterator[Server]:
    """A PostgreSQL server of the tests' own."""
    if find_programs() is None or importlib.util.find_spec("psycopg") is None:
        pytest.skip(MISSING)
    with serving() as server:
        yield server


@pytest.fixture(scope="package")
def desk() -> Iterator[Desk]:
    """One station without an arm, and a client at its REST API; every test uses tasks of its own."""
    with stations.station() as station, asyncio.Runner() as loop:
        yield Desk(station, loop)


@pytest.fixture(scope="package")
def port(desk: Desk) -> Iterator[int]:
    """The same station on a real port."""
    port = free_port()
    server = web_server(desk.station.web, desk.station.settings.web)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listen("127.0.0.1", port)]}, daemon=True)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield port
    server.should_exit = True
    thread.join(10)
