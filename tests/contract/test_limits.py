"""What one subject may ask of a station at a time: the next is told to wait, others are not, and a stop never is."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import ClientConnection, connect

from teachpath.access.settings import LimitSettings
from teachpath.records import Capability
from tests.contract.desk import csv, refused
from tests.contract.guarded import Guarded, opened
from tests.waiting import wait_until

PAGE = Path(__file__).parents[2] / "clients" / "web"
BURST = 12
SELDOM_RATE = 1e-6  # [1/s]: none is given back while a test runs
FILES = 1500  # bytes of files that may wait: one of those that are sent, not two


@pytest.fixture(scope="module")
def hurried() -> Iterator[Guarded]:
    with opened(request_rate=SELDOM_RATE, request_burst=BURST) as guarded:
        yield guarded


@pytest.fixture(scope="module")
def narrow() -> Iterator[Guarded]:
    with opened(max_websockets=2, waiting_size=FILES) as guarded:
        yield guarded


def ask(
    guarded: Guarded, resource: str, token: str = "", *, address: str = "127.0.0.1", method: str = "GET", **headers: str
) -> httpx.Response:
    """Send a request from an address."""
    if token:
        headers["Authorization"] = f"Bearer {token}"

    async def send() -> httpx.Response:
        transport = httpx.ASGITransport(guarded.station.web, client=(address, 51234))
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8765/api/v1") as client:
            return await client.request(method, resource, headers=headers)

    return asyncio.run(send())


def use_up(guarded: Guarded, token: str = "", address: str = "127.0.0.1") -> httpx.Response:
    """Ask until it is refused; return the refusal."""
    for _ in range(BURST + 1):
        if (answer := ask(guarded, "/identity", token, address=address)).status_code != 200:
            return answer
    raise AssertionError("nothing was refused")


def test_whoever_asks_too_often_is_told_when_to_go_on(hurried: Guarded) -> None:
    answer = use_up(hurried, hurried.make("busy", Capability.VIEW))
    refused(answer, 429, f"busy has sent over {BURST} requests at once")
    assert answer.json()["error"] == "TooManyRequests"
    assert 1 <= int(answer.headers["retry-after"]) <= 1 / SELDOM_RATE


def test_another_subject_does_not_wait_for_it(hurried: Guarded) -> None:
    use_up(hurried, hurried.make("greedy", Capability.VIEW))
    assert ask(hurried, "/tasks", hurried.make("patient", Capability.VIEW)).status_code == 200
    refused(ask(hurried, "/tasks", address="192.168.7.8"), 401, "send a token")


def test_a_subject_is_the_same_whatever_it_calls_itself_and_wherever_it_comes_from(hurried: Guarded) -> None:
    token = hurried.make("masked", Capability.VIEW)
    use_up(hurried, token)
    for mask in ({"Teachpath-Operator": "anna"}, {"X-Forwarded-For": "10.0.0.1"}, {"X-Forwarded-User": "anna"}):
        assert ask(hurried, "/tasks", token, address="10.0.0.9", **mask).status_code == 429


def test_unknown_tokens_count_for_the_address_that_sends_them(hurried: Guarded) -> None:
    answers = [ask(hurried, "/tasks", f"x{number}", address="192.168.7.9") for number in range(BURST + 1)]
    assert {answer.status_code for answer in answers[:-1]} == {401}
    refused(answers[-1], 429, "address 192.168.7.9 has sent over")


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("stop", ["/stop", "/executions/moon/stop"])
def test_a_stop_is_never_limited(hurried: Guarded, stop: str, known: bool) -> None:
    name = stop.strip("/").replace("/", "-")
    token, address = (hurried.make(name, Capability.VIEW), "127.0.0.1") if known else ("", f"10.7.0.{len(name)}")
    first = ask(hurried, stop, token, address=address, method="POST").status_code
    use_up(hurried, token, address)
    for _ in range(2):
        assert ask(hurried, stop, token, address=address, method="POST").status_code == first != 429


def websocket(guarded: Guarded, role: Capability) -> ClientConnection:
    return connect(f"ws://127.0.0.1:{guarded.port}/api/v1/events", additional_headers=guarded.headers(role))


def test_a_websocket_too_many_waits_until_one_has_ended(narrow: Guarded) -> None:
    with websocket(narrow, Capability.VIEW):
        with websocket(narrow, Capability.VIEW):
            with pytest.raises(InvalidStatus) as found, websocket(narrow, Capability.VIEW):
                pass
            response = found.value.response
            assert (response.status_code, response.headers["Retry-After"]) == (429, "1")
            assert b"2 WebSockets of view are open" in response.body
            assert narrow.desk.get("/tasks", headers=narrow.headers(Capability.VIEW)).status_code == 200
            with websocket(narrow, Capability.TEACH):
                pass

        def opens() -> bool:
            try:
                with websocket(narrow, Capability.VIEW):
                    return True
            except InvalidStatus:
                return False

        wait_until(opens, "one that has ended counts no longer")


def test_files_that_wait_are_limited_by_subject(narrow: Guarded) -> None:
    def send(role: Capability) -> httpx.Response:
        return narrow.desk.post("/uploads", json=None, content=csv(80), headers=narrow.headers(role))

    assert len(csv(80)) > FILES
    sent = send(Capability.TEACH)
    assert sent.status_code == 201
    refusal = send(Capability.TEACH)
    refused(refusal, 429, "of files of teach wait to be imported")
    assert int(refusal.headers["retry-after"]) >= 1
    assert send(Capability.DEMONSTRATE).status_code == 201
    narrow.desk.send("DELETE", f"/api/v1/uploads/{sent.json()['id']}", headers=narrow.headers(Capability.TEACH))
    assert send(Capability.TEACH).status_code == 201


def test_ten_tabs_that_load_the_page_at_once_are_within_the_defaults() -> None:
    files = sum(file.is_file() for file in PAGE.rglob("*"))
    assert files > 50
    assert 10 * files < LimitSettings().request_burst
