"""audit: the log of who did what at the station; check it, export it."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.options import Config, Data, Json, stored_settings
from teachpath.commands.printing import print_answer
from teachpath.errors import StorageUnavailable, TeachpathError

if TYPE_CHECKING:
    from teachpath.config import Settings
    from teachpath.io.audit_log import AuditLog

app: typer.Typer = typer.Typer(
    help="Who did what at the station: verify and export the audit log.", no_args_is_help=True
)


@app.command("verify")
def verify(
    noted: Annotated[
        str, typer.Option(help="Hash of an entry that was noted down elsewhere: it has to be there.")
    ] = "",
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Check every entry against the one before, and name the first that is broken.

    Whoever can write the station's files could make a log anew: note down the hash that this prints elsewhere, now and
    again, and give it with --noted.
    """
    log = _log(stored_settings(config, data))
    if fault := log.verify(noted):
        raise StorageUnavailable(f"the audit log is broken: {fault}")
    newest = log.newest()
    said = f"{newest.number} entries are whole; hash of the newest: {newest.hash}" if newest else "no entries yet"
    print_answer(
        {"entries": newest.number if newest else 0, "hash": newest.hash if newest else None}, said, json_=json_
    )


@app.command("export")
def export(config: Config = None, data: Data = None) -> None:
    """Print the entries, oldest first, as lines of JSON."""
    for entry in _log(stored_settings(config, data)).entries():
        print(json.dumps(asdict(entry)))


def note(settings: Settings, action: str) -> None:
    """Write into the audit log what this user did on the command line; where it cannot be written, it is said."""
    import getpass

    from teachpath.io.audit_log import Happening

    if not Path(settings.store.data_dir).is_dir():
        typer.echo(f"not in an audit log: there is no data folder {settings.store.data_dir}", err=True)
        return
    who = f"user {os.getuid()}" if hasattr(os, "getuid") else "user"
    with suppress(KeyError, OSError):
        who = getpass.getuser()
    try:
        _log(settings).append([Happening(who, "command line", action, "done")])
    except TeachpathError as error:
        typer.echo(f"done, but {error}", err=True)


def _log(settings: Settings) -> AuditLog:
    from teachpath.io.audit_log import AuditLog

    return AuditLog(Path(settings.store.data_dir))
