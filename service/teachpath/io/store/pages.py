"""Lists a page at a time: an opaque cursor says after which row the next page begins, whatever is added meanwhile."""

from __future__ import annotations

import base64
import binascii
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from sqlalchemy import Select, tuple_
from sqlalchemy.orm import InstrumentedAttribute, Session

from teachpath.errors import UnusableInput

T = TypeVar("T")

DEFAULT_LIMIT: Final = 100
MAX_LIMIT: Final = 500  # entries of one page: an answer takes a fraction of 0.2 s
MAX_CURSOR_LENGTH: Final = 300


@dataclass(frozen=True, slots=True)
class PageRequest:
    """Which page of a list is wanted: at most `limit` entries after a cursor; an empty one is the beginning."""

    limit: int = DEFAULT_LIMIT
    after: str = ""


@dataclass(frozen=True, slots=True)
class Page(Generic[T]):
    """One page of a list; `next` is the cursor of the page after it, empty at the end."""

    entries: list[T]
    next: str = ""


@dataclass(frozen=True)
class Listing:
    """A list with its order.

    Attributes:
        name: of the list; a cursor of another one is refused.
        keys: columns that order it; together they tell its rows apart, and those of a row never change.
        newest_first: descending.
    """

    name: str
    keys: tuple[InstrumentedAttribute[Any], ...]
    newest_first: bool = False

    def read(
        self, session: Session, question: Select[Any], wanted: PageRequest, record_of: Callable[[Any], T]
    ) -> Page[T]:
        """Return one page of the rows of `question` as records; raises UnusableInput for a cursor of no such list."""
        if wanted.after:
            place, end = tuple_(*self.keys), tuple_(*self._decode(wanted.after))
            question = question.where(place < end if self.newest_first else place > end)
        ordered = question.order_by(*(key.desc() if self.newest_first else key for key in self.keys))
        rows = list(session.scalars(ordered.limit(wanted.limit + 1)))
        shown = rows[: wanted.limit]
        return Page([record_of(row) for row in shown], self._encode(shown[-1]) if len(rows) > len(shown) else "")

    def _encode(self, row: Any) -> str:
        document = [self.name, *(getattr(row, key.key) for key in self.keys)]
        return base64.urlsafe_b64encode(json.dumps(document, separators=(",", ":")).encode()).decode().rstrip("=")

    def _decode(self, cursor: str) -> Sequence[Any]:
        try:
            text = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True)
            name, *values = json.loads(text)
        except (binascii.Error, ValueError, TypeError, RecursionError):
            name, values = "", []
        kinds = [key.type.python_type for key in self.keys]
        if name != self.name or [type(value) for value in values] != kinds or not all(map(_fits, values)):
            raise UnusableInput(
                f"after={cursor[:40]} is no cursor of this list; take the one in the header Link of the page before, "
                "or leave it out to begin at the start"
            )
        return list(values)


def _fits(value: object) -> bool:
    """Tell whether a database can compare with a value: integers have 64 bits, texts no NUL and whole characters."""
    if isinstance(value, int):
        return abs(value) < 2**63
    return isinstance(value, str) and "\0" not in value and value.isascii()
