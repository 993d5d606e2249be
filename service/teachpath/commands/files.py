"""import, export and report: work on the data folder itself."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from teachpath.commands.options import Config, Data, settings_of
from teachpath.commands.work import progress_bar
from teachpath.config import Settings
from teachpath.errors import UnusableInput, UnusableRecording


def import_(
    task: Annotated[str, typer.Argument(help="Task to add demonstrations to; made when missing.")],
    file: Annotated[list[Path], typer.Argument(help="Files to import.")],
    format: Annotated[
        str,
        typer.Option(help="csv or npy (t,x,y,z[,qw,qx,qy,qz]; csv also what export wrote), robottasks (.npy), mcap."),
    ] = "",
    units: Annotated[str, typer.Option(help="Of the positions: m, cm, mm or in; robottasks is in cm.")] = "",
    rate: Annotated[float, typer.Option(help="[Hz] for a format without a clock.")] = 50.0,
    scene: Annotated[str, typer.Option(help="Scene of a new task.")] = "empty",
    calibration: Annotated[str, typer.Option(help="Mapping of the file's frame to the world.")] = "",
    object_at_grasp: Annotated[
        bool, typer.Option("--object-at-grasp", help="Of a new task: each motion begins at its object, wherever it is.")
    ] = False,
    config: Config = None,
    data: Data = None,
) -> None:
    """Make demonstrations from files.

    Every motion in a file becomes one, with the same verdict as a live recording. The service need not run.
    """
    from teachpath.io.store.store import Store
    from teachpath.offline.importing import Source, import_file
    from teachpath.recorder.calibrations import Calibrations

    settings = settings_of(config, data)
    robottasks = format == "robottasks"
    store = Store(settings.store)
    try:
        calibrations = Calibrations(store, settings.recording, settings.calibrations, settings.scene)
        chosen = calibrations.get(calibration or ("robottasks" if robottasks else "identity"))
        for each in file:
            try:
                content = each.read_bytes()
            except OSError as error:
                raise UnusableRecording(f"cannot read {each}: {error.strerror}") from None
            kind = format or (each.suffix[1:] if each.suffix in (".mcap", ".npy") else "csv")
            source = Source(each.name, content, kind, units or ("cm" if robottasks else "m"), rate)
            made = import_file(
                store,
                settings.recording,
                source,
                task=task,
                scene=settings.scene(scene),
                calibration=chosen,
                limits=settings.imports,
                object_at_grasp=object_at_grasp,
            )
            for d, _ in made:
                print(f"{task} {d.number}: {d.samples} samples, {d.duration:.2f} s, {d.verdict} ({d.id})")
    finally:
        store.close()


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
