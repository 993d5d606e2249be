"""Several services on one database: a job is done once, whoever dies; names are of one station; changes reach all."""

import queue
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
import sqlalchemy as sa

from teachpath.errors import Conflict, UnusableInput, UnusableSettings
from teachpath.io.store.changes import ALL_TOPICS
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.job_service import JobService
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.records import ExecutorStatus, JobState
from teachpath.robot.scenes import Scenes
from teachpath_proto.control import ExecutorState
from tests.contract.job_program import job_service
from tests.contract.rows import a_job, demonstration, learned
from tests.contract.service_program import a_program, every_run
from tests.contract.stations import settings
from tests.postgres import Server
from tests.waiting import HANG, wait_until

Open = Callable[..., Store]


@pytest.fixture
def url(postgres: Server) -> Iterator[str]:
    url = postgres.new_url()
    yield url
    postgres.drop(url)


@pytest.fixture
def open_(url: str, tmp_path: Path) -> Iterator[Open]:
    """Open services of a station, each with a data folder of its own."""
    opened: list[Store] = []

    def open_(role: str = "worker", station: str = "cell", **options: object) -> Store:
        folder = str(tmp_path / f"folder-{len(opened)}")
        opened.append(Store(StoreSettings(folder, url, station), **options))  # type: ignore[arg-type]
        opened[-1].services.begin(role)
        opened[-1].ensure_task("t", scene="paper", calibration="identity")
        return opened[-1]

    yield open_
    for store in opened:
        store.close()


def presume_dead(url: str, service: str) -> None:
    """Let a service have given no sign of life for a long time."""
    engine = sa.create_engine(url)
    with engine.begin() as connection:
        connection.execute(sa.text("UPDATE services SET alive_ns = 0 WHERE id = :id"), {"id": service})
    engine.dispose()


# claims


def test_a_job_is_claimed_by_one_of_many(open_: Open) -> None:
    stores = [open_() for _ in range(3)]
    stores[0].add_job(a_job())
    with ThreadPoolExecutor(9) as threads:
        claimed = list(threads.map(lambda store: (store, store.claims.claim("learn-1")), stores * 3))
    assert len({id(store) for store, job in claimed if job}) == 1
    job = stores[0].job("learn-1")
    assert (job.state, job.attempt, job.station) == (JobState.RUNNING, 1, "cell")


def test_what_a_dead_service_did_is_done_by_another_and_stored_once(open_: Open, url: str) -> None:
    dead, other = open_(), open_()
    dead.add_job(a_job())
    assert dead.claims.claim("learn-1")
    assert other.claims.waiting(["learn"]) == []
    assert other.claims.claim("learn-1") is None
    presume_dead(url, dead.services.id)
    assert [job.id for job in other.claims.waiting(["learn"])] == ["learn-1"]
    assert other.claims.to_break_off(["learn-1"]) == []  # it may be about to claim it
    assert other.claims.claim("learn-1")
    dead.services.note_alive()  # it was only slow: what it made meanwhile is not stored
    assert dead.claims.to_break_off(["learn-1"]) == ["learn-1"]
    for change in (
        lambda: dead.finish_learning("learn-1", learned()),
        lambda: dead.set_job("learn-1", fraction=0.5),
    ):
        with pytest.raises(Conflict, match="job learn-1 is done by another service now"):
            change()
    other.finish_learning("learn-1", learned())
    assert len(other.lists.runs("t").entries) == 1


def test_a_service_that_ends_gives_back_what_it_has_not_finished(open_: Open) -> None:
    ending, other = open_(), open_()
    for key in ("learn-1", "learn-2"):
        ending.add_job(a_job(key))
        assert ending.claims.claim(key)
    ending.finish_learning("learn-2", learned())
    ending.claims.give_back(["learn-1", "learn-2"])
    assert [job.id for job in other.claims.waiting(["learn"])] == ["learn-1"]


