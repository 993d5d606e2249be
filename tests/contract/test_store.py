"""The store: the laws that every database behind it keeps."""

import json
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sqlalchemy as sa
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from teachpath.errors import Conflict, NotFound
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.io.documents import decode_demonstration, encode
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.io.store.tables import NEWEST_REVISION, Base, DemonstrationRow, ExecutionTable, JobRow, PlanRow, RunTable
from teachpath.records import (
    AccessToken,
    Calibration,
    Capability,
    Deviation,
    ExecutorStatus,
    JobState,
    Person,
    Session,
    StreamStatistics,
)
from teachpath_proto.control import ExecutorState
from tests.contract.rows import a_job, demonstration, learned
from tests.postgres import Server
from tests.unit.io.test_documents import a_path, a_plan
from tests.waiting import HANG

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


# tokens


def a_token(name: str, digest: str, **changes: int) -> AccessToken:
    return replace(AccessToken(name, (Capability.VIEW, Capability.OPERATE), digest, 10, 100), **changes)  # type: ignore[arg-type]


def test_tokens_are_kept_used_and_revoked(open_: Open) -> None:
    tokens = open_().access_tokens
    first, second = a_token("cell-3", "a" * 64), a_token("glove", "b" * 64, created_ns=11)
    tokens.add(first)
    tokens.add(second)
    tokens.note_use({first.digest: 20})
    assert open_().access_tokens.all() == [replace(first, used_ns=20), second]
    assert tokens.revoke("cell-3", 30) == replace(first, used_ns=20, revoked_ns=30)
    with pytest.raises(NotFound, match="no token 'cell-3' that holds; known: glove"):
        tokens.revoke("cell-3", 31)
    with pytest.raises(NotFound, match="known: none"):
        tokens.revoke("glove", 100)  # it has expired


def test_a_name_has_one_token_that_holds(store: Store) -> None:
    tokens = store.access_tokens
    tokens.add(a_token("cell-3", "a" * 64))
    with pytest.raises(Conflict, match="there is a token 'cell-3' already"):
        tokens.add(a_token("cell-3", "b" * 64, created_ns=99))
    tokens.add(a_token("cell-3", "c" * 64, created_ns=100, expires_ns=200))  # the first has expired
    tokens.revoke("cell-3", 120)
    tokens.add(a_token("cell-3", "d" * 64, created_ns=130, expires_ns=200))
    assert [token.digest[0] for token in tokens.all()] == ["a", "c", "d"]


# people


def test_a_person_of_a_provider_keeps_the_first_name_and_has_the_last_roles(store: Store) -> None:
    def anna(name: str, *roles: Capability, subject: str = "1") -> Person:
        return Person(name, roles, "", 5, 5, "https://lab.example", subject)

    people = store.people
    assert people.register(anna("anna", Capability.TEACH)) == anna("anna", Capability.TEACH)
    again = anna("anna", Capability.OPERATE)
    assert people.register(anna("otto", Capability.OPERATE)) == again
    assert people.all() == [again]
    with pytest.raises(Conflict, match="taken by a person or a token"):
        people.register(anna("anna", Capability.TEACH, subject="2"))
    with pytest.raises(Conflict, match="has no password here"):
        people.change_password("anna", "hash", 6)


def test_people_are_kept_with_their_sessions_and_go_with_them(open_: Open) -> None:
    people = open_().people
    anna, otto = (Person(name, (Capability.TEACH,), f"hash of {name}", 5, 5) for name in ("anna", "otto"))
    people.add(otto)
    people.add(anna)
    with pytest.raises(Conflict, match="the name 'anna' is taken"):
        people.add(anna)
    sessions = [Session(digest * 64, name, 6, 6) for digest, name in (("a", "anna"), ("b", "anna"), ("c", "otto"))]
    for session in sessions:
        people.begin_session(session)
    people.note_use({"a" * 64: 9})
    people.end_sessions(["b" * 64, "d" * 64])
    again = open_().people
    assert again.all() == [anna, otto]
    assert sorted(again.sessions(), key=lambda s: s.digest) == [replace(sessions[0], used_ns=9), sessions[2]]
    people.change_password("anna", "another", 10)
    assert again.all()[0] == replace(anna, password_hash="another", changed_ns=10)
    assert again.sessions() == [sessions[2]]
    people.remove("otto")
    assert again.sessions() == []
    for act in (lambda: people.remove("otto"), lambda: people.change_password("otto", "x", 1)):
        with pytest.raises(NotFound, match="no person 'otto'; known: anna"):
            act()
    with pytest.raises(NotFound):
        people.begin_session(sessions[2])


