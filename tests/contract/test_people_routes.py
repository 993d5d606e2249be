"""People over REST, for whoever administers the station: no secret is told, kept or written."""

from collections.abc import Iterator

import pytest

from teachpath.records import Capability
from tests.contract.desk import refused
from tests.contract.guarded import Guarded, opened
from tests.contract.test_people import ORIGIN, cookie_of
from tests.waiting import wait_until

PASSWORD = "five words put together here"


@pytest.fixture(scope="module")
def guarded() -> Iterator[Guarded]:
    with opened() as guarded:
        guarded.station.audit.start()
        yield guarded


def add(guarded: Guarded, name: str, *roles: str) -> None:
    body = {"name": name, "password": PASSWORD, "roles": list(roles)}
    answer = guarded.desk.post("/people", body, headers=guarded.headers(Capability.ADMINISTER))
    assert answer.status_code == 201, answer.text
    assert PASSWORD not in answer.text


def signed_in(guarded: Guarded, name: str, password: str = PASSWORD) -> dict[str, str]:
    """Headers of a page in which somebody has signed in."""
    answer = guarded.desk.post("/session", {"name": name, "password": password}, headers={"Origin": ORIGIN})
    assert answer.status_code == 200, answer.text
    cookie = cookie_of(answer)
    return {"Cookie": f"{cookie['name']}={cookie['value']}", "Origin": ORIGIN}


def test_a_person_is_added_listed_and_removed(guarded: Guarded) -> None:
    admin = guarded.headers(Capability.ADMINISTER)
    add(guarded, "anna", "teach", "operate")
    session = signed_in(guarded, "anna")
    (listed,) = [each for each in guarded.desk.get("/people", headers=admin).json() if each["name"] == "anna"]
    assert (listed["roles"], listed["sessions"]) == (["teach", "operate"], 1)
    assert listed["used_ns"] >= listed["created_ns"]
    assert not {"password", "password_hash"} & set(listed)
    assert guarded.desk.send("DELETE", "/api/v1/people/anna", headers=admin).status_code == 204
    assert guarded.desk.get("/tasks", headers=session).status_code == 401
    refused(guarded.desk.send("DELETE", "/api/v1/people/anna", headers=admin), 404, "no person 'anna'")


def test_another_password_ends_the_sessions_of_the_former(guarded: Guarded) -> None:
    admin = guarded.headers(Capability.ADMINISTER)
    add(guarded, "otto", "view")
    session = signed_in(guarded, "otto")
    other = {"password": "another four words long"}
    changed = guarded.desk.send("PUT", "/api/v1/people/otto/password", json=other, headers=admin)
    assert changed.status_code == 204
    assert guarded.desk.get("/tasks", headers=session).status_code == 401
    assert guarded.desk.get("/tasks", headers=signed_in(guarded, "otto", other["password"])).status_code == 200


def test_nobody_locks_the_door_behind(guarded: Guarded) -> None:
    add(guarded, "root", "administer")
    session = signed_in(guarded, "root")
    refused(guarded.desk.send("DELETE", "/api/v1/people/root", headers=session), 409, "somebody else removes you")
    assert guarded.desk.get("/people", headers=session).status_code == 200


@pytest.mark.parametrize("role", [role for role in Capability if role is not Capability.ADMINISTER])
def test_whoever_does_not_administer_makes_nobody(guarded: Guarded, role: Capability) -> None:
    headers = guarded.headers(role)
    person = {"name": "mallory", "password": PASSWORD, "roles": ["administer"]}
    refused(guarded.desk.post("/people", person, headers=headers), 403, "this needs administer")
    refused(guarded.desk.get("/people", headers=headers), 403, "this needs administer")
    changed = guarded.desk.send("PUT", "/api/v1/people/otto/password", json={"password": PASSWORD}, headers=headers)
    refused(changed, 403, "this needs administer")
    refused(guarded.desk.send("DELETE", "/api/v1/people/otto", headers=headers), 403, "this needs administer")


@pytest.mark.parametrize(
    ("name", "status", "sentence"),
    [
        ("a b", 422, "person"),
        ("../x", 422, "person"),
        ("operate", 409, "is taken by a person or a token"),
        ("", 422, ""),
    ],
)
def test_names_that_cannot_be_are_not_given(guarded: Guarded, name: str, status: int, sentence: str) -> None:
    person = {"name": name, "password": PASSWORD, "roles": ["view"]}
    refused(guarded.desk.post("/people", person, headers=guarded.headers(Capability.ADMINISTER)), status, sentence)


def test_a_bad_password_is_refused_and_not_repeated(guarded: Guarded) -> None:
    for password in ("short one", "x" * 1000, "x" * 2000):
        person = {"name": "weak", "password": password, "roles": ["view"]}
        answer = guarded.desk.post("/people", person, headers=guarded.headers(Capability.ADMINISTER))
        assert answer.status_code == 422
        assert password not in answer.text


def test_a_password_goes_over_a_private_line_alone(guarded: Guarded) -> None:
    headers = guarded.headers(Capability.ADMINISTER, Host="robot.example")
    person = {"name": "far", "password": PASSWORD, "roles": ["view"]}
    refused(guarded.desk.post("/people", person, headers=headers), 403, "use https")
    changed = guarded.desk.send("PUT", "/api/v1/people/otto/password", json={"password": PASSWORD}, headers=headers)
    refused(changed, 403, "use https")


def test_the_audit_log_has_who_was_added_and_no_password(guarded: Guarded) -> None:
    add(guarded, "noted", "view", "teach")
    log = guarded.station.audit.log

    def actions() -> list[str]:
        return [entry.action for entry in log.entries()]

    wait_until(lambda: "POST /api/v1/people noted, view teach" in actions(), "it is written")
    assert PASSWORD not in str(list(log.entries()))


def test_no_event_tells_of_people_or_tokens(guarded: Guarded) -> None:
    subscriber = guarded.station.event_hub.subscribe(lambda: None)
    add(guarded, "unheard", "view")
    guarded.make("unheard-token", Capability.VIEW)
    heard = []
    while (event := subscriber.pop()) is not None:
        heard.append(event.text)
    guarded.station.event_hub.unsubscribe(subscriber)
    assert heard  # the station begins by saying where it stands
    assert "unheard" not in "".join(heard)
