"""People who sign in at a provider of OpenID Connect, in virtual time, and the attacks on that, each refused."""

import base64
import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from joserfc import jwt
from joserfc.jwk import OctKey

from teachpath.access.access import Access
from teachpath.access.attempts import MAX_FROM_ADDRESS
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.provider_sign_in import LIFE, open_provider
from teachpath.access.settings import AuthSettings, OidcSettings
from teachpath.errors import Conflict, NotAllowed, NotSignedIn, TooManyAttempts, Unreachable, UnusableSettings
from teachpath.io.identity_provider import KEY_SET_LIFETIME
from teachpath.records import Capability, Person
from tests.identity_provider import CLIENT, SECRET, EmulatedProvider, new_key, running
from tests.unit.access.provider_lab import CLIENT_ADDRESS, NOW_NS, NS, PAGE, Lab


@pytest.fixture(scope="module")
def running_provider() -> Iterator[EmulatedProvider]:
    with running() as provider:
        yield provider


@pytest.fixture
def provider(running_provider: EmulatedProvider) -> EmulatedProvider:
    running_provider.reset()
    return running_provider


@pytest.fixture
def settings(provider: EmulatedProvider, tmp_path: Path) -> OidcSettings:
    secret = tmp_path / "client"
    secret.write_text(f"{SECRET}\n")
    secret.chmod(0o600)
    groups = {"teach": ("teachers",), "operate": ("operators",)}
    return OidcSettings("Lab", provider.issuer, CLIENT, str(secret), **groups)  # type: ignore[arg-type]


@pytest.fixture
def lab(provider: EmulatedProvider, settings: OidcSettings) -> Lab:
    return Lab(provider, settings)


def test_roles_are_those_of_the_last_sign_in_and_the_name_is_the_first(lab: Lab) -> None:
    secret, subject = lab.sign_in()
    assert (subject.name, Capability.TEACH in subject.capabilities) == ("anna", True)
    lab.provider.person |= {"groups": ["operators"], "preferred_username": "otto"}
    assert lab.sign_in()[1].name == "anna"
    for refresh in (lambda: None, lab.access.refresh):
        refresh()
        subject = lab.access.subject([], secret)
        assert (Capability.OPERATE in subject.capabilities, Capability.TEACH in subject.capabilities) == (True, False)
    lab.now += 601
    with pytest.raises(NotSignedIn, match="has ended"):
        lab.access.subject([], secret)


def test_who_signs_in_while_people_are_read_is_known_all_the_same(lab: Lab) -> None:
    """The table is read before the person signs in, and what was read counts after."""
    secrets: list[str] = []

    class Slow(MemoryPeople):
        def all(self) -> list[Person]:
            found = super().all()
            if not secrets:
                secrets.append("")
                secrets[0] = sign_ins.sign_in_from_provider(anna)[0]
            return found

    now_ns = round(lab.now * NS)
    anna = Person("anna", (Capability.VIEW,), "", now_ns, now_ns, "https://lab.example", "1")
    oidc = OidcSettings(issuer="https://lab.example", client_id="x", view=("lab",))
    access = Access(AuthSettings("oidc"), MemoryTokens(), Slow(), lambda: now_ns, oidc, open_provider("oidc", oidc))
    sign_ins = access.sessions
    access.refresh()
    assert access.subject([], secrets[0]).name == "anna"


def test_people_with_passwords_and_those_of_another_provider_have_no_session_here(lab: Lab) -> None:
    secret, _ = lab.sign_in()
    passwords = Access(AuthSettings("token"), MemoryTokens(), lab.people, lambda: round(lab.now * NS))
    passwords.refresh()
    with pytest.raises(NotSignedIn):
        passwords.subject([], secret)
    with pytest.raises(NotSignedIn):
        passwords.sessions.sign_in("anna", "", CLIENT_ADDRESS)
    assert lab.access.subject([], secret).name == "anna"
    assert len(lab.people.sessions()) == 1  # of another station on the same database


def test_keys_are_changed_while_the_station_runs(lab: Lab) -> None:
    assert lab.sign_in()
    lab.provider.keys.append(new_key("second"))
    assert lab.sign_in()
    lab.now += KEY_SET_LIFETIME
    lab.provider.keys[:] = [new_key("third")]
    assert lab.sign_in()


@pytest.mark.parametrize("methods", [["client_secret_post"], ["client_secret_basic", "client_secret_post"]])
def test_the_client_shows_its_secret_as_the_provider_wants_it(lab: Lab, methods: list[str]) -> None:
    lab.provider.metadata["token_endpoint_auth_methods_supported"] = methods
    assert lab.sign_in()


