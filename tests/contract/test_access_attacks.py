"""Attacks on who may do what, each of them refused."""

import json
import socket
import time
from collections.abc import Iterator
from contextlib import suppress

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from teachpath.access.access import REFUSED_SUBJECT
from teachpath.access.tokens import digest_of
from teachpath.api.access import signed
from teachpath.errors import Conflict
from teachpath.io.wire import decode_lease_request, encode_lease, encode_sample
from teachpath.records import Capability, Lease, LeaseRequest
from teachpath_proto.keys import is_name
from tests.contract.desk import refused
from tests.contract.guarded import Guarded, opened
from tests.contract.test_versions import CURVE
from tests.unit.recording.hands import sample
from tests.waiting import HANG, wait_until


@pytest.fixture(scope="module")
def guarded() -> Iterator[Guarded]:
    with opened() as guarded:
        yield guarded


# tokens that are none


@pytest.mark.parametrize(
    ("header", "sentence"),
    [
        ("Bearer", "should be: Bearer TOKEN"),
        ("Bearer ", "should be: Bearer TOKEN"),
        ("Basic b3BlcmF0ZTpvcGVyYXRl", "should be: Bearer TOKEN"),
        ("Bearer  {operate}", "not known here"),
        ("Bearer {operate} ", "not known here"),
        ("Bearer {operate}x", "not known here"),
        ("Bearer {OPERATE}", "not known here"),
        ("Bearer {digest}", "not known here"),
        ("Bearer {operate},Bearer {operate}", "not known here"),
        ("Bearer " + "x" * 200, "should be: Bearer TOKEN"),
        ("bearer {operate}", "WORKS"),
        ("Bearer \xff\xfe", "not known here"),
        ("Bearer null", "not known here"),
    ],
)
def test_a_header_that_is_not_quite_right(guarded: Guarded, header: str, sentence: str) -> None:
    token = guarded.tokens[Capability.OPERATE]
    for word, value in (("operate", token), ("OPERATE", token.upper()), ("digest", digest_of(token))):
        header = header.replace("{" + word + "}", value)
    answer = guarded.desk.get("/tasks", headers={"Authorization": header.encode("latin-1")})
    if sentence == "WORKS":
        assert answer.status_code == 200
    else:
        refused(answer, 401, sentence)


def test_two_headers_are_no_choice(guarded: Guarded) -> None:
    both = [("Authorization", f"Bearer {guarded.tokens[role]}") for role in (Capability.VIEW, Capability.ADMINISTER)]
    for headers in (both, both[::-1]):
        refused(guarded.desk.get("/tokens", headers=headers), 401, "once, should be")


def test_a_token_in_the_address_opens_nothing_and_is_not_repeated(guarded: Guarded) -> None:
    token = guarded.tokens[Capability.ADMINISTER]
    for name in ("token", "access_token", "authorization", "api_key"):
        answer = guarded.desk.get("/tasks", params={name: token})
        assert answer.status_code in (401, 422)
        assert token not in answer.text
        with pytest.raises(InvalidStatus):
            connect(f"ws://127.0.0.1:{guarded.port}/api/v1/events?{name}={token}")
    refused(guarded.desk.send("GET", f"http://{token}@127.0.0.1:8765/api/v1/tasks", auth=("", token)), 401, "Bearer")


def test_a_token_in_a_cookie_or_a_body_opens_nothing(guarded: Guarded) -> None:
    token = guarded.tokens[Capability.ADMINISTER]
    cookie = {"Cookie": f"token={token}; session={token}; __Host-session={token}"}
    refused(guarded.desk.get("/tasks", headers=cookie), 401, "Bearer TOKEN")
    assert guarded.desk.post("/tokens", {"name": "x", "roles": ["administer"], "token": token}).status_code == 401


