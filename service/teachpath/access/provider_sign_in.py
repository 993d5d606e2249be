"""People who sign in at a provider of OpenID Connect: code with PKCE, and which of its groups have which role."""

from __future__ import annotations

import base64
import hashlib
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Protocol
from urllib.parse import urlencode

from teachpath.access.attempts import Attempts
from teachpath.access.proxy_people import listed, roles_of
from teachpath.access.sessions import NS, Sessions
from teachpath.access.settings import OidcSettings
from teachpath.access.tokens import MAX_LENGTH, digest_of, new_secret
from teachpath.errors import NotAllowed, NotSignedIn, UnusableSettings
from teachpath.records import Capability, CodeGrant, Person, Subject
from teachpath_proto.keys import is_name, name_refusal

LIFE: Final = 600.0  # [s] that somebody may take at the provider
MAX_BEGUN: Final = 10_000  # sign-ins that are under way; beyond, the oldest is forgotten
MAX_SUBJECT: Final = 255  # characters of who somebody is at the provider (OpenID Connect Core, 2)
SIGN_IN_SUGGESTION: Final = "sign in again"


class Provider(Protocol):
    """A provider of OpenID Connect."""

    def metadata(self) -> Mapping[str, Any]:
        """Return what it says of itself; raises Unreachable."""

    def claims(self, grant: CodeGrant) -> Mapping[str, Any]:
        """Return what its ID token for a code says; raises NotSignedIn, Unreachable."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What the provider has sent a browser back with.

    Attributes:
        code: for an ID token.
        state: of the sign-in, as the station gave it.
        issuer: who says so (RFC 9207); empty: it is not said.
    """

    code: str
    state: str
    issuer: str = ""


@dataclass(frozen=True, slots=True)
class _Pending:
    """A sign-in that is under way."""

    browser: str  # digest of the secret that the browser has
    redirect_uri: str
    nonce: str
    verifier: str
    address: str
    until_ns: int


