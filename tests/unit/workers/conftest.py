from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.io.store import Store, StoreSettings
from tests.unit.workers.recorders import Bench


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(tmp_path / "data")))
    yield store
    store.close()


@pytest.fixture
def bench(store: Store) -> Iterator[Bench]:
    bench = Bench(store)
    yield bench
    bench.recorder.stop()
