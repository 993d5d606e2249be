"""Stores on each database, as fixtures."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from tests.postgres import Server

Open = Callable[[], Store]


# Every database that a store must work on; each test has an empty one.
DATABASES = ["sqlite", "postgresql"]


@pytest.fixture(params=DATABASES)
def url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    if request.param == "sqlite":
        yield f"sqlite:///{tmp_path}/teachpath.sqlite"
        return
    server: Server = request.getfixturevalue("postgres")
    url = server.new_url()
    yield url
    server.drop(url)


@pytest.fixture
def open_(url: str, tmp_path: Path) -> Iterator[Open]:
    opened: list[Store] = []

    def open_() -> Store:
        opened.append(Store(StoreSettings(data_dir=str(tmp_path), database=url)))
        return opened[-1]

    yield open_
    for store in opened:
        store.close()


@pytest.fixture
def store(open_: Open) -> Store:
    store = open_()
    store.ensure_task("t", scene="paper", calibration="identity")
    return store
