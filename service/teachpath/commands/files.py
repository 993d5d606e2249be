"""import, export, report and doctor: work on the data folder itself."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from teachpath.commands.options import Config, Data, settings_of
from teachpath.commands.work import progress_bar
from teachpath.errors import UnusableRecording


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
    config: Config = None,
    data: Data = None,
) -> None:
    """Make demonstrations from files.

    Every motion in a file becomes one, with the same verdict as a live recording. The service need not run.
    """
    from teachpath.io.store.store import Store
    from teachpath.offline.importing import Source, import_file
    from teachpath.workers.calibrations import Calibrations

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
                store, settings.recording, source, task=task, scene=settings.scene(scene), calibration=chosen
            )
            for d, _ in made:
                print(f"{task} {d.number}: {d.samples} samples, {d.duration:.2f} s, {d.verdict} ({d.id})")
    finally:
        store.close()


def export(
    what: Annotated[str, typer.Argument(help="A task, or the id of one demonstration.")],
    format: Annotated[
        str, typer.Option(help="csv or mcap (every sample), lerobot (a dataset), trajectory (of the object, as csv).")
    ] = "mcap",
    into: Annotated[Path, typer.Option(help="Folder to write into; made when missing.")] = Path(),
    number: Annotated[list[int] | None, typer.Option(help="Only these demonstrations; may be repeated.")] = None,
    all_: Annotated[bool, typer.Option("--all", help="Also rejected, discarded and bad ones.")] = False,
    config: Config = None,
    data: Data = None,
) -> None:
    """Write demonstrations to files.

    csv and mcap can be imported again without a loss. Nothing is overwritten, and nothing half written stays.
    """
    from teachpath.app import trajectory_of
    from teachpath.io.store.store import Store
    from teachpath.offline.exporting import chosen, export_demonstrations

    settings = settings_of(config, data)
    store = Store(settings.store)
    try:
        known = what in {task.name for task in store.tasks()}
        rows = chosen(store, what, numbers=number or (), all_=all_) if known else [store.demonstration(what)]
        with progress_bar("exporting") as show:
            trajectory = lambda row: trajectory_of(store, settings, row)  # noqa: E731
            written = export_demonstrations(store, rows, format, into, trajectory=trajectory, progress=show)
        left_out = len(store.demonstrations(what)) - len(rows) if known and not number else 0
    finally:
        store.close()
    for file in written:
        print(file)
    if left_out:
        print(f"{left_out} rejected, discarded or bad ones are left out; --all writes them too", file=sys.stderr)


def report(
    run: Annotated[str, typer.Argument(help="Id of a learning run, or a task: its newest run.")],
    into: Annotated[Path | None, typer.Option(help="File to write; RUN.html without it.")] = None,
    config: Config = None,
    data: Data = None,
) -> None:
    """Write a review package: one HTML file about a learning run.

    It holds the animated 3-D scene, tables and plots, opens in any browser without the service, and fetches nothing.
    """
    import numpy as np

    from teachpath.app import trajectory_of
    from teachpath.io.store.store import Store
    from teachpath.offline.report import review_of, write

    settings = settings_of(config, data)
    store = Store(settings.store)
    try:
        review = review_of(
            store,
            run,
            scene=settings.scene,
            trajectory=lambda row: trajectory_of(store, settings, row),
            motion=settings.motion,
            dwell=settings.executor.dwell,
        )
    finally:
        store.close()
    file = into or Path(f"{run}.html")
    size = write(review, file, home=np.array(settings.motion.home))
    print(f"{file}: {size / 1e6:.1f} MB, {len(review.paths)} paths, {len(review.motions)} of them move")


def doctor(config: Config = None, data: Data = None) -> None:
    """Repair recordings that a crash cut off.

    Says what each of them holds and makes demonstrations of it; the torn files are kept. Stop the service first.
    """
    from teachpath.io.store.store import Store
    from teachpath.offline.doctor import examine

    settings = settings_of(config, data)
    store = Store(settings.store)
    try:
        scenes = {scene.name: scene for scene in settings.scenes}
        findings = examine(store, settings.recording, scenes, Path(settings.store.data_dir))
    finally:
        store.close()
    for finding in findings:
        print(finding.sentence)
    if not findings:
        print(f"{settings.store.data_dir}: every recording is whole")
