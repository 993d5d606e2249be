"""People sign in at a provider over REST: cookies, roles, and where a browser is sent."""

import asyncio
from collections.abc import Iterator
from urllib.parse import parse_qsl, urlsplit

import httpx
import pytest

from teachpath.api.session_cookie import LOOPBACK_COOKIE, SIGN_IN
from teachpath.records import Capability
from tests.contract import stations
from tests.contract.desk import refused
from tests.contract.guarded import Guarded
from tests.contract.test_people import cookie_of
from tests.identity_provider import CLIENT, SECRET, EmulatedProvider, running

ORIGIN = "http://127.0.0.1:8765"
PAGE = f"{ORIGIN}/robot/"


@pytest.fixture(scope="module")
def provider() -> Iterator[EmulatedProvider]:
    with running() as provider:
        yield provider


@pytest.fixture(scope="module")
def guarded(provider: EmulatedProvider, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Guarded]:
    secret = tmp_path_factory.mktemp("secret") / "client"
    secret.write_text(SECRET)
    secret.chmod(0o600)
    groups = {"teach": ["teachers"], "administer": ["admins"]}
    client = {"name": "Lab", "issuer": provider.issuer, "client_id": CLIENT, "client_secret_file": str(secret)}
    with stations.station(auth={"mode": "oidc"}, oidc=client | groups) as station, asyncio.Runner() as loop:
        guarded = Guarded(station, loop, 8765)
        provider.metadata = {"issuer": "https://elsewhere.example"}
        refused(begin(guarded), 503, "says that it is 'https://elsewhere.example'")
        assert guarded.desk.get("/tasks", headers=guarded.headers(Capability.VIEW)).status_code == 200
        yield guarded


@pytest.fixture(autouse=True)
def right(guarded: Guarded, provider: EmulatedProvider) -> None:
    provider.reset()


def begin(guarded: Guarded, **headers: str) -> httpx.Response:
    body = {"path": "/robot/"}
    return guarded.desk.post("/session/authorization", body, headers={"Origin": ORIGIN} | headers)


def visited(guarded: Guarded) -> tuple[dict[str, str], dict[str, str]]:
    """Begin, let the browser go to the provider, and return with what it comes back with, and its headers."""
    began = begin(guarded)
    place = httpx.get(began.json()["address"]).headers["location"]
    assert place.startswith(f"{PAGE}?")
    cookie = cookie_of(began)
    return dict(parse_qsl(urlsplit(place).query)), {"Origin": ORIGIN, "Cookie": f"{SIGN_IN}={cookie['value']}"}


def finish(guarded: Guarded, given: dict[str, str], headers: dict[str, str]) -> httpx.Response:
    return guarded.desk.post("/session/code", given, headers=headers)


def session(guarded: Guarded) -> tuple[httpx.Response, dict[str, str]]:
    """Sign in, and return the answer with the headers of the page from then on."""
    answer = finish(guarded, *visited(guarded))
    assert answer.status_code == 200, answer.text
    pairs = dict(header.partition(";")[0].split("=", 1) for header in answer.headers.get_list("set-cookie"))
    assert pairs.pop(SIGN_IN) == '""'
    return answer, {"Origin": ORIGIN, "Cookie": f"{LOOPBACK_COOKIE}={pairs[LOOPBACK_COOKIE]}"}


def test_a_person_comes_back_with_a_session_and_the_roles_of_the_groups(
    guarded: Guarded, provider: EmulatedProvider
) -> None:
    answer, headers = session(guarded)
    me = {
        "mode": "oidc",
        "name": "anna",
        "capabilities": ["view", "demonstrate", "teach"],
        "provider": "Lab",
        "groups": [],
    }
    assert answer.json() == me
    assert guarded.desk.get("/identity", headers=headers).json() == me
    refused(guarded.desk.get("/tokens", headers=headers), 403, "this needs administer")
    asked = provider.asked
    assert (asked["scope"], asked["prompt"], asked["code_challenge_method"]) == ("openid profile", "login", "S256")
    assert asked["redirect_uri"] == PAGE
    provider.person["groups"] = ["admins"]
    session(guarded)
    assert guarded.desk.get("/tokens", headers=headers).status_code == 200
    again = session(guarded)[1]
    assert guarded.desk.send("DELETE", "/api/v1/session", headers=again).status_code == 204
    assert guarded.desk.get("/tasks", headers=again).status_code == 401


