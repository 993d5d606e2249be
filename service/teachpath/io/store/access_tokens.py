"""The tokens of programs; revoked ones stay, because the journal has their names."""

from __future__ import annotations

from sqlalchemy import Engine, select, update
from sqlalchemy.orm import Session

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.engine import lock_name
from teachpath.io.store.people import NAMES, looks_like
from teachpath.io.store.tables import AccessTokenRow, PersonRow
from teachpath.records import AccessToken, Capability


class AccessTokens:
    """The tokens of a station; safe to use from several threads."""

    def __init__(self, engine: Engine) -> None:
        self._engine, self._writing = engine, engine.execution_options(writing=True)

    def all(self) -> list[AccessToken]:
        """Return every token, oldest first, revoked and expired ones too."""
        question = select(AccessTokenRow).order_by(AccessTokenRow.created_ns, AccessTokenRow.digest)
        with Session(self._engine) as session:
            return [_token_of(row) for row in session.scalars(question)]

    def add(self, token: AccessToken) -> None:
        """Keep a token; raises Conflict when another one of its name holds."""
        with Session(self._writing) as session, session.begin():
            lock_name(session, NAMES, token.name.lower())
            person = session.scalars(select(PersonRow.name).where(looks_like(PersonRow.name, token.name))).first()
            if person:
                raise Conflict(f"a person has the name {person!r}; take another for the token")
            same = session.scalars(select(AccessTokenRow).where(looks_like(AccessTokenRow.name, token.name)))
            if taken := next((row.name for row in same if _token_of(row).holds(token.created_ns)), ""):
                raise Conflict(f"there is a token {taken!r} already; revoke it first, or take another name")
            session.add(
                AccessTokenRow(
                    digest=token.digest,
                    name=token.name,
                    roles=list(token.roles),
                    created_ns=token.created_ns,
                    expires_ns=token.expires_ns,
                    used_ns=token.used_ns,
                    revoked_ns=token.revoked_ns,
                )
            )

    def revoke(self, name: str, now_ns: int) -> AccessToken:
        """Revoke the token of a name that holds, and return it; raises NotFound."""
        with Session(self._writing) as session, session.begin():
            lock_name(session, NAMES, name.lower())
            rows = session.scalars(select(AccessTokenRow).where(AccessTokenRow.name == name)).all()
            row = next((row for row in rows if _token_of(row).holds(now_ns)), None)
            if row is None:
                raise NotFound(f"there is no token {name!r} that holds; known: {_names(self.all(), now_ns)}")
            row.revoked_ns = now_ns
            return _token_of(row)

    def note_use(self, used: dict[str, int]) -> None:
        """Note when tokens were used, by their digests [ns]."""
        with Session(self._writing) as session, session.begin():
            for digest, used_ns in used.items():
                session.execute(update(AccessTokenRow).where(AccessTokenRow.digest == digest).values(used_ns=used_ns))


def _token_of(row: AccessTokenRow) -> AccessToken:
    return AccessToken(
        row.name,
        tuple(Capability(role) for role in row.roles),
        row.digest,
        row.created_ns,
        row.expires_ns,
        row.used_ns,
        row.revoked_ns,
    )


def _names(tokens: list[AccessToken], now_ns: int) -> str:
    return ", ".join(token.name for token in tokens if token.holds(now_ns)) or "none"