class ProviderSignIn:
    """Sends people to the provider, and begins their sessions when they come back; safe to use from several threads.

    Args:
        settings: of the provider, and which of its groups have which role.
        provider: at which they sign in.
        sessions: to begin.
        now_ns: the time.
    """

    def __init__(
        self, settings: OidcSettings, provider: Provider, sessions: Sessions, now_ns: Callable[[], int]
    ) -> None:
        self.name: str = settings.name
        self._settings, self._provider, self._sessions, self._now_ns = settings, provider, sessions, now_ns
        self._attempts = Attempts(lambda: now_ns() / NS)
        self._pending: OrderedDict[str, _Pending] = OrderedDict()  # by the digest of the state
        self._lock = threading.Lock()

    def begin(self, redirect_uri: str, address: str) -> tuple[str, str]:
        """Begin a sign-in.

        Args:
            redirect_uri: to which the provider sends the browser back.
            address: of the browser.

        Returns:
            where the browser is to go, and the secret by which it is known when it comes back.

        Raises:
            Unreachable: the provider does not answer.
            TooManyAttempts: too many sign-ins from the address have not been finished.
        """
        state, nonce, verifier, secret = (new_secret() for _ in range(4))
        self._attempts.begin(state, address)
        metadata = self._provider.metadata()
        begun = _Pending(digest_of(secret), redirect_uri, nonce, verifier, address, self._now_ns() + round(LIFE * NS))
        with self._lock:
            self._pending[digest_of(state)] = begun
            while len(self._pending) > MAX_BEGUN:
                self._pending.popitem(last=False)
        asked = {
            "response_type": "code",
            "client_id": self._settings.client_id,
            "redirect_uri": redirect_uri,
            "scope": " ".join(("openid", *self._settings.scopes)),
            "state": state,
            "nonce": nonce,
            "code_challenge": _challenge(verifier),
            "code_challenge_method": "S256",
        }
        if self._settings.prompt:
            asked["prompt"] = self._settings.prompt
        return f"{metadata['authorization_endpoint']}?{urlencode(asked)}", secret

    def finish(self, answer: Answer, secret: str) -> tuple[str, Subject]:
        """Begin the session of a person who comes back from the provider; each sign-in is finished once.

        Args:
            answer: of the provider.
            secret: by which the browser is known.

        Returns:
            the secret of the session, and who it is.

        Raises:
            NotSignedIn: the sign-in is not this browser's, has taken too long, or the provider does not vouch for it.
            NotAllowed: the person has no role here, or no name that can be used.
            Conflict: somebody else has the name.
            Unreachable: the provider does not answer.
        """
        begun = self._taken(answer.state, secret)
        metadata = self._provider.metadata()
        # Who talks to several providers could be given the code of one as that of another (RFC 9207).
        is_named = answer.issuer or metadata.get("authorization_response_iss_parameter_supported") is True
        if is_named and answer.issuer != metadata["issuer"]:
            raise NotSignedIn(f"somebody else than {self.name} has sent this answer; {SIGN_IN_SUGGESTION}")
        claims = self._provider.claims(CodeGrant(answer.code, begun.redirect_uri, begun.verifier, begun.nonce))
        signed_in = self._sessions.sign_in_from_provider(self._person(claims))
        self._attempts.succeed(answer.state, begun.address)
        return signed_in

    def _taken(self, state: str, secret: str) -> _Pending:
        """Return the sign-in of a state, and forget it; where another browser began it, it stays."""
        if len(secret) > MAX_LENGTH or len(state) > MAX_LENGTH:
            raise NotSignedIn(f"this is no answer to a sign-in of this station; {SIGN_IN_SUGGESTION}")
        with self._lock:
            begun = self._pending.get(digest_of(state))
            if begun is None or begun.browser != digest_of(secret):
                raise NotSignedIn(
                    f"this sign-in is finished already, or was not begun in this browser; {SIGN_IN_SUGGESTION}"
                )
            del self._pending[digest_of(state)]
        if self._now_ns() >= begun.until_ns:
            raise NotSignedIn(f"this sign-in has taken longer than {LIFE:g} s; {SIGN_IN_SUGGESTION}")
        return begun

    def _person(self, claims: Mapping[str, Any]) -> Person:
        subject, now_ns = claims["sub"], self._now_ns()
        if not isinstance(subject, str) or not 0 < len(subject) <= MAX_SUBJECT:
            raise NotSignedIn(f"{self.name} does not say who this is (sub); ask whoever administers it")
        claim = self._settings.name_claim
        name = str(claims.get(claim, "")).partition("@")[0]
        if not is_name(name):
            raise NotAllowed(
                f"{name_refusal('person', name)}; that is claim {claim!r} of the ID token: whoever administers the "
                "station names another with oidc.name_claim"
            )
        groups = claims.get(self._settings.groups_claim, [])
        groups = [groups] if isinstance(groups, str) else groups if isinstance(groups, list) else []
        roles = roles_of(self._settings, groups)
        if not roles:
            raise NotAllowed(
                f"{self.name} knows {name}, but no group of {name} ({self._settings.groups_claim}: {listed(groups)}) "
                "has a role here; whoever administers the station names one with oidc.view, oidc.operate, ..."
            )
        return Person(name, roles, "", now_ns, now_ns, self._settings.issuer, subject)


def open_provider(mode: str, settings: OidcSettings, now: Callable[[], float] = time.time) -> Provider | None:
    """Return the provider that the settings name; None where people sign in elsewhere.

    Args:
        mode: of authentication.
        settings: of the provider.
        now: the time [s since the Unix epoch].

    Raises:
        UnusableSettings: they name no provider, no client or no group.
    """
    if mode != "oidc":
        return None
    from teachpath.io.identity_provider import IdentityProvider, ProviderClient

    for name in ("issuer", "client_id"):
        if not getattr(settings, name):
            raise UnusableSettings(f"auth.mode is oidc, and oidc.{name} is empty: name the provider (docs/access.md)")
    if not any(getattr(settings, role.value) for role in Capability):
        raise UnusableSettings(
            "auth.mode is oidc, and no group has a role, so that nobody could sign in: name groups of the provider "
            'with oidc.view, oidc.operate, ..., e.g. oidc.administer = ["robot-admins"]'
        )
    client = ProviderClient(
        settings.name, settings.issuer, settings.client_id, settings.client_secret_file, settings.authorities
    )
    return IdentityProvider(client, now)


def _challenge(verifier: str) -> str:
    """Return the challenge of a verifier by the method S256 (RFC 7636, 4.2)."""
    return base64.urlsafe_b64encode(hashlib.sha256(verifier.encode()).digest()).rstrip(b"=").decode()