def test_who_signs_in_again_ends_the_session_of_before(guarded: Guarded) -> None:
    former = session(guarded)[1]
    given, headers = visited(guarded)
    both = headers | {"Cookie": f"{headers['Cookie']}; {former['Cookie']}"}
    assert finish(guarded, given, both).status_code == 200
    assert guarded.desk.get("/tasks", headers=former).status_code == 401
    refused(finish(guarded, given, headers), 401, "finished already")


def test_the_cookie_of_a_sign_in_is_of_this_site_alone_and_no_session(guarded: Guarded) -> None:
    cookie = cookie_of(begin(guarded))
    assert (cookie["name"], cookie["path"], cookie["samesite"]) == (SIGN_IN, "/", "strict")
    assert cookie["httponly"]
    for name in (SIGN_IN, LOOPBACK_COOKIE):
        assert guarded.desk.get("/tasks", headers={"Cookie": f"{name}={cookie['value']}"}).status_code == 401
    assert guarded.desk.get("/identity").json()["provider"] == "Lab"
    tls = "https://127.0.0.1:8765"
    body, headers = {"path": "/"}, {"Origin": tls}
    cookie = cookie_of(guarded.desk.send("POST", f"{tls}/api/v1/session/authorization", json=body, headers=headers))
    assert (cookie["name"], cookie["secure"]) == (f"__Host-{SIGN_IN}", True)


def test_a_person_of_the_provider_is_removed_like_others_and_has_no_password(guarded: Guarded) -> None:
    _, headers = session(guarded)
    admin = guarded.headers(Capability.ADMINISTER)
    address, new = "/api/v1/people/anna", {"password": "four words put together"}
    (listed,) = guarded.desk.get("/people", headers=admin).json()
    assert (listed["name"], listed["roles"]) == ("anna", ["teach"])
    refused(guarded.desk.send("PUT", f"{address}/password", json=new, headers=admin), 409, "has no password here")
    refused(guarded.desk.post("/people", {"name": "x", "roles": ["view"]} | new, headers=admin), 409, "add them there")
    refused(guarded.desk.post("/session", {"name": "anna"} | new, headers={"Origin": ORIGIN}), 422, "sign in at Lab")
    refused(guarded.desk.post("/tokens", {"name": "anna", "roles": ["view"]}, headers=admin), 409, "a person has the")
    assert guarded.desk.send("DELETE", address, headers=admin).status_code == 204
    assert guarded.desk.get("/tasks", headers=headers).status_code == 401


def test_the_name_of_a_token_is_nobody_elses(guarded: Guarded, provider: EmulatedProvider) -> None:
    provider.person |= {"sub": "another", "preferred_username": "view"}
    refused(finish(guarded, *visited(guarded)), 409, "taken by a person or a token")


def test_refusals_of_the_provider_have_their_status(guarded: Guarded, provider: EmulatedProvider) -> None:
    provider.claims = {"nonce": "of another sign-in"}
    refused(finish(guarded, *visited(guarded)), 401, "nonce")
    provider.claims = {"groups": []}
    refused(finish(guarded, *visited(guarded)), 403, "has a role here")


@pytest.mark.parametrize(
    "path", ["//evil.example/", "https://evil.example/", "/\\evil.example", "/?x", "/#x", "", "/a@b"]
)
def test_nobody_is_sent_elsewhere(guarded: Guarded, provider: EmulatedProvider, path: str) -> None:
    answer = guarded.desk.post("/session/authorization", {"path": path}, headers={"Origin": ORIGIN})
    if path != "//evil.example/":
        refused(answer, 422, "path")
        return
    address = answer.json()["address"]
    assert address.startswith(f"{provider.issuer}/authorize?")
    back = urlsplit(dict(parse_qsl(urlsplit(address).query))["redirect_uri"])
    assert f"{back.scheme}://{back.netloc}" == ORIGIN  # of this host all the same


def test_only_the_page_signs_in(guarded: Guarded) -> None:
    refused(begin(guarded, Origin="https://evil.example"), 403, "evil.example may not give orders")
    refused(begin(guarded, Origin="null"), 403, "may not give orders")
    refused(guarded.desk.post("/session/authorization", {"path": "/"}), 403, "sign in on this station's page")
    given, headers = visited(guarded)
    refused(finish(guarded, given, headers | {"Origin": "https://evil.example"}), 403, "evil.example")
