"""Who may do what: every route declares it, the document says it, and a station with tokens keeps to it."""

import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.routing import iter_route_contexts
from typer.testing import CliRunner
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from teachpath.__main__ import app
from teachpath.io.bus_access import GRANTS
from teachpath.records import Capability
from teachpath_client.errors import Refused
from teachpath_proto.logins import Role
from teachpath_proto.tokens import TOKEN_VARIABLE, write_token
from tests.contract import access_matrix, stations
from tests.contract.desk import Desk, refused
from tests.contract.guarded import Guarded, opened
from tests.waiting import HANG, wait_until


@pytest.fixture(scope="module")
def guarded() -> Iterator[Guarded]:
    with opened() as guarded:
        yield guarded


# the declarations


def test_every_route_declares_what_it_needs(desk: Desk) -> None:
    routes = list(iter_route_contexts(desk.station.web.routes))
    assert len(routes) > 80
    silent = [route.path for route in routes if len(access_matrix.declarations(route)) != 1]
    assert silent == [], "give each of them dependencies=VIEW, ... or OPEN (teachpath.api.access)"


def test_only_stops_probes_the_page_and_its_description_are_open(desk: Desk) -> None:
    free = {path for method, path, need in access_matrix.needs(desk.station.web) if need == access_matrix.NO_ROLE}
    assert free == {
        "/", "/docs", "/favicon.ico", "/web/{name:path}", "/vendor/{name}", "/asyncapi.json", "/openapi.json",
        "/authority", "/authority.crt", "/authority/address.svg", "/help", "/help/{name:path}",
        "/api/v1/stop", "/api/v1/executions/{execution}/stop",
        "/api/v1/session", "/api/v1/session/authorization", "/api/v1/session/code", "/api/v1/identity",
        "/api/v1/health/live", "/api/v1/health/ready",
    }  # fmt: skip


def test_whoever_only_looks_changes_nothing(desk: Desk) -> None:
    others = {
        (method, path)
        for method, path, need in access_matrix.needs(desk.station.web)
        if (need == Capability.VIEW) != (method in ("GET", "WS")) and need != access_matrix.NO_ROLE
    }
    readers = {("GET", f"/api/v1/{name}") for name in ("tokens", "people", "audit")}
    assert others == readers | {("WS", "/api/v1/trackers/{name}/samples")}


def test_the_document_has_the_matrix(desk: Desk) -> None:
    expected = access_matrix.text(desk.station.web)
    assert access_matrix.FILE.read_text() == expected, "run: python -m tests.contract.access_matrix"


def test_the_description_declares_the_scheme_and_what_each_operation_needs(desk: Desk) -> None:
    description = desk.send("GET", "/openapi.json").json()
    assert description["components"]["securitySchemes"]["token"]["scheme"] == "bearer"
    for method, path, need in access_matrix.needs(desk.station.web):
        operation = description["paths"].get(path, {}).get(method.lower())
        if operation is not None:
            expected = [] if need == access_matrix.NO_ROLE else [{"token": [need]}]
            assert operation.get("security") == expected, (method, path)


def test_every_key_of_the_bus_is_declared_and_every_grant_is_for_a_key() -> None:
    keys = access_matrix.keys()
    assert len(keys) > 20
    silent = [key for key in keys if not any(access_matrix.granted(role, key) for role in access_matrix.LOGINS)]
    assert silent == [], "grant them to a role (teachpath.io.bus_access.GRANTS)"
    idle = {
        pattern
        for role in access_matrix.LOGINS
        for patterns in GRANTS[role].values()
        for pattern in patterns
        if pattern != "alive/**" and not any(access_matrix.matches(pattern, key) for key in keys)
    }
    assert idle == set(), "no key is meant by them"


def test_only_who_may_operate_commands_the_executor_and_everybody_stops_it() -> None:
    def speak(key: str) -> set[Role]:
        return {r for r in access_matrix.LOGINS if {"put", "ask"} & set(access_matrix.granted(r, key))}

    assert speak("executor/command") == speak("executor/lease") == {Role.OPERATOR}
    assert speak("executor/stop") == set(access_matrix.LOGINS) - {Role.EXECUTOR}
    assert speak("robot/{robot}/setpoint") == {Role.EXECUTOR}
    assert speak("robot/{robot}/state") == {Role.ROBOT}
    assert speak("trackers/{tracker}/samples") == {Role.TRACKER}


