"""People in memory, for tests and for a station that asks nobody."""

from __future__ import annotations

from dataclasses import replace

from teachpath.errors import Conflict
from teachpath.records import Person, Session


class MemoryPeople:
    """A table of people and sessions that nothing survives."""

    def __init__(self) -> None:
        self._people: dict[str, Person] = {}
        self._sessions: dict[str, Session] = {}

    def all(self) -> list[Person]:
        """Return every person."""
        return list(self._people.values())

    def put(self, person: Person) -> None:
        """Keep a person, in the place of one of the name."""
        self._people[person.name] = person

    def register(self, person: Person) -> Person:
        """Keep a person of a provider under its first name, with the roles that it has now; raises Conflict."""
        known = next((p for p in self.all() if (p.issuer, p.subject) == (person.issuer, person.subject)), None)
        taken = next((name for name in self._people if name.lower() == person.name.lower()), "")
        if known is None and taken:
            raise Conflict(f"the name {taken!r} is taken by a person; take another")
        kept = replace(known, roles=person.roles) if known else person
        self.put(kept)
        return kept

    def remove(self, name: str) -> None:
        """Remove a person and all sessions of that person."""
        del self._people[name]
        self.end_sessions([digest for digest, session in self._sessions.items() if session.person == name])

    def sessions(self) -> list[Session]:
        """Return every session."""
        return list(self._sessions.values())

    def begin_session(self, session: Session) -> None:
        """Keep a session."""
        self._sessions[session.digest] = session

    def note_use(self, used: dict[str, int]) -> None:
        """Note when sessions were used."""
        for digest, used_ns in used.items():
            self._sessions[digest] = replace(self._sessions[digest], used_ns=used_ns)

    def end_sessions(self, digests: list[str]) -> None:
        """Forget sessions."""
        for digest in digests:
            self._sessions.pop(digest, None)