# attacks


def shared_secret(claims: dict[str, Any]) -> str:
    return jwt.encode({"alg": "HS256"}, claims, OctKey.import_key(SECRET))


def unsigned(claims: dict[str, Any]) -> str:
    pieces = (json.dumps(piece).encode() for piece in ({"alg": "none", "kid": "first"}, claims))
    return ".".join(base64.urlsafe_b64encode(piece).rstrip(b"=").decode() for piece in pieces) + "."


def by_another(claims: dict[str, Any]) -> str:
    return jwt.encode({"alg": "ES256", "kid": "first"}, claims, new_key("first"))


def by_its_own_key(claims: dict[str, Any]) -> str:
    key = new_key("first")
    return jwt.encode({"alg": "ES256", "kid": "first", "jwk": key.as_dict(private=False)}, claims, key)


@pytest.mark.parametrize(
    ("claims", "sentence"),
    [
        ({"nonce": "of another sign-in"}, "nonce"),
        ({"nonce": None}, "nonce"),
        ({"aud": "another program"}, "aud"),
        ({"aud": None}, "aud"),
        ({"aud": [CLIENT, "another program"]}, "made for another program"),
        ({"azp": "another program"}, "made for another program"),
        ({"iss": "https://elsewhere.example"}, "iss"),
        ({"iss": None}, "iss"),
        ({"exp": NOW_NS - 60}, "expired"),
        ({"exp": None}, "exp"),
        ({"exp": "tomorrow"}, "exp"),
        ({"iat": NOW_NS + 61}, "in the future"),
        ({"nbf": NOW_NS + 61}, "not yet valid"),
        ({"sub": None}, "sub"),
        ({"sub": ""}, "sub"),
        ({"sub": 7}, "sub"),
        ({"sub": "x" * 300}, "does not say who this is"),
    ],
)
def test_a_token_that_is_not_for_this_sign_in(lab: Lab, claims: dict[str, Any], sentence: str) -> None:
    lab.provider.claims = claims
    with pytest.raises(NotSignedIn, match=sentence):
        lab.sign_in()
    assert lab.people.sessions() == []


@pytest.mark.parametrize(
    "sign", [shared_secret, unsigned, by_another, by_its_own_key, lambda _: "no.token.at-all", lambda _: ""]
)
def test_a_token_that_the_provider_has_not_signed(lab: Lab, sign: Callable[[dict[str, Any]], str]) -> None:
    lab.provider.sign = sign
    with pytest.raises(NotSignedIn, match="cannot be believed"):
        lab.sign_in()


@pytest.mark.parametrize("change", ["state", "code", "issuer"])
def test_an_answer_that_is_not_for_this_sign_in(lab: Lab, change: str) -> None:
    answer, secret = lab.visited()
    with pytest.raises(NotSignedIn, match="sign in again"):
        lab.sign_ins.finish(replace(answer, **{change: "https://elsewhere.example"}), secret)


def test_an_answer_in_another_browser_opens_nothing_and_spoils_nothing(lab: Lab) -> None:
    answer, secret = lab.visited()
    for other in ("", "x", secret + "x", "x" * 500, lab.visited()[1]):
        with pytest.raises(NotSignedIn, match="sign in again"):
            lab.sign_ins.finish(answer, other)
    assert lab.sign_ins.finish(answer, secret)
    with pytest.raises(NotSignedIn, match="finished already"):
        lab.sign_ins.finish(answer, secret)


def test_a_code_of_another_sign_in_opens_nothing(lab: Lab) -> None:
    """Whoever has stolen a code puts it into a sign-in of his own: it was asked for with another verifier."""
    stolen = lab.visited()[0].code
    answer, secret = lab.visited()
    with pytest.raises(NotSignedIn, match="invalid_grant"):
        lab.sign_ins.finish(replace(answer, code=stolen), secret)


def test_a_provider_that_names_itself_has_to_do_it_always(lab: Lab) -> None:
    lab.provider.metadata["authorization_response_iss_parameter_supported"] = True
    with pytest.raises(NotSignedIn, match="somebody else than Lab"):
        lab.sign_in()
    lab.provider.answer = {"iss": lab.provider.issuer}
    assert lab.sign_in()


def test_a_sign_in_takes_so_long_and_no_longer(lab: Lab) -> None:
    answer, secret = lab.visited()
    lab.now += LIFE
    with pytest.raises(NotSignedIn, match="has taken longer than 600 s"):
        lab.sign_ins.finish(answer, secret)