# the matrix, kept


def each(guarded: Guarded) -> list[tuple[str, str, str]]:
    """Method, an address and the need of every route over HTTP."""
    return [
        (method, re.sub(r"\{.*?\}", "moon", path), need)
        for method, path, need in access_matrix.needs(guarded.station.web)
        if method != "WS" and need != access_matrix.NO_ROLE
    ]


def test_without_a_token_nothing_is_answered(guarded: Guarded) -> None:
    for method, address, _ in each(guarded):
        answer = guarded.desk.send(method, address)
        refused(answer, 401, "send a token as header Authorization: Bearer TOKEN")
        assert answer.headers["www-authenticate"] == "Bearer"


def test_a_stranger_hears_nothing_of_what_is_wrong_with_a_request(guarded: Guarded) -> None:
    broken = {"content": b"{no json", "headers": {"Content-Type": "application/json"}}
    for method, address, need in each(guarded):
        for request in ({"params": {"unknown": "1"}}, broken):
            refused(guarded.desk.send(method, address, **request), 401, "send a token")
        headers = broken["headers"] | guarded.headers(Capability.VIEW)
        if need != Capability.VIEW:
            refused(guarded.desk.send(method, address, content=b"{", headers=headers), 403, f"this needs {need}")


@pytest.mark.parametrize("role", Capability)
def test_a_role_may_do_what_the_matrix_says_and_no_more(guarded: Guarded, role: Capability) -> None:
    may = guarded.station.store.access_tokens.all()[list(Capability).index(role)].capabilities
    for method, address, need in each(guarded):
        if need not in may:
            refused(guarded.desk.send(method, address, headers=guarded.headers(role)), 403, f"this needs {need}")
        elif method == "GET" and "health" not in address and "lease" not in address:
            status = guarded.desk.send(method, address, headers=guarded.headers(role)).status_code
            assert status in (200, 404, 422), (method, address, status)


def test_a_stop_needs_no_token_and_is_never_refused(guarded: Guarded) -> None:
    refused(guarded.desk.post("/executions/moon/stop"), 404, "no execution 'moon'")
    bad = {"Authorization": "Bearer nonsense"}
    refused(guarded.desk.post("/executions/moon/stop", headers=bad), 404, "no execution 'moon'")


def test_a_websocket_needs_its_capability(guarded: Guarded, caplog: pytest.LogCaptureFixture) -> None:
    for address, need in (
        ("events", "view"),
        ("view", "view"),
        ("joints", "view"),
        ("trackers/x/samples", "demonstrate"),
    ):
        url = f"ws://127.0.0.1:{guarded.port}/api/v1/{address}"
        with pytest.raises(InvalidStatus) as found:
            connect(url)
        assert found.value.response.status_code == 401
        role = Capability(need)
        with connect(url, additional_headers=guarded.headers(role)):
            pass
    with pytest.raises(InvalidStatus) as found:
        connect(url, additional_headers=guarded.headers(Capability.VIEW))
    assert found.value.response.status_code == 403
    with connect(url, additional_headers=guarded.headers(Capability.DEMONSTRATE)):
        assert not [
            line for line in caplog.records if line.levelname == "ERROR"
        ]  # a refusal is no fault of the station


# who it is


def test_everybody_hears_who_he_is(guarded: Guarded, desk: Desk) -> None:
    nowhere = {"provider": "", "groups": []}
    mine = guarded.desk.get("/identity", headers=guarded.headers(Capability.TEACH)).json()
    assert mine == {"mode": "token", "name": "teach", "capabilities": ["view", "demonstrate", "teach"]} | nowhere
    stranger = guarded.desk.get("/identity").json()
    assert stranger == {"mode": "token", "name": "not signed in", "capabilities": []} | nowhere
    nobody = {"mode": "none", "name": "", "capabilities": list(Capability)} | nowhere
    assert desk.get("/identity").json() == nobody


def test_without_a_provider_nobody_signs_in_at_one(desk: Desk) -> None:
    for path, body in (("authorization", {"path": "/"}), ("code", {"code": "x", "state": "y"})):
        refused(desk.post(f"/session/{path}", body), 422, "nobody signs in at a provider")


