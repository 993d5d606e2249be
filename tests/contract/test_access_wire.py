"""Attacks by what no browser sends: broken origins and bodies, names that look alike, another's tracker, ROS 2."""

import asyncio
import re
from collections.abc import Iterator

import pytest
from httpx import Response
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from teachpath.io.wire import encode_sample
from teachpath.records import Capability
from teachpath_client.errors import ClientError
from teachpath_client.ros2.arm_show import ArmShow
from teachpath_client.ros2.bridge import Names
from teachpath_client.ros2.node import Node
from tests.contract import access_matrix, stations
from tests.contract.desk import Desk, refused
from tests.contract.guarded import Guarded, opened
from tests.unit.clients.ros2.peer import RmwPeer
from tests.unit.recording.hands import sample
from tests.waiting import wait_until

BROKEN_ORIGINS = [
    "http://[evil",
    "localhost://[x",
    "http://[::1",
    "http://127.0.0.1:8765@[",
    "null",
    "",
    "a page",
    "//",
]
BODIES = [b"[" * 100_000, b"1" * 5000, b"\x1f\x8b\x08\x00\xff", b'{"name": "\xc3\x28"}']
JSON = {"Content-Type": "application/json"}


@pytest.fixture(scope="module")
def guarded() -> Iterator[Guarded]:
    with opened() as guarded:
        yield guarded


@pytest.mark.parametrize("origin", BROKEN_ORIGINS)
def test_an_origin_that_is_no_address_gives_no_orders(guarded: Guarded, desk: Desk, origin: str) -> None:
    admin = guarded.headers(Capability.ADMINISTER) | {"Origin": origin}
    refused(guarded.desk.post("/tokens", {"name": "x", "roles": ["view"]}, headers=admin), 403, "may not give orders")
    with pytest.raises(InvalidStatus) as found:
        connect(f"ws://127.0.0.1:{guarded.port}/api/v1/events", additional_headers=admin)
    assert found.value.response.status_code == 403
    refused(desk.get("/tasks", headers={"Origin": origin}), 403, "asks, and this station answers its own machine")


@pytest.mark.parametrize("header", ["X-Forwarded-Proto", "X-Forwarded-User", "X-Forwarded-Server", "X-Real-IP", "Via"])
def test_what_a_proxy_has_passed_on_is_not_of_this_machine(desk: Desk, header: str) -> None:
    refused(desk.get("/tasks", headers={header: "x"}), 403, f"a proxy has passed this on (header {header.lower()})")


@pytest.fixture(scope="module")
def proxied() -> Iterator[Desk]:
    settings = {"groups_header": "Remote-Groups", "view": ["lab"], "operate": ["operators"]}
    web = {"proxies": ["127.0.0.1"]}
    with stations.station(auth={"mode": "proxy"}, web=web, proxy=settings) as station, asyncio.Runner() as loop:
        yield Desk(station, loop)


@pytest.mark.parametrize("twice", ["X-Forwarded-User", "Remote-Groups"])
def test_a_proxy_that_leaves_what_a_client_said_of_itself_names_nobody(proxied: Desk, twice: str) -> None:
    once = [("X-Forwarded-User", "anna"), ("Remote-Groups", "lab")]
    forged = [*once, (twice, "operators")]
    refused(proxied.get("/tasks", headers=forged), 401, f"2 headers {twice}")
    assert proxied.get("/identity", headers=forged).json()["name"] == "not signed in"
    identity = proxied.get("/identity", headers=once).json()
    assert (identity["name"], identity["capabilities"], identity["groups"]) == ("anna", ["view"], ["lab"])


def test_groups_that_a_proxy_tells_give_their_roles_alone(proxied: Desk) -> None:
    def ask(user: str, groups: str, **more: str) -> Response:
        headers = {"X-Forwarded-User": user, "Remote-Groups": groups, **more}
        return proxied.post("/lease", {}, headers=headers)

    refused(
        ask("anna", "lab"), 403, "anna may view, and this needs operate; the proxy tells its groups (Remote-Groups)"
    )
    refused(ask("otto", ""), 403, "otto may do nothing, and this needs operate")
    refused(ask("otto", "students", **{"X-Forwarded-Groups": "operators"}), 403, "students; whoever administers")
    refused(ask("", "operators"), 401, "tells groups (Remote-Groups) and no name")
    refused(ask("anna", "operators"), 422, "body.name")  # the role is enough
    assert proxied.post("/stop", None).status_code not in (401, 403)
    refused(proxied.post("/session", {"name": "anna", "password": "x"}), 422, "the proxy asks who somebody is")