def test_a_name_is_of_a_person_or_of_a_token_and_of_one_alone(store: Store) -> None:
    store.people.add(Person("anna", (), "hash", 1, 1))
    with pytest.raises(Conflict, match="a person has the name 'anna'"):
        store.access_tokens.add(a_token("anna", "a" * 64))
    store.access_tokens.add(a_token("cell-3", "b" * 64))
    with pytest.raises(Conflict, match="taken by a person or a token"):
        store.people.add(Person("cell-3", (), "hash", 50, 50))
    for alike in ("Cell-3", "ANNA"):  # which a journal would not tell apart
        with pytest.raises(Conflict, match="taken by"):
            store.people.add(Person(alike, (), "hash", 50, 50))
        with pytest.raises(Conflict, match=r"'(cell-3|anna)'"):
            store.access_tokens.add(a_token(alike, "c" * 64))
        with pytest.raises(Conflict, match="taken by"):
            store.people.register(Person(alike, (), "", 50, 50, "https://lab.example", "7"))
    store.access_tokens.revoke("cell-3", 60)
    store.people.add(Person("Cell-3", (), "hash", 70, 70))


# the tables


@contextmanager
def migrating(url: str, move: Callable[[Config, str], None], revision: str) -> Iterator[sa.Connection]:
    """Move the tables of a database to a revision; the connection sees them there."""
    engine = sa.create_engine(url)
    config = Config()
    config.set_main_option("script_location", "teachpath.io.store:migrations")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        move(config, revision)
        yield connection
    engine.dispose()


def test_an_arm_is_stored_as_it_is_and_only_once(store: Store) -> None:
    arm = read_arm(EXAMPLES["six-axis"], name="light")
    stored = store.arms.add(arm, "six_axis.urdf")
    assert store.arms.add(arm, "six_axis.urdf") == stored
    assert store.arms.versions("light") == [stored]
    assert stored.arm.hash == store.arms.newest()[0].arm.hash == arm.hash
    heavier = store.arms.add(replace(arm, payload_mass=1.0), "six_axis.urdf")
    assert [each.version for each in store.arms.versions("light")] == [2, 1]
    assert store.arms.newest() == [heavier]


def test_the_migrations_make_the_tables(store: Store, url: str) -> None:
    engine = sa.create_engine(url)
    with engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True, "compare_server_default": True})
        assert compare_metadata(context, Base.metadata) == []
        assert context.get_current_revision() == NEWEST_REVISION  # so that the next start has nothing to migrate
    engine.dispose()


def test_the_migrations_go_down_and_up_again(store: Store, url: str) -> None:
    with migrating(url, command.downgrade, "base") as connection:
        assert set(sa.inspect(connection).get_table_names()) == {"alembic_version"}
    with migrating(url, command.upgrade, "head") as connection:
        assert set(sa.inspect(connection).get_table_names()) == {"alembic_version", *Base.metadata.tables}
    assert store.tasks() == []


def test_tables_that_rows_refer_to_are_migrated_with_those_rows(store: Store, url: str, open_: Open) -> None:
    store.add_demonstration(demonstration("d"))
    store.add_job(a_job())
    run = store.finish_learning("learn-1", learned())
    path = store.run(run).learned.paths[0]
    with migrating(url, command.downgrade, "0008"):
        pass
    opened = open_()
    assert [row.id for row in opened.demonstrations("t")] == ["d"]
    assert encode(opened.path(path.id)) == encode(path)
    with pytest.raises(Conflict):  # and from then on a row must refer to one that is there
        opened.add_demonstration(demonstration("e", task="nowhere"))