def test_tokens_are_made_listed_and_revoked_over_rest(guarded: Guarded) -> None:
    admin = guarded.headers(Capability.ADMINISTER)
    order = {"name": "cell-3", "roles": ["operate"], "days": 2}
    made = guarded.desk.post("/tokens", order, headers=admin)
    assert made.status_code == 201
    token = made.json()["token"]
    refused(guarded.desk.post("/tokens", order, headers=admin), 409, "there is a token 'cell-3' already")
    refused(guarded.desk.post("/tokens", order | {"name": "a b"}, headers=admin), 422, "cannot name a token")
    mine = {"Authorization": f"Bearer {token}"}
    assert guarded.desk.get("/tasks", headers=mine).status_code == 200
    guarded.station.access.refresh()
    listed = next(t for t in guarded.desk.get("/tokens", headers=admin).json() if t["name"] == "cell-3")
    assert listed["used_ns"] > listed["created_ns"]
    assert "token" not in listed
    assert guarded.desk.send("DELETE", "/api/v1/tokens/cell-3", headers=admin).status_code == 200
    refused(guarded.desk.get("/tasks", headers=mine), 401, "token cell-3 was revoked on")
    refused(guarded.desk.send("DELETE", "/api/v1/tokens/cell-3", headers=admin), 404, "no token 'cell-3' that holds")
    assert guarded.desk.post("/tokens", order, headers=admin).status_code == 201


def test_the_client_shows_its_token_everywhere(guarded: Guarded) -> None:
    with guarded.client(Capability.VIEW) as client, client.events() as events:
        assert events.next(HANG) is not None
        assert client.health().version
        with pytest.raises(Refused) as found:
            client.begin_execution("moon")
    assert found.value.status == 403


def test_the_command_line_shows_the_token_it_is_given(guarded: Guarded) -> None:
    guarded.desk.send("PUT", "/api/v1/tasks/shown", json={}, headers=guarded.headers(Capability.TEACH))
    for way in ("option", "variable", "file"):
        token, words = guarded.tokens[Capability.VIEW], ["demonstrations", "shown", "--url", guarded.url]
        with tempfile.TemporaryDirectory() as folder:
            environment: dict[str, str | None] = {TOKEN_VARIABLE: None, "XDG_STATE_HOME": folder}
            if way == "option":
                words = ["--token", token, *words]
            elif way == "variable":
                environment[TOKEN_VARIABLE] = token
            else:
                file = Path(folder) / "teachpath" / f"http-127.0.0.1-{guarded.port}.token"
                write_token(file, token)
            result = CliRunner().invoke(app, words, env=environment)
            assert result.exception is None, (way, result.exception)
            refused = CliRunner().invoke(app, words[-4:], env={TOKEN_VARIABLE: None, "XDG_STATE_HOME": f"{folder}/x"})
            assert "send a token" in str(refused.exception)


def test_jobs_and_marks_carry_the_name_of_the_token(guarded: Guarded) -> None:
    headers = guarded.headers(Capability.DEMONSTRATE)
    rows = "t,x,y,z\n" + "".join(f"{i * 0.02},{0.4 + 0.01 * i},0,0.6\n" for i in range(60))
    job = guarded.desk.post("/tasks/named/demonstrations", json=None, content=rows, headers=headers).json()
    assert job["who"] == "demonstrate"

    def ended() -> bool:
        return bool(guarded.desk.get(f"/jobs/{job['id']}", headers=headers).json()["finished_ns"])

    wait_until(ended, "the import has ended")
    (made,) = guarded.desk.get("/tasks/named/demonstrations", headers=headers).json()
    address = f"/api/v1/demonstrations/{made['id']}"
    changed = guarded.desk.send("PATCH", address, json={"mark": "good"}, headers=headers).json()
    assert changed["amended_by"] == "demonstrate"


def test_a_station_that_nobody_can_use_says_so(guarded: Guarded) -> None:
    assert guarded.station.access.notes() == []
    with stations.station(auth={"mode": "token"}) as fresh:
        (note,) = [note for note in fresh.notes() if "neither a token" in note]
    assert "teachpath person add NAME --role administer" in note


def test_answers_are_held_against_their_description(desk: Desk) -> None:
    before = desk.described
    desk.get("/tasks")
    desk.get("/health")
    assert desk.described == before + 2
