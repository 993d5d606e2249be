"""How long the answers of every list take in a large station: 5,000 demonstrations, 2,000 runs, jobs and executions.

python -m tests.bench.lists
"""

import asyncio
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from httpx import ASGITransport, AsyncClient
from scipy.cluster.hierarchy import linkage
from sqlalchemy.orm import Session

from teachpath.app import Station
from teachpath.io.documents import to_document
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Run, Store
from teachpath.io.store.tables import DemonstrationRow, ExecutionTable, JobRow, RunTable
from teachpath.io.store.versions import learned_row
from teachpath.records import Cluster, ExecutorStatus, JobState, Learned, Score, StreamStatistics, Verdict
from teachpath_proto.control import ExecutorState
from tests.bench.report import Figure, against, print_report
from tests.contract.rows import a_job, demonstration, learned
from tests.contract.stations import settings

TASK = "large"
DEMONSTRATIONS, RUNS, MEMBERS = 5000, 2000, 100
LISTS = ("tasks", f"tasks/{TASK}/demonstrations", f"tasks/{TASK}/runs", f"tasks/{TASK}/jobs", "executions", "journal")
EPOCH = 1_700_000_000_000_000_000  # [ns]


def fill(folder: Path) -> None:
    """Fill the store of a data folder."""
    store = Store(StoreSettings(str(folder)))
    store.ensure_task(TASK, scene="paper", calibration="identity")
    with Session(store._engine) as session, session.begin():
        session.add_all(_demonstration(i) for i in range(DEMONSTRATIONS))
        for i in range(RUNS):
            _add_run(session, i)
    store.close()


def _demonstration(i: int) -> DemonstrationRow:
    random = np.random.default_rng(i)
    verdict = list(Verdict)[i % 3]
    made = demonstration(
        f"d{i:05d}",
        task=TASK,
        number=i + 1,
        verdict=verdict,
        reasons=() if verdict is Verdict.CLEAN else ("3 samples were lost while the hand carried",),
        duration=float(random.uniform(1, 4)),
        created_ns=EPOCH + i,
        statistics=StreamStatistics(received=200, lost=int(random.integers(0, 4))),
        recording=f"{TASK}/d{i:05d}.mcap",
    )
    return DemonstrationRow(
        id=made.id,
        task=TASK,
        number=made.number,
        created_ns=made.created_ns,
        verdict=made.verdict.value,
        document=to_document(made),
    )


def _add_run(session: Session, i: int) -> None:
    key, at = f"run-{i:05d}", EPOCH + i
    paths = tuple(replace(path, id=f"{key}-{path.cluster}", run=key) for path in _learned().paths)
    run = Run(key, TASK, at, replace(_learned(), paths=paths))
    session.add(
        RunTable(id=key, task=TASK, created_ns=at, summary=to_document(run.summary), document=to_document(run.learned))
    )
    job = a_job(f"learn-{i:05d}", task=TASK, created_ns=at, finished_ns=at + 1, outcome=key)
    session.add(JobRow(**to_document(replace(job, state=JobState.SUCCEEDED))))
    status = ExecutorStatus(execution=f"execution-{i:05d}", state=ExecutorState.ENDED)
    session.add(ExecutionTable(id=status.execution, plan=None, created_ns=at, document=to_document(status)))
    session.flush()
    session.add_all(learned_row(path, at) for path in paths)


def _learned() -> Learned:
    ids = tuple(f"d{i:05d}" for i in range(MEMBERS))
    clusters = tuple(
        Cluster(k, ids[k - 1 :: 2], tuple(Score(key, -1.0, r, True) for r, key in enumerate(ids[k - 1 :: 2], 1)))
        for k in (1, 2)
    )
    return replace(learned(), demonstrations=ids, clusters=clusters, linkage=linkage(np.arange(MEMBERS)[:, None]))


def measure() -> list[Figure]:
    """Return the seconds that the service takes for every page of every list, of 500 entries each."""
    with tempfile.TemporaryDirectory(prefix="teachpath-bench-") as folder:
        fill(Path(folder))
        station = Station(settings(Path(folder)))
        try:
            return asyncio.run(_read(station))
        finally:
            station.__exit__(None, None, None)


async def _read(station: Station) -> list[Figure]:
    figures = []
    async with AsyncClient(transport=ASGITransport(station.web), base_url="http://127.0.0.1:8765") as client:
        for resource in LISTS:
            place = f"/api/v1/{resource}?limit=500"
            await client.get(place)  # what only the first request of its kind costs
            walls, processor, entries = [], [], 0
            while place:
                began, worked = time.perf_counter(), time.process_time()
                answer = await client.get(place)
                walls.append(1e3 * (time.perf_counter() - began))
                processor.append(1e3 * (time.process_time() - worked))
                entries += len(answer.raise_for_status().json())
                place = answer.links.get("next", {}).get("url", "")
            figures.append(against(f"{resource}: {entries} entries, a page", walls, "ms", name="limit", value=200))
            figures.append(Figure("  of the processor", tuple(processor), "ms"))
    return figures


if __name__ == "__main__":
    print_report("Lists of a large station", measure())