def test_a_job_is_cancelled_from_any_service(open_: Open, url: str) -> None:
    doing, other = open_(), open_()
    for key in ("queued", "running", "left"):
        doing.add_job(a_job(key))
    doing.claims.claim("running")
    assert other.claims.cancel("queued").state is JobState.CANCELLED
    assert doing.claims.to_break_off(["running"]) == []
    assert other.claims.cancel("running").state is JobState.RUNNING
    assert doing.claims.to_break_off(["running"]) == ["running"]
    presume_dead(url, doing.services.id)  # before it could break it off
    assert other.claims.claim("running") is None
    assert other.job("running").state is JobState.CANCELLED
    with pytest.raises(Conflict, match="has already cancelled"):
        other.claims.cancel("running")


# stations


def test_stations_have_jobs_executions_and_recordings_of_their_own(open_: Open) -> None:
    one, two = open_("service", "one"), open_("service", "two")
    for number, store in enumerate((one, two)):
        store.add_job(a_job(f"learn-{number}"))
        store.put_execution(f"e{number}", None, ExecutorStatus(state=ExecutorState.FOLLOWING))
        store.add_demonstration(demonstration(f"d{number}"))
    assert [job.id for job in two.claims.waiting(["learn"])] == ["learn-1"]
    assert two.claims.claim("learn-0") is None
    assert [job.id for job in two.jobs(unfinished=True)] == ["learn-1"]
    assert [execution.id for execution in two.unfinished_executions()] == ["e1"]
    assert two.checks.named_recordings() == {"t/d1.mcap"}
    assert [job.station for job in one.lists.jobs("t").entries] == ["two", "one"]  # and everybody sees them all
    for store in (one, two):
        assert [(each.number, each.station) for each in store.demonstrations("t")] == [(1, "one"), (2, "two")]
        assert [each.station for each in store.lists.demonstrations("t").entries] == ["one", "two"]
        assert {each.id: each.station for each in store.lists.executions().entries} == {"e0": "one", "e1": "two"}
    assert one.change_demonstration("d1", mark="good").station == "two"
    with pytest.raises(UnusableInput, match=r"recordings other stations keep \(1 at one\)"):
        two.services.require_recorded_here("t")


def test_a_name_is_of_one_running_station(open_: Open, url: str) -> None:
    first = open_("service", "cell")
    for name in ("cell", ""):
        with pytest.raises(Conflict, match=r"give each station a name of its own \(store.station\)"):
            open_("service", name)
    open_("service", "another")
    open_("worker", "cell")
    presume_dead(url, first.services.id)
    open_("service", "cell")


def test_a_service_that_was_killed_begins_again_in_its_folder(url: str, tmp_path: Path) -> None:
    settings = StoreSettings(str(tmp_path), url, "cell")
    killed, again = Store(settings), Store(settings)
    killed.services.begin()
    killed.add_job(a_job())
    killed.claims.claim("learn-1")
    again.services.begin()
    assert [job.id for job in again.claims.waiting(["learn"])] == ["learn-1"]
    for store in (killed, again):
        store.close()


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_rows_of_a_station_without_a_name_are_its_own_when_it_gets_one(kind: str, url: str, tmp_path: Path) -> None:
    database = url if kind == "postgresql" else ""
    nameless = Store(StoreSettings(str(tmp_path), database))
    nameless.add_job(a_job())
    nameless.ensure_task("t", scene="paper", calibration="identity")
    assert nameless.add_demonstration(demonstration("d")).station == ""
    nameless.close()
    named = Store(StoreSettings(str(tmp_path), database, "cell"))
    named.services.begin()
    assert [job.id for job in named.claims.waiting(["learn"])] == ["learn-1"]
    assert named.demonstration("d").station == "cell"
    named.close()


# changes


@contextmanager
def hearing(store: Store, others: Store) -> Iterator[queue.Queue[tuple[str, str]]]:
    """Give what a service hears of others, from when it listens."""
    heard: queue.Queue[tuple[str, str]] = queue.Queue()
    store.feed.start(lambda table, key: heard.put((table, key)))
    number = iter(range(100_000))

    def is_heard() -> bool:
        others.ensure_task(f"probe-{next(number)}", scene="paper", calibration="identity")
        return not heard.empty()

    wait_until(is_heard, "it listens")
    yield heard


