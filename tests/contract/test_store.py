"""The store: the laws that every database behind it keeps."""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from teachpath.errors import Conflict, NotFound
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.io.documents import encode
from teachpath.io.store.store import Store
from teachpath.records import (
    Calibration,
    ExecutorStatus,
    JobState,
    StreamStatistics,
)
from teachpath_proto.control import ExecutorState
from tests.contract.rows import a_job, demonstration, learned
from tests.contract.stores import Open
from tests.unit.io.test_documents import a_path, a_plan
from tests.waiting import HANG

# tokens


# people


# the tables


def test_an_arm_is_stored_as_it_is_and_only_once(store: Store) -> None:
    arm = read_arm(EXAMPLES["six-axis"], name="light")
    stored = store.arms.add(arm, "six_axis.urdf")
    assert store.arms.add(arm, "six_axis.urdf") == stored
    assert store.arms.versions("light") == [stored]
    assert stored.arm.hash == store.arms.newest()[0].arm.hash == arm.hash
    heavier = store.arms.add(replace(arm, payload_mass=1.0), "six_axis.urdf")
    assert [each.version for each in store.arms.versions("light")] == [2, 1]
    assert store.arms.newest() == [heavier]


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
