"""Who asks: the tokens that hold, in memory, so that no request waits for the database."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from typing import Final, Literal, Protocol

from teachpath.access.provider_sign_in import Provider, ProviderSignIn
from teachpath.access.proxy_people import NOT_FORWARDED, Forwarded, ProxyPeople
from teachpath.access.sessions import PeopleTable, Sessions
from teachpath.access.settings import AuthSettings, OidcSettings, ProxySettings
from teachpath.access.tokens import MAX_LENGTH, digest_of
from teachpath.errors import NotSignedIn
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import AccessToken, Capability, Subject

REFRESH_INTERVAL: Final = 1.0  # [s] after which a token that was made or revoked by another process counts
USE_INTERVAL_NS: Final = 60 * 10**9  # between two notes of the use of one token

UNAUTHENTICATED_SUBJECT: Final = Subject("", frozenset(Capability))  # where the station does not ask
REFUSED_SUBJECT: Final = Subject("not signed in", frozenset())  # a name that no token can have
NO_ADMINISTRATOR_SENTENCE: Final = (
    "auth.mode is token, and there is neither a token that holds nor a person: nobody can do more than stop the arm; "
    "begin with: teachpath person add NAME --role administer"
)


class TokenTable(Protocol):
    """Where tokens are kept."""

    def all(self) -> list[AccessToken]:
        """Return every token, revoked and expired ones too."""

    def note_use(self, used: dict[str, int]) -> None:
        """Note when tokens were used, by their digests."""


class Access:
    """Tells who asks, and tells those who stay when they may stay no longer; safe to use from several threads.

    Args:
        settings: whether it asks at all.
        table: of the tokens.
        people: with passwords or of a provider, and their sessions.
        now_ns: the time.
        oidc: settings of the provider at which people sign in.
        provider: the same; None: people sign in with passwords.
        proxy: what those may do whom a proxy brings.
    """

    def __init__(
        self,
        settings: AuthSettings,
        table: TokenTable,
        people: PeopleTable,
        now_ns: Callable[[], int] = time.time_ns,
        oidc: OidcSettings | None = None,
        provider: Provider | None = None,
        proxy: ProxySettings | None = None,
    ) -> None:
        self.mode: Literal["none", "token", "oidc", "proxy"] = settings.mode
        self.sessions: Sessions = Sessions(settings, people, now_ns, oidc.issuer if oidc and provider else "")
        self.provider: ProviderSignIn | None = None
        if oidc and provider:
            self.provider = ProviderSignIn(oidc, provider, self.sessions, now_ns)
        self.proxy: ProxyPeople | None = ProxyPeople(proxy or ProxySettings()) if settings.mode == "proxy" else None
        self._table, self._now_ns = table, now_ns
        self._tokens: dict[str, AccessToken] = {}
        self._used: dict[str, int] = {}
        self._ends: dict[int, tuple[str, Callable[[], object]]] = {}
        self._lock = threading.Lock()
        self._thread = PeriodicThread("access", REFRESH_INTERVAL, self.refresh)

    def start(self) -> None:
        """Read the tokens now and again; what the database refuses now is raised."""
        if self.has_sessions:
            self.refresh()
            self._thread.start()

    @property
    def has_sessions(self) -> bool:
        """Whether programs show tokens, and people sign in."""
        return self.mode in ("token", "oidc")

    def stop(self) -> None:
        """Read them no more."""
        self._thread.stop()

    def refresh(self) -> None:
        """Read who is known, note what was used, and end what was opened by who is known no longer."""
        self.sessions.refresh()
        with self._lock:
            used, self._used = self._used, {}
        if used:
            self._table.note_use(used)
        tokens = {token.digest: token for token in self._table.all()}
        now = self._now_ns()
        with self._lock:
            self._tokens = tokens
            ends = list(self._ends.values())
        for credential, end in ends:
            if not _holds(tokens.get(credential), now) and not self.sessions.holds(credential):
                end()

    def subject(self, authorization: Sequence[str], session: str = "", forwarded: Forwarded = NOT_FORWARDED) -> Subject:
        """Return who sends a request.

        Args:
            authorization: every header of that name that it has.
            session: secret of a session, in its cookie; a token goes before.
            forwarded: who it is as a proxy says.

        Raises:
            NotSignedIn: nobody who is known; the sentence has the way out.
        """
        if self.mode == "none":
            return UNAUTHENTICATED_SUBJECT
        if self.proxy:
            return self.proxy.subject(forwarded)
        if session and not authorization:
            return self.sessions.subject(session)
        token = self._known(_token_in(authorization))
        now = self._now_ns()
        if token.revoked_ns:
            raise NotSignedIn(f"token {token.name} was revoked on {_date(token.revoked_ns)}; ask for another")
        if not token.holds(now):
            raise NotSignedIn(f"token {token.name} expired on {_date(token.expires_ns)}; ask for another")
        if now - token.used_ns > USE_INTERVAL_NS:
            with self._lock:
                self._used[token.digest] = now
        return Subject(token.name, token.capabilities, token.digest)

    def refusal(self, subject: Subject, lacking: Sequence[Capability]) -> str:
        """Say what a subject may not do, and how it comes to the role that it lacks."""
        may, needed = ", ".join(sorted(subject.capabilities)) or "do nothing", lacking[0]
        way_out = (
            self.proxy.way_out(subject, needed)
            if self.proxy
            else f"whoever administers the station makes a token for it: teachpath token create --role {needed.value}"
        )
        who = subject.name or "whoever this is"
        return f"{who} may {may}, and this needs {' and '.join(lacking)}; {way_out}"

    def call_at_end(self, subject: Subject, end: Callable[[], object]) -> Callable[[], None]:
        """Call `end`, from any thread, when a subject is known no longer; return what forgets that."""
        if not subject.credential:
            return lambda: None
        with self._lock:
            self._ends[id(end)] = subject.credential, end

        def forget() -> None:
            with self._lock:
                self._ends.pop(id(end), None)

        return forget

    def notes(self) -> list[str]:
        """Say what an operator should know."""
        if self.mode != "token":
            return []
        now = self._now_ns()
        somebody = self.sessions.has_people or any(_holds(token, now) for token in self._tokens.values())
        return [] if somebody else [NO_ADMINISTRATOR_SENTENCE]

    def _known(self, token: str) -> AccessToken:
        # Looked up by a hash that nobody can choose: how long that takes says nothing of the tokens that are there.
        known = self._tokens.get(digest_of(token))
        if known is None:
            raise NotSignedIn("this token is not known here, or not yet (it takes a second); ask for another")
        return known


def _token_in(authorization: Sequence[str]) -> str:
    if not authorization:
        raise NotSignedIn(
            "this station wants to know who asks: sign in on its page, or send a token as header Authorization: Bearer "
            "TOKEN; whoever administers it makes one with: teachpath token create"
        )
    scheme, _, token = authorization[0].partition(" ")
    if len(authorization) > 1 or scheme.lower() != "bearer" or not token or len(token) > MAX_LENGTH:
        raise NotSignedIn("the header Authorization, once, should be: Bearer TOKEN")
    return token


def _holds(token: AccessToken | None, now_ns: int) -> bool:
    return token is not None and token.holds(now_ns)


def _date(time_ns: int) -> str:
    return datetime.fromtimestamp(time_ns / 1e9, UTC).strftime("%Y-%m-%d %H:%M UTC")
