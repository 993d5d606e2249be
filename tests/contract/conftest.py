import asyncio
import threading
import time
from collections.abc import Iterator

import pytest
import uvicorn

from teachpath.commands.serving import free_port
from tests.contract import stations
from tests.contract.desk import Desk


@pytest.fixture(scope="package")
def desk() -> Iterator[Desk]:
    """One station without an arm, and a client at its REST API; every test uses tasks of its own."""
    with stations.station() as station, asyncio.Runner() as loop:
        yield Desk(station, loop)


@pytest.fixture(scope="package")
def port(desk: Desk) -> Iterator[int]:
    """The same station on a real port."""
    port = free_port()
    config = uvicorn.Config(desk.station.web, host="127.0.0.1", port=port, log_level="warning", ws="websockets-sansio")
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield port
    server.should_exit = True
    thread.join(10)
