"""All rows of one database into another, compared afterwards by their counts and hashes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from typing import Any, Final

from sqlalchemy import Connection, Engine, Table, func, insert, make_url, select, text

from teachpath.errors import Conflict, StorageUnavailable
from teachpath.io.store.engine import open_engine
from teachpath.io.store.tables import Base

BATCH_SIZE: Final = 500  # rows that are in memory at a time
TABLES: Final[tuple[Table, ...]] = tuple(Base.metadata.sorted_tables)  # each behind those that it names


def copy_rows(source: str, target: str) -> dict[str, int]:
    """Copy every row into an empty database, in one transaction, and return their counts by table.

    Args:
        source: URL of a database; nobody may write it meanwhile.
        target: URL of another, which has no rows.

    Raises:
        Conflict: `target` has rows.
        StorageUnavailable: one of them cannot be opened, or what was written is not what was read.
    """
    with (
        _opened(source) as read,
        _opened(target) as written,
        read.connect() as reading,
        written.execution_options(writing=True).begin() as writing,
    ):
        _require_empty(writing)
        for table in TABLES:
            for batch in _batches(reading, table):
                writing.execute(insert(table), batch)
        _advance_sequences(writing)
        return {table.name: _compared(table, reading, writing) for table in TABLES}


def without_password(place: str) -> str:
    """Return a data folder, or the URL of a database without what may be a password in it."""
    return make_url(place).set(query={}).render_as_string(hide_password=True) if "://" in place else place


@contextmanager
def _opened(url: str) -> Iterator[Engine]:
    engine = open_engine(url)
    try:
        yield engine
    finally:
        engine.dispose()


def _require_empty(connection: Connection) -> None:
    for table in TABLES:
        if count := connection.scalar(select(func.count()).select_from(table)):
            raise Conflict(f"the database to copy to has {count} rows in {table.name} already; name an empty one")


def _batches(connection: Connection, table: Table) -> Iterator[list[dict[str, Any]]]:
    rows = connection.execute(select(table).order_by(*table.primary_key.columns)).mappings()
    while batch := rows.fetchmany(BATCH_SIZE):
        yield [dict(row) for row in batch]


def _compared(table: Table, reading: Connection, writing: Connection) -> int:
    """Return how many rows of a table were copied; raises StorageUnavailable when they are others."""
    (read, expected), (written, found) = _digest(reading, table), _digest(writing, table)
    if found != expected:
        raise StorageUnavailable(
            f"of the {read} rows of {table.name}, {written} were written, or not as they were read; nothing was "
            "copied: look at the database's own log, and copy again"
        )
    return read


def _digest(connection: Connection, table: Table) -> tuple[int, str]:
    """Return how many rows a table has, and the SHA-256 of all of them; databases sort text in orders of their own."""
    hashes: list[bytes] = []
    for batch in _batches(connection, table):
        hashes += [sha256(json.dumps(row, sort_keys=True).encode()).digest() for row in batch]
    return len(hashes), sha256(b"".join(sorted(hashes))).hexdigest()


def _advance_sequences(connection: Connection) -> None:
    """Let numbers that a server gives go on behind those that were copied."""
    if connection.dialect.name != "postgresql":
        return
    for table in TABLES:
        column = table.autoincrement_column
        if column is not None and (newest := connection.scalar(select(func.max(column)))):
            question = text("SELECT setval(pg_get_serial_sequence(:table, :column), :newest)")
            connection.execute(question, {"table": table.name, "column": column.name, "newest": newest})
