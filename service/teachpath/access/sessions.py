"""People who have signed in: their sessions, which end when nothing was asked for a while, and at last anyway."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Final, Protocol

from teachpath.access.attempts import Attempts
from teachpath.access.passwords import is_password
from teachpath.access.settings import AuthSettings
from teachpath.access.tokens import MAX_LENGTH, digest_of, new_secret
from teachpath.errors import NotSignedIn
from teachpath.records import Person, Session, Subject, capabilities_of

NS: Final = 10**9
USE_INTERVAL_NS: Final = 10 * NS  # between two notes of the use of one session
UNKNOWN_PERSON_SENTENCE: Final = (
    "no one of this name and password is known here; try again, or ask whoever administers the station"
)
SESSION_ENDED_SENTENCE: Final = "your session has ended; sign in again"


class PeopleTable(Protocol):
    """Where people and sessions are kept."""

    def all(self) -> list[Person]:
        """Return every person."""

    def register(self, person: Person) -> Person:
        """Keep a person of a provider with the roles that it has now, and return it as it is kept; raises Conflict."""

    def sessions(self) -> list[Session]:
        """Return every session, ended ones too."""

    def begin_session(self, session: Session) -> None:
        """Keep a session."""

    def note_use(self, used: dict[str, int]) -> None:
        """Note when sessions were used, by their digests."""

    def end_sessions(self, digests: list[str]) -> None:
        """Forget sessions."""


class Sessions:
    """Signs people in and out, and tells who they are; safe to use from several threads.

    Args:
        settings: how long a session lasts.
        table: of people and sessions.
        now_ns: the time.
        issuer: address of the provider whose people alone have sessions; empty: people with passwords alone.
    """

    def __init__(
        self,
        settings: AuthSettings,
        table: PeopleTable,
        now_ns: Callable[[], int] = time.time_ns,
        issuer: str = "",
    ) -> None:
        self._settings, self._table, self._now_ns, self._issuer = settings, table, now_ns, issuer
        self._attempts = Attempts(lambda: now_ns() / NS)
        self._people: dict[str, Person] = {}
        self._sessions: dict[str, Session] = {}
        self._lock = threading.Lock()

    @property
    def has_people(self) -> bool:
        """Whether anybody could sign in."""
        return bool(self._people)

    def refresh(self) -> None:
        """Read people and sessions, note which were used, and forget those that have ended."""
        with self._lock:
            former, used = self._people, {digest: s.used_ns for digest, s in self._sessions.items()}
        sessions, everybody = self._table.sessions(), self._table.all()
        # A station on the same database may know people in another way: theirs are neither taken nor ended.
        others = {person.name for person in everybody if person.issuer != self._issuer}
        stored = {session.digest: session for session in sessions if session.person not in others}
        newer = {d: used_ns for d, used_ns in used.items() if d in stored and used_ns > stored[d].used_ns}
        if newer:
            self._table.note_use(newer)
        people = {person.name: person for person in everybody if person.issuer == self._issuer}
        with self._lock:
            # Who has signed in since these were read is not in them, or not with the roles of now.
            new = {name: person for name, person in self._people.items() if former.get(name) is not person}
            self._people = people | new
            for digest in used.keys() - stored.keys():
                self._sessions.pop(digest, None)
            for digest, session in stored.items():
                known = self._sessions.get(digest, session)
                self._sessions[digest] = replace(session, used_ns=max(session.used_ns, known.used_ns))
            ended = [digest for digest in self._sessions if not self._holds(digest)]
            for digest in ended:
                del self._sessions[digest]
        if ended:
            self._table.end_sessions(ended)

    def sign_in(self, name: str, password: str, address: str) -> tuple[str, Subject]:
        """Begin a session, and return its secret with who it is.

        Raises:
            NotSignedIn: name or password is wrong.
            TooManyAttempts: too many have failed.
        """
        self._attempts.begin(name, address)
        person = self._people.get(name)
        if not is_password(password, person.password_hash if person else None) or person is None:
            raise NotSignedIn(UNKNOWN_PERSON_SENTENCE)
        self._attempts.succeed(name, address)
        return self._begin(person)

    def sign_in_from_provider(self, person: Person) -> tuple[str, Subject]:
        """Begin a session of a person whom the provider knows, with the roles that it has now.

        Returns:
            the secret of the session, and who it is: by the name that it had when it signed in first.

        Raises:
            Conflict: it is new here, and somebody else has the name.
        """
        kept = self._table.register(person)
        with self._lock:
            self._people = self._people | {kept.name: kept}
        return self._begin(kept)

    def _begin(self, person: Person) -> tuple[str, Subject]:
        secret, now = new_secret(), self._now_ns()
        session = Session(digest_of(secret), person.name, now, now)
        self._table.begin_session(session)
        with self._lock:
            self._sessions[session.digest] = session
        return secret, self._subject(person, session)

    def sign_out(self, secret: str) -> None:
        """End a session; nothing where there is none."""
        digest = digest_of(secret)
        self._table.end_sessions([digest])
        with self._lock:
            self._sessions.pop(digest, None)

    def subject(self, secret: str) -> Subject:
        """Return who has a session; raises NotSignedIn."""
        if len(secret) > MAX_LENGTH:
            raise NotSignedIn(SESSION_ENDED_SENTENCE)
        digest, now = digest_of(secret), self._now_ns()
        with self._lock:
            session = self._sessions.get(digest)
            if session is None or not self._holds(digest):
                raise NotSignedIn(SESSION_ENDED_SENTENCE)
            if now - session.used_ns > USE_INTERVAL_NS:
                self._sessions[digest] = session = replace(session, used_ns=now)
            return self._subject(self._people[session.person], session)

    def holds(self, digest: str) -> bool:
        """Tell whether a session has not ended."""
        with self._lock:
            return self._holds(digest)

    def _holds(self, digest: str) -> bool:
        session, now = self._sessions.get(digest), self._now_ns()
        return (
            session is not None
            and (person := self._people.get(session.person)) is not None
            and person.changed_ns <= session.created_ns
            and now - session.used_ns < self._settings.session_idle * NS
            and now - session.created_ns < self._settings.session_length * NS
        )

    @staticmethod
    def _subject(person: Person, session: Session) -> Subject:
        return Subject(person.name, capabilities_of(person.roles), session.digest)
