"""The typed client at a real station: every resource it reads, what it waits for, and what it raises."""

import threading
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import pytest

from teachpath_client import Station
from teachpath_client.errors import ExecutionFaulted, JobFailed, NotInTime, Refused, Unreachable
from teachpath_client.models import Execution, ExecutorStatus, Job
from tests.contract.desk import Desk, csv
from tests.contract.test_rest_work import planned


@pytest.fixture(scope="module")
def station(port: int) -> Iterator[Station]:
    with Station(f"http://127.0.0.1:{port}", operator="Ada") as station:
        yield station


@pytest.fixture(scope="module")
def shown(station: Station) -> str:
    """A task with three demonstrations."""
    for step in (0.002, 0.0021, 0.0022):
        station.import_file("client", csv(120, step=step).encode(), name="mine.csv")
    return "client"


def test_tasks_and_what_was_shown_are_read_and_changed(station: Station, shown: str) -> None:
    assert shown in [task.name for task in station.tasks()]
    assert station.make_task(shown) == station.get_task(shown)
    first, *_ = station.demonstrations(shown)
    assert (first.source, first.verdict, first.statistics.lost) == ("mine.csv", "clean", 0)
    assert station.amend(first.id, mark="bad").mark == "bad"
    assert station.amend(first.id, mark="", trim=(1, 100)).trim == (1, 100)
    assert station.amend(first.id, trim=(0, 0)) == first
    assert len(station.trajectory(first.id, most=10).positions) == 10
    assert station.recorded_demonstration(first.id).startswith(b"\x89MCAP0\r\n")
    assert [d.id for d in station.recalibrate(shown)] == [d.id for d in station.demonstrations(shown)]


def test_a_recording_is_started_and_stopped(station: Station) -> None:
    station.make_task("client-recording")
    assert station.start_recording("client-recording", "glove-c", armed=True).state == "paused"
    assert [report.tracker for report in station.recordings("client-recording")] == ["glove-c"]
    assert station.stop_recording("client-recording", "glove-c").received == 0


def test_the_station_describes_itself(station: Station) -> None:
    assert station.health().executor is None
    assert [scene.name for scene in station.scenes()] == ["paper", "empty"]
    assert len(station.robot().links) == 6
    measured = station.measure_calibration(
        "client", [((x, y, 0.0), (x + 0.1, y, 0.0)) for x, y in ((0, 0), (1, 0), (0, 1))], keep=False
    )
    assert measured.calibration.offset == pytest.approx((0.1, 0.0, 0.0))
    with pytest.raises(Refused, match="there is no tracker 'ghost' now"):
        station.touch("ghost")


def test_a_task_is_learned_and_its_outcome_is_read(station: Station, shown: str) -> None:
    seen: list[Job] = []
    run = station.learn(shown, {"seed": 2}, on_change=seen.append)
    assert run.learned.settings["seed"] == 2
    assert (seen[-1].state, seen[-1].outcome) == ("succeeded", run.id)
    assert seen == sorted(seen, key=lambda job: job.fraction)
    assert [found.id for found in station.runs(shown)] == [run.id]
    assert station.newest_run(shown) == run
    assert station.get_run(shown, run.id) == run
    assert len(station.dendrogram(shown, run.id).leaves) == 3
    (path,) = run.learned.paths
    assert station.get_path(path.id) == path
    lifted = [[x, y, z + 0.01] for x, y, z in path.curve.control_points]
    curve = asdict(path.curve) | {"control_points": lifted}
    assert station.save_version(path.id, curve, base=1, author="Ada").number == 2
    assert [version.author for version in station.versions(path.id)] == ["", "Ada"]
    assert station.get_version(path.id, 2).path.curve.control_points == lifted
    assert station.difference(path.id, 1, 2).largest == pytest.approx(0.01)
    assert station.plans(path.id) == []


def test_work_that_fails_raises_with_its_job(station: Station) -> None:
    station.make_task("client-empty")
    with pytest.raises(JobFailed, match="learn failed: task client-empty has no usable demonstrations") as failed:
        station.learn("client-empty")
    assert station.jobs("client-empty") == [failed.value.job]
    with pytest.raises(Refused, match="has already failed"):
        station.cancel(failed.value.job.id)


def test_a_path_that_the_arm_cannot_follow_raises_with_its_failure(station: Station) -> None:
    content = csv(120, step=0.007).encode()  # to x = 1.2 m
    station.import_file("client-far", content, scene="empty")
    run = station.learn("client-far")
    with pytest.raises(JobFailed) as failed:
        station.plan(run.learned.paths[0].id)
    failure = failed.value.job.failure
    assert failure is not None
    assert failure.fault == "reach"
    assert failure.suggestion.sentence in str(failed.value)


def test_what_is_refused_raises_with_status_and_record(station: Station) -> None:
    with pytest.raises(Refused, match="there is no task 'moon'") as refused:
        station.get_task("moon")
    assert (refused.value.status, refused.value.refusal.error) == (404, "NotFound")
    with pytest.raises(Refused, match="did you mean override") as refused:
        station.call("POST", "/executions", {"plan": "p", "overide": 0.2})
    assert [fault.place for fault in refused.value.refusal.errors] == ["body.overide"]


def test_an_execution_is_begun_and_read(desk: Desk, station: Station) -> None:
    plan = planned(desk.station, "plan-client")
    assert station.get_plan(plan).id == plan
    for begin in (station.run, station.begin_execution):
        with pytest.raises(Refused, match="nobody answered") as refused:
            begin(plan)
        assert refused.value.status == 503
    newest = station.executions(limit=1)[0]
    assert (newest.plan, newest.status.state) == (plan, "faulted")
    assert station.get_execution(newest.id) == station.stop(newest.id) == newest
    assert station.wait(newest) == newest
    with pytest.raises(Refused, match="is not running"):
        station.steer(newest.id, "hold")
    assert station.journal(limit=1000) == [entry for entry in station.journal(limit=1000) if entry.who or entry.verb]


def test_waiting_ends_in_time_and_what_is_awaited_goes_on(desk: Desk, station: Station) -> None:
    unended = Execution("execution-none", None, 1, ExecutorStatus(state="following"))
    with pytest.raises(Refused, match="no execution 'execution-none'"):
        station.wait(unended)
    with pytest.raises(NotInTime, match="has not ended within 0 s; it goes on"):
        station.wait(unended, timeout=0.0)


def test_an_arm_that_stops_by_itself_raises_with_its_execution() -> None:
    faulted = Execution("execution-1", "plan-1", 1, ExecutorStatus(state="faulted", reason="a limit was passed"))
    assert str(ExecutionFaulted(faulted)) == "the execution faulted: a limit was passed"


def test_events_are_told(station: Station) -> None:
    with station.events() as events:
        first = events.next(60.0)
        assert first is not None
        assert (first.topic, first.reason) == ("all", "connected")
        threading.Timer(0.1, station.make_task, ["client-told"]).start()
        assert next(event.id for event in events if event.topic == "tasks") == "client-told"
        while events.next(0.05) is not None:
            pass


def test_no_station_is_a_sentence_with_the_way_out() -> None:
    with Station("http://127.0.0.1:9") as nobody:
        asked: list[Any] = [nobody.health, nobody.events().__enter__]
        for ask in asked:
            with pytest.raises(Unreachable, match="start it with: teachpath serve"):
                ask()
