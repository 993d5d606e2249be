"""People who sign in over REST: sessions in cookies, and the attacks on them, each refused."""

from collections.abc import Iterator
from contextlib import suppress
from http.cookies import SimpleCookie
from typing import Any

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from teachpath.access.attempts import MAX_OF_NAME
from teachpath.access.passwords import hash_password
from teachpath.access.tokens import digest_of
from teachpath.api.session_cookie import LOOPBACK_COOKIE, SECURE_COOKIE
from teachpath.records import Capability, Person
from tests.contract.desk import refused
from tests.contract.guarded import Guarded, opened
from tests.waiting import HANG

PASSWORD = "four words put together"
ORIGIN = "http://127.0.0.1:8765"


@pytest.fixture(scope="module")
def guarded() -> Iterator[Guarded]:
    with opened() as guarded:
        for name, role in (("anna", Capability.TEACH), ("otto", Capability.OPERATE), ("gone", Capability.VIEW)):
            guarded.station.store.people.add(Person(name, (role,), hash_password(PASSWORD, name), 1, 1))
        guarded.station.access.refresh()
        yield guarded


def sign_in(guarded: Guarded, name: str = "anna", password: str = PASSWORD, **headers: str) -> httpx.Response:
    return guarded.desk.post("/session", {"name": name, "password": password}, headers={"Origin": ORIGIN} | headers)


def cookie_of(answer: httpx.Response) -> dict[str, Any]:
    """Name, value and attributes of the only cookie that an answer sets."""
    (header,) = answer.headers.get_list("set-cookie")
    ((name, morsel),) = SimpleCookie(header).items()
    return {"name": name, "value": morsel.value} | {key: value for key, value in morsel.items() if value}


@pytest.fixture
def session(guarded: Guarded) -> dict[str, str]:
    """Headers of a page in which Anna has signed in."""
    cookie = cookie_of(sign_in(guarded))
    return {"Cookie": f"{cookie['name']}={cookie['value']}", "Origin": ORIGIN}


def test_a_session_begins_with_the_password_and_says_who_it_is(guarded: Guarded) -> None:
    answer = sign_in(guarded)
    may = {"capabilities": ["view", "demonstrate", "teach"]}
    assert answer.json() == {"mode": "token", "name": "anna", "provider": "", "groups": []} | may
    cookie = cookie_of(answer)
    assert (cookie["name"], cookie["path"], cookie["samesite"]) == (LOOPBACK_COOKIE, "/", "strict")
    assert cookie["httponly"]
    assert "domain" not in cookie
    assert "secure" not in cookie
    stored = b"".join(file.read_bytes() for file in guarded.desk.data_dir.rglob("*") if file.is_file())
    assert cookie["value"].encode() not in stored
    assert digest_of(cookie["value"]).encode() in stored
    assert PASSWORD.encode() not in stored


def test_over_tls_the_cookie_is_of_this_host_alone(guarded: Guarded) -> None:
    tls = "https://127.0.0.1:8765"
    body = {"name": "anna", "password": PASSWORD}
    answer = guarded.desk.send("POST", f"{tls}/api/v1/session", json=body, headers={"Origin": tls})
    cookie = cookie_of(answer)
    assert cookie["name"] == SECURE_COOKIE
    assert cookie["secure"]
    assert "domain" not in cookie
    for name, status in ((SECURE_COOKIE, 200), (LOOPBACK_COOKIE, 401)):  # of http, others could have set or read it
        headers = {"Cookie": f"{name}={cookie['value']}"}
        assert guarded.desk.send("GET", f"{tls}/api/v1/tasks", headers=headers).status_code == status


def test_in_a_session_the_role_counts(guarded: Guarded, session: dict[str, str]) -> None:
    assert guarded.desk.get("/tasks", headers=session).status_code == 200
    refused(guarded.desk.post("/jobs/moon/cancel", headers=session), 404, "no job 'moon'")
    refused(guarded.desk.post("/executions", {"plan": "x"}, headers=session), 403, "anna may demonstrate, teach, view")
    refused(guarded.desk.get("/tokens", headers=session), 403, "this needs administer")


def test_an_order_without_an_origin_is_none_of_the_page(guarded: Guarded, session: dict[str, str]) -> None:
    bare = {"Cookie": session["Cookie"]}
    assert guarded.desk.get("/tasks", headers=bare).status_code == 200
    refused(guarded.desk.post("/jobs/moon/cancel", headers=bare), 403, "comes from this station's page")
    theirs = session | {"Origin": "https://evil.example"}
    refused(guarded.desk.post("/jobs/moon/cancel", headers=theirs), 403, "evil.example may not give orders")
    for origin in ("", "https://evil.example"):
        headers = {"Cookie": session["Cookie"]} | ({"Origin": origin} if origin else {})
        with pytest.raises(InvalidStatus) as found:
            connect(f"ws://127.0.0.1:{guarded.port}/api/v1/events", additional_headers=headers)
        assert found.value.response.status_code == 403


