import asyncio
from collections.abc import Iterator

import pytest

from tests.contract import stations
from tests.contract.desk import Desk


@pytest.fixture(scope="package")
def desk() -> Iterator[Desk]:
    """One station without an arm, and a client at its REST API; every test uses tasks of its own."""
    with stations.station() as station, asyncio.Runner() as loop:
        yield Desk(station, loop)
