"""A stop over the bus: for whoever finds a web service that does not answer, on real sockets."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from teachpath.commands.stopping import stop_arm
from teachpath.io import wire
from teachpath.io.bus import Bus, BusSettings, listen_on_bus
from teachpath.io.running_services import announced
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Command, ExecutorStatus
from teachpath_client import Link
from teachpath_client.bus_stop import stop_over_bus
from teachpath_client.errors import NotStopped
from teachpath_proto.control import ExecutorState
from teachpath_proto.keys import Keys
from tests.ports import free_endpoint
from tests.system.processes import confirmed

KEYS = Keys("stopped/here")
EXECUTION = "execution-0123456789ab"
FOLLOWING_STATUS = ExecutorStatus(EXECUTION, ExecutorState.FOLLOWING)
ENDING = ExecutorStatus(EXECUTION, ExecutorState.STOPPING, ending=True)


@pytest.fixture
def station(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Bus, str, str]]:
    """Bus, endpoint and address of a service of this user that takes connections to its web port, and answers none."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    endpoint = free_endpoint()
    bus = listen_on_bus(BusSettings(endpoint=endpoint))
    with socket.create_server(("127.0.0.1", 0)) as silent:
        url = f"http://127.0.0.1:{silent.getsockname()[1]}"
        with announced(url, endpoint, KEYS.prefix):
            yield bus, endpoint, url
    bus.close()


@contextmanager
def executor(bus: Bus, *statuses: ExecutorStatus) -> Iterator[list[Command]]:
    """An executor that publishes the first status, and the second one once a stop came; yields what came."""
    stops: list[Command] = []

    def receive(_: str, payload: bytes) -> None:
        stops.append(wire.decode_command(payload))

    def publish() -> None:
        bus.publish(KEYS.executor_status, wire.encode_status(statuses[bool(stops)]))

    handle = bus.subscribe(KEYS.executor_stop, receive)
    thread = PeriodicThread("executor", 0.02, publish)
    thread.start()
    try:
        yield stops
    finally:
        thread.stop()
        handle.close()


def test_a_service_that_does_not_answer_is_passed_by(station: tuple[Bus, str, str]) -> None:
    bus, _, url = station
    for named in (EXECUTION, EXECUTION[:-4], ""):  # without the service nobody looks up the beginning of an id
        with executor(bus, FOLLOWING_STATUS, ENDING) as stops:
            assert confirmed(lambda named=named: stop_arm(url, named)).ending
        assert {(stop.execution, stop.who) for stop in stops} == {(EXECUTION * (named == EXECUTION), "teachpath stop")}


def test_what_the_executor_does_not_show_is_not_stopped_by_neither_way(station: tuple[Bus, str, str]) -> None:
    bus, _, url = station
    with (
        executor(bus, FOLLOWING_STATUS, FOLLOWING_STATUS),
        pytest.raises(NotStopped, match="nor does the executor confirm"),
    ):
        stop_arm(url, EXECUTION)
    with pytest.raises(NotStopped, match="no service of yours on this machine"):
        stop_arm("http://127.0.0.1:9", EXECUTION)


def test_the_client_stops_over_the_bus_and_says_so_by_the_status_alone(station: tuple[Bus, str, str]) -> None:
    bus, endpoint, _ = station
    for last in (ENDING, ExecutorStatus(), ExecutorStatus("another", ExecutorState.FOLLOWING)):
        with (
            Link(endpoint) as link,
            executor(bus, FOLLOWING_STATUS, last) as stops,
        ):  # whose session hears nothing from before
            found = confirmed(lambda link=link: stop_over_bus(link, EXECUTION, prefix=KEYS.prefix, who="Ada"))
        assert found.execution == last.execution
        assert {(stop.execution, stop.who) for stop in stops} == {(EXECUTION, "Ada")}
    with Link(endpoint) as link, pytest.raises(NotStopped, match="press the emergency stop"):  # nobody confirms it
        stop_over_bus(link, prefix=KEYS.prefix, timeout=0.2)
