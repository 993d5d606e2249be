"""Which rows a transaction has changed, told when it is through: here, and by the database to other services."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final

from sqlalchemy import Engine, event, inspect, text
from sqlalchemy.orm import Session

# `changed(table, key)`: called after the transaction, once a row.
Changed = Callable[[str, str], None]
ALL_TOPICS: Final = "all"  # instead of a table: any row may have changed
CHANNEL: Final = "teachpath"  # on which PostgreSQL notifies
NOTIFY: Final = text(f"SELECT pg_notify('{CHANNEL}', told) FROM unnest(CAST(:told AS text[])) AS told")


def unheard(table: str, key: str) -> None:
    """Hear of a changed row and do nothing."""


@contextmanager
def changing(engine: Engine, changed: Changed) -> Iterator[Session]:
    """Open a transaction that writes; when it is through, `changed` hears of its rows, and other services do."""
    writing = engine.execution_options(writing=True)
    with Session(writing, expire_on_commit=False) as session, telling(session, changed), session.begin():
        yield session


@contextmanager
def telling(session: Session, changed: Changed) -> Iterator[None]:
    """Tell, after the block, of every row that `session` has written in it; of none when an error leaves it."""
    session.info["touched"] = {}
    event.listen(session, "after_flush", _note_flushed)
    event.listen(session, "before_commit", _notify)
    yield
    for table, key in session.info["touched"]:
        changed(table, key)


def note(session: Session, table: str, key: str) -> None:
    """Note a row that a statement has changed, past the session's objects."""
    session.info["touched"][table, key] = None


def _note_flushed(session: Session, _: Any) -> None:
    for row in [*session.new, *session.dirty, *session.deleted]:
        note(session, row.__tablename__, str(inspect(row).mapper.primary_key_from_instance(row)[0]))


def _notify(session: Session) -> None:
    """Let the database notify other services as part of the transaction: of all of it, or of nothing."""
    engine = session.get_bind()
    service = engine.get_execution_options().get("service")
    if service is None or engine.dialect.name != "postgresql":
        return
    session.flush()
    if touched := session.info["touched"]:
        session.execute(NOTIFY, {"told": [f"{service} {table} {key}" for table, key in touched]})
