"""The way to the database: an engine, tuned to its kind and migrated to the newest tables."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from sqlalchemy import Connection, Engine, create_engine, event, func, inspect, make_url, select, text
from sqlalchemy.engine import ExceptionContext
from sqlalchemy.exc import ArgumentError, DBAPIError
from sqlalchemy.orm import Session

from teachpath.errors import UnusableSettings
from teachpath.io.store.faults import database_fault, refused_by_server
from teachpath.io.store.tables import NEWEST_REVISION

BUSY_TIMEOUT: Final = 5.0  # [s] for which one who writes waits for another
# How libpq finds out that a server has gone: without these, a cut line would hold a request for many minutes.
LINE_TIMEOUTS: Final = {
    "connect_timeout": 5,
    "keepalives_idle": 5,
    "keepalives_interval": 2,
    "keepalives_count": 3,
    "tcp_user_timeout": 10_000,  # [ms]
}
MIGRATION_LOCK: Final = 0x7465616368  # key of the lock under which one of several services makes the tables


def open_engine(url: str) -> Engine:
    """Return an engine of the database at `url`, with every table there.

    Transactions on `engine.execution_options(writing=True)` may write. Whatever the database refuses later is raised as
    StorageUnavailable or Conflict.

    Raises:
        UnusableSettings: `url` is none, or its driver is not installed.
        StorageUnavailable: the database cannot be opened, is damaged, or was made by a newer teachpath.
    """
    engine = unmigrated_engine(url)
    if engine.dialect.name == "sqlite":
        event.listen(engine, "connect", _tune_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
    try:
        _migrate(engine)
    except (DBAPIError, sqlite3.Error) as error:
        engine.dispose()
        shown = _shown(engine)
        raise database_fault(error, shown) or refused_by_server(error, shown) from None
    except BaseException:
        engine.dispose()
        raise
    return engine


def unmigrated_engine(url: str) -> Engine:
    """Return an engine of the database at `url` as it is, to look at it before another service has left it.

    Raises:
        UnusableSettings: `url` is none, or its driver is not installed.
    """
    engine = _engine_of(url)
    event.listen(engine, "handle_error", _explain)
    return engine


def _engine_of(url: str) -> Engine:
    try:
        known = make_url(url)
        if known.get_backend_name() != "postgresql":
            return create_engine(known)
        # Tried before each use, a connection that a server has closed is replaced and no request fails by it; as many
        # as there are threads, so that none waits for another's.
        timeouts = {name: value for name, value in LINE_TIMEOUTS.items() if name not in known.query}
        return create_engine(known, connect_args=timeouts, pool_pre_ping=True, max_overflow=-1)
    except ModuleNotFoundError as error:
        raise UnusableSettings(
            f"the setting store.database needs {error.name}, which is not installed; for PostgreSQL: pip install "
            "'teachpath[postgres]'"
        ) from None
    except ArgumentError:
        raise UnusableSettings(
            "the setting store.database is no URL of a database, e.g. postgresql+psycopg://user@host/teachpath"
        ) from None


def lock_name(session: Session, kind: str, name: str) -> None:
    """Let no other transaction read and then write what belongs to a name until this one has ended.

    In SQLite, who writes is alone from the beginning of the transaction; a database with a server locks the name.
    """
    if is_served(session.get_bind().engine):
        session.execute(select(func.pg_advisory_xact_lock(func.hashtextextended(f"{kind} {name}", 0))))


def is_served(engine: Engine) -> bool:
    """Return whether the database has a server, on which several services can work."""
    return engine.dialect.name == "postgresql"


def _shown(engine: Engine) -> str:
    return engine.url.database or "" if engine.dialect.name == "sqlite" else engine.url.render_as_string()


def _explain(context: ExceptionContext) -> None:
    error = context.sqlalchemy_exception or context.original_exception
    if context.engine is not None and (fault := database_fault(error, _shown(context.engine))) is not None:
        raise fault from error


def _tune_sqlite(connection: Any, _: Any) -> None:
    connection.isolation_level = None  # transactions begin where _begin_sqlite says
    cursor = connection.cursor()
    # WAL lets readers go on while one writes; NORMAL syncs at checkpoints and survives a killed process.
    timeout = round(1000 * BUSY_TIMEOUT)
    for pragma in (f"busy_timeout={timeout}", "journal_mode=WAL", "synchronous=NORMAL", "foreign_keys=ON"):
        cursor.execute(f"PRAGMA {pragma}")
    cursor.close()


def _begin_sqlite(connection: Connection) -> None:
    # A deferred transaction that reads and then writes fails at once when another has written in between.
    writing = connection.get_execution_options().get("writing", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writing else "BEGIN")


def _migrate(engine: Engine) -> None:
    with _without_foreign_keys(engine) as connection:
        if is_served(engine):
            connection.execute(select(func.pg_advisory_xact_lock(MIGRATION_LOCK)))
        if _version(connection) != NEWEST_REVISION:
            from teachpath.io.store.upgrade import upgrade  # here, because most starts have no use for Alembic

            upgrade(connection, _shown(engine))


def _version(connection: Connection) -> str | None:
    """Return which migration made the tables; None where there are none."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    version: str | None = connection.execute(text("SELECT version_num FROM alembic_version")).scalar()
    return version


@contextmanager
def _without_foreign_keys(engine: Engine) -> Iterator[Connection]:
    """Open a transaction in which tables that others refer to may be made anew.

    To change a column in SQLite, a migration copies its table and drops the old one. With foreign keys, that is
    refused as soon as one row refers to the table; and they can be switched off outside of transactions only.
    """
    with engine.connect() as connection:
        driver: Any = connection.connection.driver_connection
        is_sqlite = engine.dialect.name == "sqlite"
        if is_sqlite:
            driver.execute("PRAGMA foreign_keys=OFF")
        try:
            with connection.begin():
                yield connection
        finally:
            if is_sqlite:
                driver.execute("PRAGMA foreign_keys=ON")
