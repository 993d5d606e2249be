"""doctor: examine the data folder, and mend it."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, settings_of, stored_settings

if TYPE_CHECKING:
    from teachpath.config import Settings
    from teachpath.io.store.store import Store
    from teachpath.offline.findings import Finding


def doctor(
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be mended; change nothing.")] = False,
    json_: Annotated[bool, typer.Option("--json", help="Print one JSON object: data, findings, exit code.")] = False,
    rebuild: Annotated[
        bool,
        typer.Option(
            "--rebuild",
            help="Set the database aside, and make the rows anew from what the recordings say. What is only in the "
            "database is not in the new one: learned paths, plans, jobs, and marks and trims made since.",
        ),
    ] = False,
    scene: Annotated[str, typer.Option(help="Scene of tasks whose scene no row and no file says.")] = "",
    system: Annotated[
        bool, typer.Option("--system", help="Look at the machine instead: what it lacks, and how to get it.")
    ] = False,
    config: Config = None,
    data: Data = None,
) -> None:
    """Examine every recording and row, and mend what can be mended.

    Finds recordings that are missing, moved, damaged, edited, doubled, cut off or without a row, rows that contradict
    themselves, and temporary files of processes that were killed. Nothing is deleted but temporary files. It may be
    stopped at any moment and run again. Stop the service first.

    Exit code: 0 everything is whole, or was mended; 1 it could not examine the folder; 3 a dry run found faults that
    the doctor mends; 4 a fault is left that somebody must see to, and the sentence says how.
    With --system: 0 nothing is lacking; 4 something is.
    """
    if system:
        raise typer.Exit(_examine_system(config, data, json_))
    from teachpath.offline.doctor import examine
    from teachpath.offline.findings import exit_code
    from teachpath.robot.scenes import Scenes

    settings = stored_settings(config, data)
    folder = Path(settings.store.data_dir).absolute()
    with _opened(settings, dry_run=dry_run, rebuild=rebuild) as store:
        known = Scenes(store.scenes, settings.scenes)
        if scene:
            known.get(scene)
        scenes = {each.name: each for each in known.all()}
        findings = examine(store, settings.recording, scenes, folder, mend=not dry_run, default_scene=scene)
    if not dry_run:
        note(settings, f"doctor{' --rebuild' if rebuild else ''}: {len(findings)} faults found")
    code = exit_code(findings)
    if json_:
        said = {"data": str(folder), "exit_code": int(code), "findings": [asdict(finding) for finding in findings]}
        print(json.dumps(said, indent=2))
    else:
        _print(findings, folder)
    raise typer.Exit(int(code))


def _examine_system(config: Path | None, data: Path | None, json_: bool) -> int:
    from teachpath.io.running_services import running_services
    from teachpath.offline.system_check import examine_system

    settings = settings_of(config, data)
    host, _, port = settings.bus.endpoint.rpartition("/")[2].rpartition(":")
    ports = [("web.port", settings.web.host, settings.web.port)]
    if settings.bus.mode != "client":
        ports.append(("bus.endpoint", host.strip("[]"), int(port)))
    running = [service.url for service in running_services()]
    findings = list(examine_system(Path(settings.store.data_dir), ports, running))
    if json_:
        print(json.dumps([asdict(finding) for finding in findings], indent=2))
    else:
        for finding in findings:
            mark = ("lacks" if finding.needed_by == "station" else "tests") if finding.lacking else "ok"
            print(f"{mark:6}{finding.name}: {finding.sentence}")
    return 4 if any(finding.lacking and finding.needed_by == "station" for finding in findings) else 0


def _print(findings: list[Finding], folder: Path) -> None:
    for finding in findings:
        print(finding.sentence)
    left = sum(not finding.mended for finding in findings)
    if not findings:
        print(f"{folder}: every recording is whole")
    elif left:
        print(f"{folder}: {left} of {len(findings)} faults are left")


@contextmanager
def _opened(settings: Settings, *, dry_run: bool, rebuild: bool) -> Iterator[Store]:
    """Open the store; for a dry run a copy of its database."""
    from teachpath.io.store.database_files import copy_database, database_file, set_database_aside
    from teachpath.io.store.store import Store
    from teachpath.offline.lock import StationLock

    file = database_file(settings.store)
    with tempfile.TemporaryDirectory() as scratch:
        chosen = settings.store
        if file is not None and dry_run:
            copy = Path(scratch) / "copy.sqlite"
            if file.exists() and not rebuild:
                copy_database(file, copy)
            chosen = replace(settings.store, database=f"sqlite:///{copy}")
        elif file is not None and rebuild:
            with StationLock(Path(settings.store.data_dir)):
                set_database_aside(file)
        store = Store(chosen)
        try:
            yield store
        finally:
            store.close()
