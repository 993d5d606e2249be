"""store: the database of a station."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Json
from teachpath.commands.printing import print_answer

app: typer.Typer = typer.Typer(help="The database of a station.", no_args_is_help=True)


@app.callback()
def store() -> None:
    """Keep `copy` a command of its own name."""


@app.command()
def copy(
    source: Annotated[str, typer.Argument(metavar="FROM", help="Data folder, or URL of a database.")],
    target: Annotated[str, typer.Argument(metavar="TO", help="Data folder, or URL of a database without rows.")],
    json_: Json = False,
) -> None:
    """Copy all rows from one database into an empty one, compared by their counts and hashes.

    A URL is as in the setting store.database, e.g. postgresql+psycopg://user@host/teachpath. Recordings stay in the
    data folder, which is used with either database. Stop the service first.
    """
    from teachpath.config import Settings
    from teachpath.io.store.copying import copy_rows, without_password
    from teachpath.io.store.database_files import database_url, make_data_folder
    from teachpath.io.store.settings import StoreSettings
    from teachpath.offline.lock import StationLock

    urls = []
    with ExitStack() as locks:
        for place in (source, target):
            settings = StoreSettings(data_dir=place)
            if "://" not in place:
                locks.enter_context(StationLock(make_data_folder(settings)))
            urls.append(place if "://" in place else database_url(settings))
        counts = copy_rows(*urls)
    for place in (source, target):
        if "://" not in place:
            said = f"copy all rows from {without_password(source)} to {without_password(target)}"
            note(Settings(store=StoreSettings(data_dir=place)), said)
    total = sum(counts.values())
    tables = [f"{count:8} {name}" for name, count in counts.items()]
    print_answer({"rows": total, "tables": counts}, *tables, f"{total:8} rows, the same in both", json_=json_)
