"""People who sign in, with a password or at a provider, and their sessions."""

from __future__ import annotations

from sqlalchemy import ColumnElement, Engine, delete, func, select, update
from sqlalchemy.orm import InstrumentedAttribute
from sqlalchemy.orm import Session as Transaction

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.engine import lock_name
from teachpath.io.store.tables import AccessTokenRow, PersonRow, SessionRow
from teachpath.records import Capability, Person, Session

NAMES = "name of access"  # of people and tokens: none is used twice, nor in other letters, large or small


class People:
    """The people of a station; safe to use from several threads."""

    def __init__(self, engine: Engine) -> None:
        self._engine, self._writing = engine, engine.execution_options(writing=True)

    def all(self) -> list[Person]:
        """Return every person, by name."""
        with Transaction(self._engine) as transaction:
            return [_person_of(row) for row in transaction.scalars(select(PersonRow).order_by(PersonRow.name))]

    def add(self, person: Person) -> None:
        """Keep a person; raises Conflict when somebody or a token that holds has the name."""
        with Transaction(self._writing) as transaction, transaction.begin():
            lock_name(transaction, NAMES, person.name.lower())
            _add(transaction, person)

    def register(self, person: Person) -> Person:
        """Keep a person of a provider with the roles that it has now, under the name that it had first.

        Returns:
            the person as it is kept.

        Raises:
            Conflict: it is new here, and somebody else or a token that holds has the name.
        """
        same = select(PersonRow).where(PersonRow.issuer == person.issuer, PersonRow.subject == person.subject)
        with Transaction(self._writing) as transaction, transaction.begin():
            lock_name(transaction, NAMES, person.name.lower())
            row = transaction.scalars(same).first()
            if row is None:
                row = _add(transaction, person)
            else:
                row.roles = list(person.roles)
            return _person_of(row)

    def change_password(self, name: str, password_hash: str, now_ns: int) -> None:
        """Give a person another password, and end the sessions of the former; raises NotFound, Conflict."""
        with Transaction(self._writing) as transaction, transaction.begin():
            row = transaction.get(PersonRow, name)
            if row is None:
                raise _missing(name, self.all())
            if row.issuer:
                raise Conflict(f"{name} signs in at {row.issuer}, and has no password here")
            row.password_hash, row.changed_ns = password_hash, now_ns
            transaction.execute(delete(SessionRow).where(SessionRow.person == name))

    def remove(self, name: str) -> None:
        """Remove a person and end all sessions of that person; raises NotFound."""
        with Transaction(self._writing) as transaction, transaction.begin():
            row = transaction.get(PersonRow, name)
            if row is None:
                raise _missing(name, self.all())
            transaction.execute(delete(SessionRow).where(SessionRow.person == name))
            transaction.delete(row)

    def sessions(self) -> list[Session]:
        """Return every session, ended ones too."""
        with Transaction(self._engine) as transaction:
            return [
                Session(row.digest, row.person, row.created_ns, row.used_ns)
                for row in transaction.scalars(select(SessionRow))
            ]

    def begin_session(self, session: Session) -> None:
        """Keep a session; raises NotFound when the person was removed meanwhile."""
        with Transaction(self._writing) as transaction, transaction.begin():
            if transaction.get(PersonRow, session.person) is None:
                raise _missing(session.person, [])
            transaction.add(
                SessionRow(
                    digest=session.digest,
                    person=session.person,
                    created_ns=session.created_ns,
                    used_ns=session.used_ns,
                )
            )

    def note_use(self, used: dict[str, int]) -> None:
        """Note when sessions were used, by their digests [ns]."""
        with Transaction(self._writing) as transaction, transaction.begin():
            for digest, used_ns in used.items():
                transaction.execute(update(SessionRow).where(SessionRow.digest == digest).values(used_ns=used_ns))

    def end_sessions(self, digests: list[str]) -> None:
        """Forget sessions."""
        with Transaction(self._writing) as transaction, transaction.begin():
            transaction.execute(delete(SessionRow).where(SessionRow.digest.in_(digests)))


def looks_like(column: InstrumentedAttribute[str], name: str) -> ColumnElement[bool]:
    """Return the condition that a name differs from another in large and small letters at most."""
    return func.lower(column) == name.lower()


def _add(transaction: Transaction, person: Person) -> PersonRow:
    """Add a person under a name that nobody has; raises Conflict."""
    tokens = select(AccessTokenRow.name).where(
        looks_like(AccessTokenRow.name, person.name),
        AccessTokenRow.revoked_ns == 0,
        AccessTokenRow.expires_ns > person.created_ns,
    )
    people = select(PersonRow.name).where(looks_like(PersonRow.name, person.name))
    if taken := transaction.scalars(people).first() or transaction.scalars(tokens).first():
        raise Conflict(f"the name {taken!r} is taken by a person or a token; take another than {person.name!r}")
    row = PersonRow(
        name=person.name,
        roles=list(person.roles),
        password_hash=person.password_hash,
        created_ns=person.created_ns,
        changed_ns=person.changed_ns,
        issuer=person.issuer,
        subject=person.subject,
    )
    transaction.add(row)
    return row


def _person_of(row: PersonRow) -> Person:
    roles = tuple(Capability(role) for role in row.roles)
    return Person(row.name, roles, row.password_hash, row.created_ns, row.changed_ns, row.issuer, row.subject)


def _missing(name: str, people: list[Person]) -> NotFound:
    known = ", ".join(person.name for person in people) or "none"
    return NotFound(f"there is no person {name!r}; known: {known}")