def test_sign_ins_that_nobody_finishes_are_limited(lab: Lab) -> None:
    lab.sign_in()
    lab.sign_in()
    for _ in range(MAX_FROM_ADDRESS):
        lab.sign_ins.begin(PAGE, CLIENT_ADDRESS)
    with pytest.raises(TooManyAttempts, match="try again in"):
        lab.sign_ins.begin(PAGE, CLIENT_ADDRESS)
    assert lab.sign_ins.begin(PAGE, "10.0.0.7")


# who it is


@pytest.mark.parametrize("groups", [[], None, "lab", ["lab", "TEACHERS", "teachers2"], {"teachers": 1}, 7, [7, None]])
def test_who_is_in_no_group_of_the_station_is_refused(lab: Lab, groups: Any) -> None:
    lab.provider.person["groups"] = groups
    with pytest.raises(NotAllowed, match="has a role here"):
        lab.sign_in()
    assert lab.people.all() == []


@pytest.mark.parametrize("name", ["", "Anna Maria", "a/b", "<b>", None, ["anna"], "@lab.example", "x" * 65])
def test_a_name_that_cannot_be_one_is_refused(lab: Lab, name: Any) -> None:
    lab.provider.person["preferred_username"] = name
    with pytest.raises(NotAllowed, match="cannot name a person"):
        lab.sign_in()


def test_nobody_takes_the_name_of_somebody_else(lab: Lab) -> None:
    lab.sign_in()
    lab.provider.person |= {"sub": "another", "preferred_username": "anna@elsewhere.example"}
    with pytest.raises(Conflict, match="the name 'anna' is taken"):
        lab.sign_in()
    lab.provider.person["preferred_username"] = "otto@lab.example"
    assert lab.sign_in()[1].name == "otto"


# a provider that is away, or wrong


@pytest.mark.parametrize(
    ("metadata", "changes", "sentence"),
    [
        ({}, {"issuer": "http://127.0.0.1:9"}, "does not answer at 127.0.0.1:9"),
        ({}, {"issuer": "{issuer}/elsewhere"}, "answers 400"),
        ({"issuer": "https://elsewhere.example"}, {}, "says that it is 'https://elsewhere.example'"),
        ({"token_endpoint": "http://elsewhere.example/token"}, {}, "token_endpoint is"),
        ({"authorization_endpoint": "javascript:alert(1)"}, {}, "authorization_endpoint is"),
        ({"jwks_uri": None}, {}, "jwks_uri is"),
        ({"jwks_uri": "{issuer}/nowhere"}, {}, "answers 400"),
        ({"jwks_uri": "{issuer}/.well-known/openid-configuration"}, {}, "keys that cannot be read"),
        ({}, {"client_secret_file": ""}, "invalid_client"),
    ],
)
def test_a_provider_that_is_away_or_wrong_is_named(
    provider: EmulatedProvider, settings: OidcSettings, metadata: Any, changes: Any, sentence: str
) -> None:
    filled = {name: text and text.replace("{issuer}", provider.issuer) for name, text in metadata.items()}
    changes = {name: text.replace("{issuer}", provider.issuer) for name, text in changes.items()}
    provider.metadata = filled
    with pytest.raises(Unreachable, match="^Lab .*" + sentence):
        Lab(provider, replace(settings, **changes)).sign_in()


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"issuer": ""}, "oidc.issuer is empty"),
        ({"client_id": ""}, "oidc.client_id is empty"),
        ({"issuer": "http://lab.example"}, "should be https://HOST"),
        ({"issuer": "https://lab.example/?x"}, "should be https://HOST"),
        ({"teach": (), "operate": ()}, "no group has a role"),
        ({"client_secret_file": "nowhere"}, "cannot read 'nowhere'"),
        ({"client_secret_file": "SHARED"}, "others may read or write"),
        ({"authorities": "SHARED"}, "no certificates in PEM"),
    ],
)
def test_settings_that_cannot_work_are_refused(
    settings: OidcSettings, tmp_path: Path, changes: dict[str, Any], sentence: str
) -> None:
    shared = tmp_path / "shared"
    shared.write_text("secret")
    shared.chmod(0o644)
    wrong = {name: str(shared) if value == "SHARED" else value for name, value in changes.items()}
    with pytest.raises(UnusableSettings, match=sentence):
        open_provider("oidc", replace(settings, **wrong))
