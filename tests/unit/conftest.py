from collections.abc import Iterator
from pathlib import Path

import pytest

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.plan import plan
from teachpath.records import Plan
from tests.unit.executor.executors import signed
from tests.unit.motion.ways import MIDDLE, way
from tests.unit.recorder.recorders import Bench


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


@pytest.fixture(scope="session")
def middle() -> Plan:
    """A signed plan between the obstacles of the paper's scene."""
    return signed(plan(way(MIDDLE), paper_scene()))