def test_all_rows_go_down_to_the_first_tables_and_up_again(store: Store, url: str) -> None:
    store.add_demonstration(demonstration("d"))
    store.add_job(a_job())
    run = store.finish_learning("learn-1", learned())
    store.add_job(a_job("plan-1", kind="plan"))
    plan = store.finish_planning("plan-1", a_plan())
    store.put_execution("e", plan, ExecutorStatus(execution="e", activity="on the path"))

    def shown() -> list[object]:
        lists = [store.tasks(), store.demonstrations("t"), store.jobs(), store.lists.executions()]
        return [*lists, encode(store.run(run).learned), encode(store.plan(plan)), encode(store.path(f"{run}-2"))]

    before = shown()
    with migrating(url, command.downgrade, "0001"):
        pass
    with migrating(url, command.upgrade, "head"):
        pass
    assert shown() == before


def test_a_migration_renames_what_runs_and_jobs_say_of_learning(store: Store, url: str) -> None:
    store.add_job(a_job(request={"settings": {"keep": 3, "min_silhouette": 0.4}, "calibrations": {}}))
    found = replace(learned(), settings={"keep": 3, "min_silhouette": 0.4, "seed": 1})
    score = replace(found.clusters[0].scores[0], deviation=Deviation((0.2, 0.4), (1.0, 2.0), "stands still"))
    run = store.finish_learning("learn-1", replace(found, clusters=(replace(found.clusters[0], scores=(score,)),)))
    now = store.run(run).learned
    with migrating(url, command.downgrade, "0004") as connection:
        (before,) = connection.scalars(sa.select(RunTable.document))
        (request,) = connection.scalars(sa.select(JobRow.request))
    assert list(before["settings"].items()) == [("keep", 3), ("guard", 0.4), ("seed", 1)]
    assert before["clusters"][0]["scores"][0]["departure"]["sentence"] == "stands still"
    assert request == {"settings": {"keep": 3, "guard": 0.4}, "calibrations": {}}
    with migrating(url, command.upgrade, "head"):
        pass
    assert encode(store.run(run).learned) == encode(now)
    assert store.job("learn-1").request["settings"] == {"keep": 3, "min_silhouette": 0.4}


def test_a_migration_renames_what_demonstrations_say_of_their_samples(store: Store, url: str) -> None:
    statistics = StreamStatistics(received=9, outliers=2, level_shifts=1)
    now = store.add_demonstration(demonstration("d", statistics=statistics))
    with migrating(url, command.downgrade, "0006") as connection:
        (before,) = connection.scalars(sa.select(DemonstrationRow.document))
    assert "statistics" not in before
    assert [before["account"][name] for name in ("received", "jumps", "leaps")] == [9, 2, 1]
    assert decode_demonstration(json.dumps(before).encode()) == now  # so a file that was made then is read, too
    with migrating(url, command.upgrade, "head"):
        pass
    assert store.demonstration(now.id) == now


def test_a_migration_renames_what_plans_and_executions_say_of_motion(store: Store, url: str) -> None:
    store.add_job(a_job("plan-1", kind="plan"))
    plan, status = store.finish_planning("plan-1", a_plan()), ExecutorStatus(activity="on the path")
    store.put_execution("e", plan, status)
    now = store.plan(plan)
    with migrating(url, command.downgrade, "0007") as connection:
        (before,) = connection.scalars(sa.select(PlanRow.document))
        (execution,) = connection.scalars(sa.select(ExecutionTable.document))
    assert before["pace"] == now.squared_rates.tolist()
    assert "squared_rates" not in before
    assert (execution["stretch"], "activity" in execution) == ("on the path", False)
    with migrating(url, command.upgrade, "head"):
        pass
    assert store.execution("e").status == status
    assert np.array_equal(store.plan(plan).squared_rates, now.squared_rates)


# tasks and demonstrations


def test_a_task_is_made_once_however_many_ask(open_: Open) -> None:
    stores = [open_() for _ in range(3)]
    with ThreadPoolExecutor(9) as threads:
        made = list(threads.map(lambda s: s.ensure_task("t", scene="paper", calibration="identity"), stores * 5))
    assert len(set(made)) == 1
    assert stores[0].tasks() == made[:1]
    assert stores[0].ensure_task("t", scene="other", calibration="other") == made[0]


