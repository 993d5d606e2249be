"""Which rows a transaction has changed, told when it is through."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy import event, inspect
from sqlalchemy.orm import Session

# `changed(table, key)`: called after the transaction, once a row.
Changed = Callable[[str, str], None]


def unheard(table: str, key: str) -> None:
    """Hear of a changed row and do nothing."""


@contextmanager
def telling(session: Session, changed: Changed) -> Iterator[None]:
    """Tell, after the block, of every row that `session` has written in it; of none when an error leaves it."""
    session.info["touched"] = {}
    event.listen(session, "after_flush", _note_flushed)
    yield
    for table, key in session.info["touched"]:
        changed(table, key)


def note(session: Session, table: str, key: str) -> None:
    """Note a row that a statement has changed, past the session's objects."""
    session.info["touched"][table, key] = None


def _note_flushed(session: Session, _: Any) -> None:
    for row in [*session.new, *session.dirty, *session.deleted]:
        note(session, row.__tablename__, str(inspect(row).mapper.primary_key_from_instance(row)[0]))
