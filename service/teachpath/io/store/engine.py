"""The way to the database: an engine, tuned to its kind and migrated to the newest tables."""

from __future__ import annotations

import sqlite3
from typing import Any, Final

from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory
from alembic.script.revision import ResolutionError
from alembic.util import CommandError
from sqlalchemy import Connection, Engine, create_engine, event, func, select
from sqlalchemy.engine import ExceptionContext
from sqlalchemy.exc import ArgumentError, DBAPIError
from sqlalchemy.orm import Session

from teachpath.errors import StorageUnavailable, UnusableSettings
from teachpath.io.store.faults import database_fault, refused_by_server

BUSY_TIMEOUT: Final = 5.0  # [s] for which one who writes waits for another


def open_engine(url: str) -> Engine:
    """Return an engine of the database at `url`, with every table there.

    Transactions on `engine.execution_options(writing=True)` may write. Whatever the database refuses later is raised as
    StorageUnavailable or Conflict.

    Raises:
        UnusableSettings: `url` is none, or its driver is not installed.
        StorageUnavailable: the database cannot be opened, is damaged, or was made by a newer teachpath.
    """
    engine = _engine_of(url)
    event.listen(engine, "handle_error", _explain)
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


def _engine_of(url: str) -> Engine:
    try:
        return create_engine(url)
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
    if session.get_bind().dialect.name == "postgresql":
        session.execute(select(func.pg_advisory_xact_lock(func.hashtextextended(f"{kind} {name}", 0))))


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
    config = Config()
    config.set_main_option("script_location", "teachpath.io.store:migrations")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        try:
            command.upgrade(config, "head")
        except (CommandError, ResolutionError) as error:
            newest = ScriptDirectory.from_config(config).get_current_head()
            raise StorageUnavailable(
                f"the database {_shown(engine)} was made by a newer teachpath than this one, which knows its tables up "
                f"to {newest} ({error}); update teachpath, or name another folder with --data"
            ) from None