def test_what_is_stored_opens_nothing(guarded: Guarded) -> None:
    folder = guarded.desk.data_dir
    stored = b"".join(file.read_bytes() for file in folder.rglob("*") if file.is_file())
    for token in guarded.tokens.values():
        assert token.encode() not in stored
        assert digest_of(token).encode() in stored


def test_a_program_that_may_look_gives_itself_no_more(guarded: Guarded) -> None:
    viewer = guarded.headers(Capability.VIEW)
    for more in ({"X-Role": "administer"}, {"Teachpath-Operator": "administer"}, {"X-HTTP-Method-Override": "GET"}):
        refused(
            guarded.desk.post("/tokens", {"name": "x", "roles": ["administer"]}, headers=viewer | more), 403, "view"
        )


@pytest.mark.parametrize(
    "address",
    [
        "/api/v1//tasks",
        "/api/v1/./tasks",
        "/API/V1/TASKS",
        "/api/v1/tasks/",
        "/web/..%2fapi/v1/tasks",
        "/api/v1/stop/../tasks",
        "/api/v1/tasks%00",
        "//api/v1/tasks",
    ],
)
def test_no_other_spelling_of_an_address_is_open(guarded: Guarded, address: str) -> None:
    with socket.create_connection(("127.0.0.1", guarded.port), timeout=HANG) as raw:
        raw.sendall(f"GET {address} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n".encode())
        status = int(raw.makefile("rb").readline().split()[1])
    assert status in (307, 400, 401, 404)


def test_a_smuggled_second_request_is_judged_by_itself(guarded: Guarded) -> None:
    token = guarded.tokens[Capability.VIEW]
    inner = "GET /api/v1/tasks HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
    head = f"POST /api/v1/stop HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer {token}\r\n"
    with socket.create_connection(("127.0.0.1", guarded.port), timeout=HANG) as raw:
        raw.sendall(f"{head}Content-Length: 0\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n{inner}".encode())
        answers = raw.makefile("rb").read()
    assert b"HTTP/1.1 200" not in answers


# tokens that hold no longer


def test_a_websocket_ends_with_its_token(guarded: Guarded) -> None:
    token = guarded.make("short-lived", Capability.DEMONSTRATE)
    headers = {"Authorization": f"Bearer {token}"}
    base = f"ws://127.0.0.1:{guarded.port}/api/v1"
    with (
        connect(f"{base}/events", additional_headers=headers) as events,
        connect(f"{base}/joints", additional_headers=headers) as joints,
        connect(f"{base}/trackers/revoked/samples", additional_headers=headers) as tracker,
        connect(f"{base}/events", additional_headers=guarded.headers(Capability.VIEW)) as other,
    ):
        tracker.send(json.dumps({"ping": 1}))
        assert json.loads(tracker.recv(HANG))["pong"] == 1
        guarded.station.store.access_tokens.revoke("short-lived", time.time_ns())
        guarded.station.access.refresh()
        for ended in (events, joints, tracker):
            with suppress(ConnectionClosed):
                for _ in ended:
                    pass
            assert ended.close_code == 1008
            assert "holds no longer" in (ended.close_reason or "")
        assert other.recv(HANG)
        other.ping().wait(HANG)
    with pytest.raises(InvalidStatus):
        connect(f"{base}/events", additional_headers=headers)


def test_a_tracker_that_hears_of_no_end_moves_nothing_any_more(guarded: Guarded) -> None:
    token = guarded.make("deaf", Capability.DEMONSTRATE)
    url = f"ws://127.0.0.1:{guarded.port}/api/v1/trackers/deaf/samples"
    with connect(url, additional_headers={"Authorization": f"Bearer {token}"}) as tracker:
        tracker.send(encode_sample(sample(1, (0.5, 0.0, 0.5))))
        tracker.send(json.dumps({"ping": 1}))
        assert json.loads(tracker.recv(HANG))["samples"]["passed"] == 1
        guarded.station.store.access_tokens.revoke("deaf", time.time_ns())
        guarded.station.access.refresh()
        wait_until(lambda: not guarded.has_tracker("deaf"), "the tracker has gone")
        with suppress(ConnectionClosed):
            tracker.send(encode_sample(sample(2, (0.5, 0.0, 0.5))))


