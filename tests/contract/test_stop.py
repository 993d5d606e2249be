"""A stop over REST, the typed client and the command line: said to be done when the executor's status shows it."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import Unanswered
from teachpath.io import wire
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Command, ExecutorStatus
from teachpath_client import Station
from teachpath_client.errors import NotStopped, Refused
from teachpath_proto.control import ExecutorState
from tests.contract.desk import Desk, refused
from tests.contract.test_rest_work import planned
from tests.waiting import wait_until

MOVING_EXECUTION = "execution-moving"


@pytest.fixture
def url(port: int) -> str:
    return f"http://127.0.0.1:{port}"


@pytest.fixture
def moving(desk: Desk) -> str:
    """An execution that moves the arm, as far as the service knows."""
    desk.station.store.put_execution(MOVING_EXECUTION, None, ExecutorStatus(MOVING_EXECUTION, ExecutorState.FOLLOWING))
    return MOVING_EXECUTION


@contextmanager
def executor(desk: Desk, *statuses: ExecutorStatus) -> Iterator[list[Command]]:
    """An executor that publishes the first status, and the second one once a stop was put; yields what was put."""
    bus, keys = desk.station.bus, desk.station.keys
    puts: list[Command] = []
    is_stopped = threading.Event()

    def receive(_: str, payload: bytes) -> None:
        puts.append(wire.decode_command(payload))
        is_stopped.set()

    def publish() -> None:
        bus.publish(keys.executor_status, wire.encode_status(statuses[is_stopped.is_set()]))

    handle = bus.subscribe(keys.executor_stop, receive)
    thread = PeriodicThread("executor", 0.02, publish)
    thread.start()
    try:
        yield puts
    finally:
        thread.stop()
        handle.close()


FOLLOWING_STATUS = ExecutorStatus(MOVING_EXECUTION, ExecutorState.FOLLOWING)
ENDING = ExecutorStatus(MOVING_EXECUTION, ExecutorState.STOPPING, ending=True)
STOPPING_STATUS = ExecutorStatus(MOVING_EXECUTION, ExecutorState.STOPPING)


def test_a_stop_is_put_and_answered_by_the_status_that_shows_it(desk: Desk, moving: str) -> None:
    with executor(desk, FOLLOWING_STATUS, ENDING) as puts:
        answer = desk.post(f"/executions/{moving}/stop", headers={"Teachpath-Operator": "Ada"})
    assert answer.json()["status"] == {**answer.json()["status"], "state": "stopping", "ending": True}
    assert {(put.execution, put.who) for put in puts} == {(moving, "Ada")}
    # Its confirmation may have come while it was repeated.
    wait_until(lambda: "stop" not in {thread.name for thread in threading.enumerate()}, "nobody repeats that stop")
    with executor(desk, FOLLOWING_STATUS, ENDING) as puts:
        assert desk.post("/stop").json()["ending"]
    assert {put.execution for put in puts} == {""}


def test_an_arm_that_only_comes_to_hold_is_not_said_to_be_stopped(desk: Desk, moving: str) -> None:
    with executor(desk, FOLLOWING_STATUS, STOPPING_STATUS) as puts:
        refused(desk.post(f"/executions/{moving}/stop"), 503, "NOT STOPPED")
        assert len(puts) > 1
        assert desk.post("/stop").json()["error"] == "NotStopped"


def test_an_execution_that_the_executor_does_not_know_any_more_is_over(desk: Desk, moving: str) -> None:
    with executor(desk, ExecutorStatus(), ExecutorStatus()):
        status = desk.post(f"/executions/{moving}/stop").json()["status"]
    assert (status["state"], status["reason"]) == ("faulted", "the executor does not run it any more")


def test_the_client_says_so_only_then(desk: Desk, url: str, moving: str) -> None:
    with Station(url) as station:
        with executor(desk, FOLLOWING_STATUS, ENDING):
            assert station.stop(moving).status.ending
            assert station.stop_arm().ending
        with executor(desk, FOLLOWING_STATUS, STOPPING_STATUS):
            for stop in (lambda: station.stop(moving), station.stop_arm):
                with pytest.raises(NotStopped, match="press the emergency stop of the arm"):
                    stop()
        with pytest.raises(Refused, match="no execution 'moon'"):
            station.stop("moon")
    with Station("http://127.0.0.1:9") as nobody, pytest.raises(NotStopped, match="NOT STOPPED: no station"):
        nobody.stop_arm()


def test_the_command_line_says_so_only_then(desk: Desk, url: str, moving: str) -> None:
    def said(*words: str) -> str:
        return CliRunner().invoke(app, ["stop", *words, "--url", url], catch_exceptions=False).stdout

    with executor(desk, FOLLOWING_STATUS, ENDING):
        assert said() == said(moving) == f"stopped: {moving} comes to rest on its path\n"
    with executor(desk, ExecutorStatus(), ExecutorStatus()):
        assert said() == "stopped: nothing moves the arm\n"
    with executor(desk, FOLLOWING_STATUS, STOPPING_STATUS), pytest.raises(NotStopped):  # which ends with exit status 1
        said()


def test_a_start_that_is_not_answered_in_time_is_stopped_should_it_begin_later(desk: Desk) -> None:
    def answer(_: bytes) -> bytes:
        raise Unanswered("the executor was not there in time")

    idle = ExecutorStatus()
    handle = desk.station.bus.serve(desk.station.keys.executor_command, answer)
    with executor(desk, idle, idle) as puts:
        wait_until(lambda: not desk.station.executions.is_moving(), "nothing is under way")
        refused(desk.post("/executions", {"plan": planned(desk.station, "plan-late")}), 503, "not there in time")
        newest = desk.get("/executions").json()[0]
        wait_until(lambda: newest["id"] in [command.execution for command in puts], "it is stopped")
    handle.close()
    assert newest["status"]["state"] == "faulted"


def test_an_order_to_an_executor_that_got_no_turn_for_a_while_is_answered_by_it(desk: Desk, moving: str) -> None:
    heard: list[Command] = []
    plan = planned(desk.station, "plan-revoked-while-silent")

    def answer(payload: bytes) -> bytes:
        heard.append(wire.decode_command(payload))
        return wire.encode_status(FOLLOWING_STATUS)

    wait_until(lambda: desk.station.executions.status is None, "the executor is silent")
    handle = desk.station.bus.serve(desk.station.keys.executor_command, answer)
    assert desk.post(f"/executions/{moving}/hold").is_success
    assert desk.post(f"/plans/{plan}/revoke", {"reason": "the table was moved"}).is_success
    handle.close()
    assert [(command.verb, command.plan_id) for command in heard] == [("hold", ""), ("revoke", plan)]
    refused(desk.post(f"/executions/{moving}/hold"), 503, "nobody answered")
