"""The events' WebSocket: what is told of every kind of change, to whom, and who is refused."""

import json
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import httpx
import pytest
from pydantic import TypeAdapter
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from teachpath.api.live_messages import ChangeEvent
from teachpath.app import Station
from teachpath.commands.serving import listen
from teachpath.records import ExecutorStatus
from teachpath.web.server import web_server
from teachpath_proto.control import ExecutorState
from tests.contract.desk import csv
from tests.contract.stations import station
from tests.ports import free_port
from tests.waiting import HANG


class Served:
    """A station of this process on a real port."""

    def __init__(self, opened: Station) -> None:
        self.station = opened
        self.address = f"127.0.0.1:{free_port()}"
        self.server = web_server(opened.web, opened.settings.web)
        listener = listen("127.0.0.1", int(self.address.split(":")[1]))
        self.thread = threading.Thread(target=self.server.run, kwargs={"sockets": [listener]}, daemon=True)
        self.thread.start()
        while not self.server.started:
            time.sleep(0.01)

    def listen(self, **options: Any) -> ClientConnection:
        return connect(f"ws://{self.address}/api/v1/events", **options)

    def call(self, method: str, resource: str, **options: Any) -> httpx.Response:
        address = f"http://{self.address}/api/v1{resource}"
        return httpx.request(method, address, timeout=HANG, trust_env=False, **options)


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with station() as opened:
        served = Served(opened)
        yield served
        served.server.should_exit = True
        served.thread.join(HANG)


def until(socket: ClientConnection, topic: str, key: str = "") -> dict[str, Any]:
    """Return the first piece of a topic, and id when one is given."""
    while True:
        piece: dict[str, Any] = json.loads(socket.recv(timeout=HANG))
        if piece["topic"] == topic and key in ("", piece["id"]):
            return piece


def test_a_listener_is_first_told_to_read_everything(served: Served) -> None:
    with served.listen() as socket:
        first = json.loads(socket.recv(timeout=HANG))
    assert (first["topic"], first["id"], first["reason"]) == ("all", "", "connected")


def test_every_kind_of_change_is_told_to_all_who_listen(served: Served) -> None:
    with served.listen() as one, served.listen() as other:
        served.call("PUT", "/tasks/told", json={"scene": "empty"})
        assert until(one, "tasks", "told")["sequence"] == until(other, "tasks", "told")["sequence"]
        served.call("POST", "/tasks/told/demonstrations", content=csv(120, step=0.002))
        made = until(one, "demonstrations")["id"]
        served.call("PATCH", f"/demonstrations/{made}", json={"mark": "bad"})
        until(one, "demonstrations", made)
        served.call("PATCH", f"/demonstrations/{made}", json={"mark": ""})
        job = served.call("POST", "/tasks/told/jobs", json={"kind": "learn"}).json()
        until(one, "jobs", job["id"])
        run = until(one, "runs")["id"]
        assert until(one, "paths")["id"].startswith(run)
        assert served.call("GET", f"/jobs/{job['id']}").json()["state"] == "succeeded"
        while (told := until(other, "jobs", job["id"])["status"])["state"] in ("queued", "running"):
            pass
        assert (told["task"], told["kind"], told["state"]) == ("told", "learn", "succeeded")
        assert told["outcome"] == run


def test_an_execution_is_told_with_how_it_stands(served: Served) -> None:
    with served.listen() as socket:
        status = ExecutorStatus("execution-told", ExecutorState.HELD, "the clutch was let go")
        served.station.store.put_execution("execution-told", None, status)
        event = until(socket, "executions", "execution-told")
    TypeAdapter(ChangeEvent).validate_python(event, extra="forbid")
    assert event["status"] == {"plan": None, "state": "held", "reason": "the clutch was let go"}


def test_a_change_that_was_refused_is_not_told(served: Served) -> None:
    with served.listen() as socket:
        served.call("PUT", "/tasks/no..name", json={})
        served.call("PUT", "/tasks/after", json={})
        pieces = [json.loads(socket.recv(timeout=HANG)) for _ in range(2)]
        while pieces[-1]["id"] != "after":
            pieces.append(json.loads(socket.recv(timeout=HANG)))
    assert not [piece for piece in pieces if piece["id"] == "no..name"]


@pytest.mark.parametrize("origin", ["http://elsewhere.example", "null"])
def test_a_foreign_page_is_refused(served: Served, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused:
        served.listen(origin=origin)
    assert refused.value.response.status_code == 403
    with served.listen(origin=f"http://{served.address}") as own:
        assert own.recv(timeout=HANG)


def test_whoever_talks_back_is_closed_with_a_sentence(served: Served) -> None:
    with served.listen() as socket:
        socket.send("stop the arm")
        while socket.close_code is None:
            with suppress(ConnectionClosed):
                socket.recv(timeout=HANG)
        assert socket.close_code == 1008
        assert "give orders over REST" in (socket.close_reason or "")
