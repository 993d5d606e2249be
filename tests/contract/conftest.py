import asyncio
from collections.abc import Iterator

import pytest

from tests.contract import stations
from tests.contract.desk import Desk
from tests.contract.stations import web_port
from tests.contract.stores import open_, store, url  # noqa: F401
from tests.postgres import Server

# What a station answers must not depend on its database; elsewhere, tests ask a station with SQLite alone.
ON_BOTH = {
    f"test_{name}"
    for name in (
        "idempotency",
        "pages",
        "rest",
        "rest_calibrations",
        "rest_control",
        "rest_scenes",
        "rest_task_changes",
        "rest_tasks",
        "rest_work",
        "versions",
    )
}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "desk" in metafunc.fixturenames:
        name = metafunc.module.__name__.rpartition(".")[2]
        databases = ["sqlite"] * (name != "test_postgres") + ["postgresql"] * (name in {*ON_BOTH, "test_postgres"})
        metafunc.parametrize("desk", databases, indirect=True, scope="package")


@pytest.fixture(scope="package")
def desk(request: pytest.FixtureRequest) -> Iterator[Desk]:
    """One station without an arm, and a client at its REST API; every test uses tasks of its own."""
    database = ""
    if request.param == "postgresql":
        server: Server = request.getfixturevalue("postgres")
        database = server.new_url()
    with stations.station(database=database) as station, asyncio.Runner() as loop:
        yield Desk(station, loop)


@pytest.fixture(scope="package")
def port(desk: Desk) -> Iterator[int]:
    """The same station on a real port."""
    with web_port(desk.station) as port:
        yield port