def test_numbers_have_no_gaps_however_many_write(open_: Open, store: Store) -> None:
    store.ensure_task("u", scene="paper", calibration="identity")
    stores = [store, open_(), open_()]
    together = threading.Barrier(6)

    def write(who: int) -> list[int]:
        together.wait(timeout=HANG)
        mine = [demonstration(f"d-{who}-{i}", task="tu"[who % 2]) for i in range(8)]
        return [stores[who % 3].add_demonstration(d).number for d in mine]

    with ThreadPoolExecutor(6) as threads:
        numbers = list(threads.map(write, range(6)))
    assert all(n == sorted(n) for n in numbers)
    for task in "tu":
        assert [d.number for d in store.demonstrations(task)] == list(range(1, 25))


def test_a_demonstration_that_is_refused_leaves_no_gap(store: Store) -> None:
    store.add_demonstration(demonstration("a"))
    with pytest.raises(Conflict):
        store.add_demonstration(demonstration("a"))
    with pytest.raises(Conflict):
        store.add_demonstration(demonstration("b", task="moon"))
    assert store.add_demonstration(demonstration("c")).number == 2


FINITE_FLOATS = st.floats(allow_nan=False, allow_infinity=False)
TEXT = st.text(max_size=20)
COUNT = st.integers(0, 2**62)


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
@given(
    duration=FINITE_FLOATS,
    created_ns=COUNT,
    source=TEXT,
    calibration=st.builds(
        Calibration, TEXT, FINITE_FLOATS, st.tuples(*[FINITE_FLOATS] * 4), st.tuples(*[FINITE_FLOATS] * 3)
    ),
    statistics=st.builds(StreamStatistics, COUNT, notes=st.lists(TEXT, max_size=3).map(tuple)),
)
def test_a_demonstration_survives_to_the_last_bit(store: Store, **values: object) -> None:
    key = f"d-{len(store.demonstrations('t'))}"
    stored = store.add_demonstration(demonstration(key, **values))
    assert store.demonstration(key) == stored
    assert repr(store.demonstration(key)) == repr(stored)
    assert replace(stored, number=0) == demonstration(key, **values)


# jobs


def test_jobs_come_in_their_order_and_by_their_task(store: Store) -> None:
    jobs = [a_job(f"learn-{i}", created_ns=i, task="tu"[i % 2], request={"settings": {"seed": i}}) for i in range(4)]
    for job in reversed(jobs):
        store.add_job(job)
    assert store.jobs() == jobs
    assert store.jobs(task="u") == jobs[1::2]
    store.set_job("learn-0", state="failed", message="why", finished_ns=9)
    assert store.jobs(unfinished=True) == jobs[1:]


@pytest.mark.parametrize("state", ["succeeded", "failed", "cancelled"])
def test_a_finished_job_stays_as_it_is(store: Store, state: str) -> None:
    store.add_job(a_job())
    store.set_job("learn-1", state="running", attempt=1)
    ended = store.set_job("learn-1", state=state, fraction=1 / 3, message="m", finished_ns=2)
    for change in (
        lambda: store.set_job("learn-1", state="running"),
        lambda: store.set_job("learn-1", fraction=0.5),
        lambda: store.finish_learning("learn-1", learned()),
        lambda: store.finish_planning("learn-1", a_plan()),
    ):
        with pytest.raises(Conflict, match=f"job learn-1 has already {state}"):
            change()
    assert store.job("learn-1") == ended
    assert store.lists.runs("t").entries == []
    assert store.plans("p") == []


def test_one_of_many_ends_a_job(store: Store, open_: Open) -> None:
    store.add_job(a_job())
    stores = [store, open_()]

    def end(who: int) -> bool:
        try:
            stores[who % 2].set_job("learn-1", state="cancelled", message=str(who), finished_ns=who + 1)
        except Conflict:
            return False
        return True

    with ThreadPoolExecutor(8) as threads:
        assert sum(threads.map(end, range(8))) == 1


# runs, paths and plans