@pytest.mark.parametrize("value", ["", "x", "{digest}", "{value}x", "{upper}", "a" * 5000, "%00", "null", '"{value}"'])
def test_a_forged_cookie_opens_nothing(guarded: Guarded, session: dict[str, str], value: str) -> None:
    name, _, real = session["Cookie"].partition("=")
    for word, text in (("digest", digest_of(real)), ("value", real), ("upper", real.swapcase())):
        value = value.replace("{" + word + "}", text)
    assert guarded.desk.get("/tasks", headers={"Cookie": f"{name}={value}"}).status_code == 401


def test_two_cookies_are_no_choice(guarded: Guarded, session: dict[str, str]) -> None:
    name, _, real = session["Cookie"].partition("=")
    for cookies in (f"{name}=x; {name}={real}", f"{name}={real}; {name}=x"):
        refused(guarded.desk.get("/tasks", headers={"Cookie": cookies}), 401, "has 2 cookies")


def test_a_session_that_was_chosen_beforehand_is_never_taken_over(guarded: Guarded) -> None:
    chosen = "chosen-by-somebody-else"
    answer = sign_in(guarded, Cookie=f"{LOOPBACK_COOKIE}={chosen}")
    assert cookie_of(answer)["value"] != chosen
    assert guarded.desk.get("/tasks", headers={"Cookie": f"{LOOPBACK_COOKIE}={chosen}"}).status_code == 401


def test_who_signs_in_again_ends_the_session_of_before(guarded: Guarded, session: dict[str, str]) -> None:
    assert sign_in(guarded, "otto", Cookie=session["Cookie"]).status_code == 200
    assert guarded.desk.get("/tasks", headers=session).status_code == 401


def test_signing_out_ends_the_session_and_its_websockets(guarded: Guarded) -> None:
    headers = {"Origin": f"http://127.0.0.1:{guarded.port}"}
    with httpx.Client(base_url=f"{guarded.url}/api/v1", headers=headers, timeout=HANG) as page:
        page.post("/session", json={"name": "anna", "password": PASSWORD}).raise_for_status()
        cookie = "; ".join(f"{name}={value}" for name, value in page.cookies.items())
        with connect(
            f"ws://127.0.0.1:{guarded.port}/api/v1/events", additional_headers=headers | {"Cookie": cookie}
        ) as events:
            assert events.recv(HANG)
            assert page.delete("/session").status_code == 204
            with suppress(ConnectionClosed):
                for _ in events:
                    pass
            assert events.close_code == 1008
        assert not page.cookies
        assert page.get("/tasks", headers={"Cookie": cookie}).status_code == 401
        assert page.delete("/session").status_code == 204  # again


def test_a_person_who_is_removed_is_out(guarded: Guarded) -> None:
    cookie = cookie_of(sign_in(guarded, "gone"))
    headers = {"Cookie": f"{cookie['name']}={cookie['value']}"}
    assert guarded.desk.get("/tasks", headers=headers).status_code == 200
    guarded.station.store.people.remove("gone")
    guarded.station.access.refresh()
    assert guarded.desk.get("/tasks", headers=headers).status_code == 401
    refused(sign_in(guarded, "gone"), 401, "no one of this name and password")


def test_guessing_is_answered_with_the_time_to_wait(guarded: Guarded) -> None:
    for _ in range(MAX_OF_NAME):
        refused(sign_in(guarded, "nobody", "wrong"), 401, "no one of this name and password")
    answer = sign_in(guarded, "nobody", "wrong")
    refused(answer, 429, "try again in")
    assert 1 <= int(answer.headers["retry-after"]) <= 300
    assert sign_in(guarded, "anna").status_code == 200


def test_a_password_is_not_sent_where_others_could_read_it(guarded: Guarded) -> None:
    refused(sign_in(guarded, Host="robot.example", Origin="http://robot.example"), 403, "use https")
    refused(sign_in(guarded, Origin="https://evil.example"), 403, "evil.example may not give orders")


def test_a_password_is_not_repeated(guarded: Guarded) -> None:
    for body in ({"name": "anna", "password": "my secret words"}, {"name": 1, "password": "my secret words"}):
        assert "secret" not in guarded.desk.post("/session", body, headers={"Origin": ORIGIN}).text


def test_in_a_session_the_name_stands_on_what_was_made(guarded: Guarded, session: dict[str, str]) -> None:
    made = guarded.desk.send("PUT", "/api/v1/tasks/named", json={}, headers=session)
    assert made.status_code == 200
    rows = "t,x,y,z\n" + "".join(f"{i * 0.02},{0.4 + 0.01 * i},0,0.6\n" for i in range(60))
    job = guarded.desk.post("/tasks/named/demonstrations", json=None, content=rows, headers=session).json()
    assert job["who"] == "anna"
