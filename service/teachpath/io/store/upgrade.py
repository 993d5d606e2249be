"""Makes the newest tables of those that a database has, by Alembic."""

from __future__ import annotations

from alembic import command
from alembic.config import Config
from alembic.script import ScriptDirectory
from alembic.script.revision import ResolutionError
from alembic.util import CommandError
from sqlalchemy import Connection

from teachpath.errors import StorageUnavailable


def upgrade(connection: Connection, shown: str) -> None:
    """Run the migrations that a database has not seen, all of them on an empty one.

    Args:
        connection: to the database, in a transaction.
        shown: the database, in a sentence.

    Raises:
        StorageUnavailable: a newer teachpath made its tables.
    """
    config = Config()
    config.set_main_option("script_location", "teachpath.io.store:migrations")
    config.attributes["connection"] = connection
    try:
        command.upgrade(config, "head")
    except (CommandError, ResolutionError) as error:
        newest = ScriptDirectory.from_config(config).get_current_head()
        raise StorageUnavailable(
            f"the database {shown} was made by a newer teachpath than this one, which knows its tables up to {newest} "
            f"({error}); update teachpath, or name another folder with --data"
        ) from None