def test_a_name_that_holds_is_given_to_nobody_else(guarded: Guarded) -> None:
    with pytest.raises(Conflict, match="there is a token 'operate' already"):
        guarded.make("operate", Capability.VIEW)


# names


def test_whoever_calls_himself_by_anothers_name_has_his_own_before_it(guarded: Guarded) -> None:
    path, headers = guarded.a_path(), guarded.headers(Capability.TEACH)
    for number, (label, author) in enumerate(
        [("administer", "teach (administer)"), ("", "teach"), ("teach", "teach"), ("x" * 80, f"teach ({'x' * 57}")]
    ):
        body = {"base": 1, "curve": CURVE, "author": label, "branch": f"b{number}"}
        saved = guarded.desk.post(f"/paths/{path}/versions", body, headers=headers)
        assert saved.json()["author"] == author
    job = guarded.desk.post(f"/paths/{path}/plans", headers=headers).json()
    assert job["who"] == "teach"  # which its plan bears (test_command_line.py)
    guarded.desk.post(f"/jobs/{job['id']}/cancel", headers=headers)


def test_a_calibration_bears_the_authenticated_name(guarded: Guarded) -> None:
    headers = guarded.headers(Capability.TEACH)
    places = [{"tracker": place, "world": place} for place in ([0.4, 0, 0.5], [0.7, 0, 0.5], [0.7, 0.3, 0.5])]
    body = {"points": places, "author": "administer"}
    assert (
        guarded.desk.send("PUT", "/api/v1/calibrations/named", json=body, headers=headers).json()["author"]
        == "teach (administer)"
    )


def test_control_and_the_journal_have_the_name_of_the_token(guarded: Guarded) -> None:
    asked: list[LeaseRequest] = []

    def answer(payload: bytes) -> bytes:
        asked.append(decode_lease_request(payload))
        return encode_lease(Lease(holder=asked[-1].name))

    handle = guarded.station.bus.serve(guarded.station.keys.executor_lease, answer)
    lease = guarded.desk.post("/lease", {"name": "administer"}, headers=guarded.headers(Capability.OPERATE))
    handle.close()
    assert lease.json()["holder"] == asked[0].name == "operate (administer)"


def test_whoever_stops_the_arm_without_a_token_takes_nobodys_name() -> None:
    assert signed(REFUSED_SUBJECT, "operate") == "not signed in (operate)"
    assert not is_name(REFUSED_SUBJECT.name)  # so that no token has it


# other origins and names of the station


def test_a_page_of_another_origin_gives_no_orders_even_with_a_token(guarded: Guarded) -> None:
    theirs = guarded.headers(Capability.ADMINISTER, Origin="https://evil.example")
    refused(guarded.desk.post("/tokens", {"name": "x", "roles": ["view"]}, headers=theirs), 403, "evil.example")
    with pytest.raises(InvalidStatus) as found:
        connect(f"ws://127.0.0.1:{guarded.port}/api/v1/events", additional_headers=theirs)
    assert found.value.response.status_code == 403


@pytest.mark.parametrize("host", ["evil.example", "robot.example.evil.example", "0.0.0.0", "127.0.0.1.evil.example"])
def test_another_name_of_the_address_is_refused(guarded: Guarded, host: str) -> None:
    headers = guarded.headers(Capability.VIEW, Host=host)
    assert guarded.desk.get("/tasks", headers=headers).status_code == 400


def test_a_name_of_the_settings_is_the_stations_own(guarded: Guarded) -> None:
    headers = guarded.headers(Capability.VIEW, Host="robot.example")
    assert guarded.desk.get("/tasks", headers=headers).status_code == 200


# a station that asks nobody


# settings that would open it
