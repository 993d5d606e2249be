"""export and report: work on the data folder itself."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from teachpath.commands.options import Config, Data, settings_of
from teachpath.commands.work import progress_bar
from teachpath.config import Settings
from teachpath.errors import UnusableInput


def export(
    what: Annotated[str, typer.Argument(help="A task, or the id of one demonstration; with --report, of a run.")],
    format: Annotated[
        str,
        typer.Option(
            help="csv or mcap (every sample; mcap unless given), lerobot (a dataset), trajectory (the object's, csv)."
        ),
    ] = "",
    into: Annotated[Path, typer.Option(help="Folder to write into; made when missing.")] = Path(),
    number: Annotated[list[int] | None, typer.Option(help="Only these demonstrations; may be repeated.")] = None,
    all_: Annotated[bool, typer.Option("--all", help="Also rejected, discarded and bad ones.")] = False,
    report: Annotated[
        bool, typer.Option("--report", help="Instead the review package of a run, as one HTML file.")
    ] = False,
    config: Config = None,
    data: Data = None,
) -> None:
    """Write demonstrations to files, or the review package of a learning run.

    csv and mcap can be imported again without a loss. Nothing is overwritten, and nothing half written stays.
    """
    settings = settings_of(config, data)
    if report:
        if format or number or all_:
            raise UnusableInput("--report writes a whole run into one file; leave out --format, --number and --all")
        try:
            into.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UnusableInput(f"cannot make {into}: {error.strerror}; give another folder with --into") from None
        _review(what, into / f"{what}.html", settings)
    else:
        _demonstrations(what, format or "mcap", into, numbers=number or (), all_=all_, settings=settings)


def _demonstrations(
    what: str, kind: str, into: Path, *, numbers: Sequence[int], all_: bool, settings: Settings
) -> None:
    from teachpath.app import trajectory_of
    from teachpath.io.store.store import Store
    from teachpath.offline.exporting import chosen, export_demonstrations

    store = Store(settings.store)
    try:
        known = what in {task.name for task in store.tasks()}
        rows = chosen(store, what, numbers=numbers, all_=all_) if known else [store.demonstration(what)]
        with progress_bar("exporting") as show:
            trajectory = lambda row: trajectory_of(store, settings, row)  # noqa: E731
            written = export_demonstrations(store, rows, kind, into, trajectory=trajectory, progress=show)
        left_out = len(store.demonstrations(what)) - len(rows) if known and not numbers else 0
    finally:
        store.close()
    for file in written:
        print(file)
    if left_out:
        print(f"{left_out} rejected, discarded or bad ones are left out; --all writes them too", file=sys.stderr)


def _review(run: str, file: Path, settings: Settings) -> None:
    from teachpath.app import trajectory_of
    from teachpath.io.store.store import Store
    from teachpath.offline.report import review_of, write_package

    store = Store(settings.store)
    try:
        review = review_of(
            store,
            run,
            scene=settings.scene,
            trajectory=lambda row: trajectory_of(store, settings, row),
            motion=settings.motion,
            arm=settings.arm,
            robot=settings.bus.robot,
            dwell=settings.executor.dwell,
        )
    finally:
        store.close()
    size = write_package(review, file)
    print(f"{file}: {size / 1e6:.1f} MB, {len(review.run.learned.paths)} paths, {review.count('motion')} of them move")