def test_learning_ends_once_with_its_run_and_its_paths(store: Store) -> None:
    store.add_job(a_job())
    key = store.finish_learning("learn-1", learned())
    with pytest.raises(Conflict, match="job learn-1 has already succeeded"):
        store.finish_learning("learn-1", learned())
    run = store.newest_run("t")
    assert run is not None
    assert store.lists.runs("t").entries == [run.summary]
    assert (run.id, run.task, store.job("learn-1").outcome, store.job("learn-1").fraction) == (key, "t", key, 1.0)
    assert [p.id for p in run.learned.paths] == [f"{key}-1", f"{key}-2"]
    for path in run.learned.paths:
        assert path.run == key
        assert encode(store.path(path.id)) == encode(path)
    assert encode(store.run(key).learned) == encode(run.learned)
    assert run.learned.linkage.tobytes() == learned().linkage.tobytes()


def test_learning_that_cannot_be_stored_whole_leaves_nothing(store: Store) -> None:
    store.add_job(a_job())
    twice = replace(learned(), paths=(a_path(), a_path()))  # two paths of one cluster have one id
    with pytest.raises(Conflict):
        store.finish_learning("learn-1", twice)
    assert store.lists.runs("t").entries == []
    assert store.job("learn-1") == a_job()
    assert store.finish_learning("learn-1", learned())


def test_planning_ends_once_with_its_plan(store: Store) -> None:
    store.add_job(a_job("plan-1", kind="plan"))
    key = store.finish_planning("plan-1", a_plan())
    assert store.job("plan-1").outcome == key
    assert encode(store.plan(key)) == encode(a_plan()) == encode(store.plans("p")[0])
    store.add_job(a_job("plan-2", kind="plan"))
    with pytest.raises(Conflict):
        store.finish_planning("plan-2", a_plan())
    assert store.job("plan-2").state is JobState.QUEUED


def test_an_execution_keeps_its_newest_status(store: Store) -> None:
    store.add_job(a_job("plan-1", kind="plan"))
    plan = store.finish_planning("plan-1", a_plan())
    for i in range(3):
        store.put_execution(f"e{i}", plan, ExecutorStatus(execution=f"e{i}", state=ExecutorState.STARTING))
    running = ExecutorStatus(execution="e0", state=ExecutorState.FOLLOWING, progress=1 / 3, lateness_p99_us=0.1)
    store.put_execution("e0", plan, running)
    assert store.execution("e0").status == running
    assert [e.id for e in store.lists.executions().entries] == ["e2", "e1", "e0"]


@pytest.mark.parametrize("what", ["task", "demonstration", "run", "path", "plan", "job", "execution"])
@pytest.mark.parametrize("key", ["moon", "", "x" * 100, "'; --", "\0", "…"])
def test_what_is_not_there_is_named(store: Store, what: str, key: str) -> None:
    with pytest.raises(NotFound) as caught:
        getattr(store, what)(key)
    assert str(caught.value) == f"there is no {what} {key!r}"


def test_changes_to_what_is_not_there_are_refused(store: Store) -> None:
    for change in (
        lambda: store.set_job("moon", fraction=0.5),
        lambda: store.finish_learning("moon", learned()),
        lambda: store.finish_planning("moon", a_plan()),
    ):
        with pytest.raises(NotFound, match="there is no job 'moon'"):
            change()
    assert store.plans("p") == []


def test_a_store_opened_again_shows_the_same(store: Store, open_: Open) -> None:
    store.add_demonstration(demonstration("d"))
    store.add_job(a_job())
    run = store.finish_learning("learn-1", learned())
    store.add_job(a_job("plan-1", kind="plan"))
    plan = store.finish_planning("plan-1", a_plan())
    store.put_execution("e", plan, ExecutorStatus(execution="e"))

    def shown(store: Store) -> list[object]:
        lists = [
            store.tasks(),
            store.demonstrations("t"),
            store.jobs(),
            store.lists.executions(),
            store.lists.runs("t"),
        ]
        return [*lists, encode(store.run(run).learned), encode(store.plan(plan)), encode(store.path(f"{run}-2"))]

    before = shown(store)
    store.close()
    assert shown(open_()) == before