def test_the_audit_log_has_what_whom_a_proxy_brings_may_do(proxied: Desk) -> None:
    audit = proxied.station.audit
    for groups in ("lab", "lab", "lab,operators", ""):
        proxied.get("/tasks", headers={"X-Forwarded-User": "berta", "Remote-Groups": groups})
    audit.start()
    audit.stop()  # has written what has come
    came = "comes through the proxy; groups: "
    written = [(each.action, each.answer) for each in audit.log.entries() if each.who == "berta"]
    assert [each for each in written if each[0].startswith(came)] == [
        (f"{came}lab", "may view"),
        (f"{came}lab, operators", "may view, demonstrate, operate"),
        (f"{came}none", "may do nothing"),
    ]


@pytest.mark.parametrize("body", BODIES)
def test_a_body_that_cannot_be_read_tells_nobody_more_than_he_may_know(guarded: Guarded, body: bytes) -> None:
    def sent(headers: dict[str, str]) -> Response:
        return guarded.desk.send("POST", "/api/v1/lease", content=body, headers=headers | JSON)

    refused(sent({}), 401, "send a token")
    refused(sent(guarded.headers(Capability.DEMONSTRATE)), 403, "this needs operate")
    refused(sent(guarded.headers(Capability.OPERATE)), 400, "no JSON that can be read")


@pytest.mark.parametrize("role", Capability)
def test_a_role_is_never_refused_what_the_matrix_grants(guarded: Guarded, role: Capability) -> None:
    (token,) = (t for t in guarded.station.store.access_tokens.all() if t.name == role.value)
    for method, path, need in access_matrix.needs(guarded.station.web):
        if method in ("POST", "PUT", "PATCH", "DELETE") and need in token.capabilities:
            address = re.sub(r"\{.*?\}", "moon", path)
            answer = guarded.desk.send(method, address, headers=guarded.headers(role) | JSON, content=b"no json")
            assert answer.status_code in (200, 201, 202, 204, 404, 409, 422, 503), (method, address, answer.text)


@pytest.mark.parametrize("name", ["Operate", "OPERATE", "oPERATE"])
def test_nobody_is_named_as_another_but_for_large_letters(guarded: Guarded, name: str) -> None:
    admin, taken = guarded.headers(Capability.ADMINISTER), "'operate'"
    refused(guarded.desk.post("/tokens", {"name": name, "roles": ["view"]}, headers=admin), 409, taken)
    person = {"name": name, "roles": ["view"], "password": "four words together"}
    private = admin | {"Host": "127.0.0.1"}
    refused(guarded.desk.post("/people", person, headers=private), 409, taken)


def test_whoever_takes_the_tracker_that_another_left_is_another_source(guarded: Guarded) -> None:
    """Else an arm that one leads would follow him: demonstrating does not let anybody move it."""
    url, sources = f"ws://127.0.0.1:{guarded.port}/api/v1/trackers/left/samples", list[str]()
    handle = guarded.station.bus.subscribe_with_source(
        guarded.station.keys.samples("left"), lambda _, payload, source: sources.append(source)
    )
    for count, role in enumerate((Capability.OPERATE, Capability.DEMONSTRATE, Capability.OPERATE), 1):
        with connect(url, additional_headers=guarded.headers(role)) as tracker:
            tracker.send(encode_sample(sample(count, (0.5, 0.0, 0.5))))
            wait_until(lambda: len(sources) == count, "the sample has come")  # noqa: B023 - called within the turn
        wait_until(lambda: not guarded.has_tracker("left"), "the tracker has gone")
    handle.close()
    operator, other, operator_again = sources
    assert operator == operator_again != other


@pytest.mark.parametrize("role", [Capability.VIEW, Capability.DEMONSTRATE, Capability.TEACH])
def test_no_topic_of_ros_2_starts_a_plan_without_the_role_operate(guarded: Guarded, role: Capability) -> None:
    with RmwPeer() as peer, Node(peer.router) as node, guarded.client(role) as client:
        show = ArmShow(node, client, Names())
        with pytest.raises(ClientError, match=f"needs a token with the role operate; {role} may view"):
            show.followed([]).__enter__()
        assert not any("/MS/" in token for token in peer.tokens())