def next_but_probes(heard: queue.Queue[tuple[str, str]]) -> tuple[str, str]:
    while (change := heard.get(timeout=HANG))[0] == "tasks":
        pass
    return change


def test_changes_reach_every_other_service_when_they_are_stored(open_: Open) -> None:
    writer, hearer = open_(), open_()
    with hearing(hearer, writer) as heard:
        with pytest.raises(Conflict):
            writer.add_demonstration(demonstration("refused", task="nowhere"))
        hearer.add_job(a_job())  # its own changes it knows already
        writer.add_demonstration(demonstration("d"))
        assert next_but_probes(heard) == ("demonstrations", "d")


def test_a_scene_that_one_station_changes_counts_at_all(open_: Open) -> None:
    writer, hearer = open_(station="one"), open_(station="other")
    here, there = (Scenes(store.scenes, (paper_scene(),)) for store in (writer, hearer))
    assert there.get("paper") == paper_scene()
    with hearing(hearer, writer) as heard:
        for number in range(2, 4):
            changed = replace(paper_scene(), floor=-number / 10)
            here.save(changed, base=number - 1)
            assert next_but_probes(heard) == ("scenes", "paper")
            assert there.get("paper") == changed
        with pytest.raises(Conflict, match="has version 3"):
            there.save(paper_scene(), base=2)


def test_after_a_lost_line_everything_is_read_again(open_: Open, postgres: Server) -> None:
    store, other = open_(), open_()
    with hearing(store, other) as heard:
        postgres.cut_lines()
        assert next_but_probes(heard) == (ALL_TOPICS, "")
        other.add_job(a_job())
        assert next_but_probes(heard) == ("jobs", "learn-1")


# services that do jobs


def test_of_two_services_one_is_killed_and_every_job_is_done_once(open_: Open, url: str, tmp_path: Path) -> None:
    hearer, seen = open_(), queue.Queue[float]()
    hearer.feed.start(lambda table, key: seen.put(hearer.job(key).fraction) if table == "jobs" else None)
    store, jobs = job_service(url, str(tmp_path / "one"))
    try:
        with a_program(url, tmp_path / "two") as (process, service):
            # The service that is asked does not work yet: only the program can.
            endless = jobs.submit("t", "learn", {"reports": 10**6})
            wait_until(lambda: seen.get(timeout=HANG) > 0.0, "progress comes here")
            assert jobs.cancel(endless.id).state is JobState.RUNNING
            wait_until(lambda: store.job(endless.id).state is JobState.CANCELLED, "the program breaks it off")
            submitted = [jobs.submit("t", "learn", {"reports": 2}, str(number % 4)) for number in range(40)]
            wait_until(lambda: every_run(store), "the program works")
            process.kill()
            process.wait()
            presume_dead(url, service)
            jobs.start()
            wait_until(lambda: not store.jobs(unfinished=True), "every job has ended")
        ended = [store.job(job.id) for job in submitted]
        assert {job.state for job in ended} == {JobState.SUCCEEDED}
        assert sorted(run.id for run in every_run(store)) == sorted(job.outcome for job in ended)
    finally:
        jobs.stop()
        store.close()


def test_a_worker_needs_a_shared_database_and_the_recordings(url: str, tmp_path: Path) -> None:
    with pytest.raises(UnusableSettings, match="needs a database that several services share"):
        JobService(settings(tmp_path))
    chosen = settings(tmp_path, database=url)
    store = Store(chosen.store)
    store.ensure_task("t", scene="paper", calibration="identity")
    store.add_demonstration(demonstration("d"))
    store.close()
    with pytest.raises(UnusableSettings, match=r"recording t/d.mcap of station '' is not under .*--data"):
        JobService(chosen)
    recording = tmp_path / "recordings" / "t" / "d.mcap"
    recording.parent.mkdir(parents=True)
    recording.touch()
    with JobService(chosen):
        pass
