"""backup, restore and prune: all that a station keeps, in a folder of its own, and what it need not keep."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, Json, settings_of, stored_settings
from teachpath.commands.printing import print_answer, print_json
from teachpath.commands.progress import progress_bar


def backup(
    into: Annotated[Path, typer.Argument(help="New folder to write into.")],
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Copy rows and recordings into a new folder, each file with its SHA-256; the service may run.

    Takes that are under way, and what the doctor has set aside, are left out. Exit code 4: a recording was missing or
    not what was recorded, before the backup; the sentences name them.
    """
    from teachpath.offline.backup import back_up

    settings = stored_settings(config, data)
    with progress_bar("copying") as show:
        made = back_up(settings.store, into, show)
    note(settings, f"back up into {into}: {made.files} files")
    if json_:
        print_json(made)
    else:
        print(f"{into}: {made.files} files, {made.size / 1e6:.1f} MB")
        if made.distant:
            print(f"{made.distant} recordings stay in object storage: back up the bucket by its own means")
        for fault in made.faults:
            print(fault, file=sys.stderr)
    if made.faults:
        raise typer.Exit(4)


def restore(
    source: Annotated[Path, typer.Argument(help="Folder of a backup.")],
    replace: Annotated[bool, typer.Option("--replace", help="Set aside what is in the data folder.")] = False,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Bring a backup back, after every file of it was compared with its SHA-256. Stop the service first.

    Existing data are never overwritten: without --replace only an empty folder is restored to, and with it they are
    kept in a folder beside.
    """
    from teachpath.offline.backup import restore as bring_back

    settings = settings_of(config, data)
    aside = bring_back(source, settings.store, replace=replace)
    note(settings, f"restore {source}{f', what was there is in {aside}' if aside else ''}")
    kept = f"; what was there is in {aside}" if aside else ""
    said = {"data": settings.store.data_dir, "source": str(source), "aside": str(aside) if aside else None}
    print_answer(said, f"{settings.store.data_dir}: restored from {source}{kept}", json_=json_)


def prune(
    older_than: Annotated[float, typer.Option("--older-than", metavar="DAYS", help="Age of what is removed.")],
    executions: Annotated[bool, typer.Option("--executions", help="Also the recordings of executions.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be removed.")] = False,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Remove what doctor and restore have set aside and what imports left, no demonstration. Stop the service first."""
    from teachpath.offline.pruning import prune as removed

    settings = stored_settings(config, data)
    paths = list(removed(Path(settings.store.data_dir), older_than, dry_run=dry_run, executions=executions))
    if not dry_run:
        note(settings, f"prune what is older than {older_than:g} days: {len(paths)} removed")
    if json_:
        print_json([str(path) for path in paths])
        return
    for path in paths:
        print(path)
