"""import: files become demonstrations, in the data folder itself."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.options import Config, Data, settings_of
from teachpath.commands.work import progress_bar
from teachpath.errors import UnusableRecording

if TYPE_CHECKING:
    from teachpath.offline.batch_import import FileOutcome

REJECTED = 3  # exit status: all are stored, and some are rejected
SUFFIXES = (".csv", ".tsv", ".npy", ".npz", ".traj", ".trc", ".tum", ".mcap")  # that are imported of a folder


def import_(
    task: Annotated[str, typer.Argument(help="Task to add demonstrations to; made when missing.")],
    file: Annotated[list[Path], typer.Argument(help="Files to import, or folders of files.")],
    format: Annotated[
        str,
        typer.Option(
            help="csv, npy, npz, matrices (4x4), robottasks (.npy), motive, vicon, trc, tum, euroc, mcap, or of an "
            "installed reader; empty: what the file has."
        ),
    ] = "",
    units: Annotated[str, typer.Option(help="Of the positions: m, cm, mm or in; empty: as the file says.")] = "",
    time: Annotated[str, typer.Option(help="Unit of the clock: s, ms, us or ns; empty: as the file says.")] = "",
    rate: Annotated[float, typer.Option(help="[Hz] for a format without a clock; 0: 50.")] = 0.0,
    columns: Annotated[
        str,
        typer.Option(
            help="Where a table has what, by name or number: t=Time,x=Position.X,y=3,...; also qw, qx, qy, qz, number, "
            "tracked, grasp, flexion."
        ),
    ] = "",
    quaternion: Annotated[str, typer.Option(help="Order of four columns without names: wxyz or xyzw.")] = "",
    track: Annotated[str, typer.Option(help="Which body or marker, of a file with several.")] = "",
    grasp: Annotated[float | None, typer.Option(help="[s] at which the object is taken; 0: the file begins.")] = None,
    release: Annotated[float | None, typer.Option(help="[s] at which it is put.")] = None,
    whole: Annotated[bool, typer.Option("--whole", help="All of every motion is the transport.")] = False,
    scene: Annotated[str, typer.Option(help="Scene of a new task.")] = "",
    calibration: Annotated[str, typer.Option(help="Of the file's frame; empty: that of the task, or identity.")] = "",
    object_at_grasp: Annotated[
        bool, typer.Option("--object-at-grasp", help="Of a new task: each motion begins at its object, wherever it is.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be made of the files.")] = False,
    config: Config = None,
    data: Data = None,
) -> None:
    """Make demonstrations from files, all of them or none.

    Every motion in a file becomes one, with the same verdict as a live recording. Its transport is told by columns of
    flexions or grasp, by --grasp and --release, or by where the hand dwells. A killed import goes on when the same
    command is given again. The service need not run. Exit status: 0, 1 (nothing stored), 3 (some are rejected).
    """
    from teachpath.io.readers.contract import ReadOptions
    from teachpath.io.readers.registry import check_options
    from teachpath.io.store.store import Store
    from teachpath.jobs.limited_process import LimitedProcess
    from teachpath.offline.batch_import import import_batch
    from teachpath.offline.import_job import ImportOrder
    from teachpath.offline.import_target import import_calibration, import_scene, starts_at_object
    from teachpath.offline.track_samples import PhaseMarks
    from teachpath.recorder.calibrations import Calibrations

    settings = settings_of(config, data)
    options = ReadOptions(units, time, rate, columns, quaternion, track)
    check_options("import", format, options)
    files = _files(file)
    store, process = Store(settings.store), LimitedProcess(settings.jobs)
    try:
        calibrations = Calibrations(store, settings.recording, settings.calibrations, settings.scene)
        order = ImportOrder(
            "",
            Path(),
            task,
            "",
            format,
            options,
            PhaseMarks(grasp, release, whole),
            settings.scene(import_scene(store, task, scene)),
            import_calibration(store, calibrations, task, format, calibration),
            settings.recording,
            settings.imports,
            starts_at_object(store, task, object_at_grasp),
        )
        with progress_bar("importing") as show:
            folder = Path(settings.store.data_dir)
            outcomes = import_batch(store, folder, files, order, call=process.call, progress=show, dry_run=dry_run)
    finally:
        process.stop()
        store.close()
    _report(task, outcomes, dry_run=dry_run)


def _files(given: Sequence[Path]) -> list[Path]:
    found: list[Path] = []
    for path in given:
        if not path.is_dir():
            found.append(path)
            continue
        inside = sorted(file for file in path.iterdir() if file.is_file() and file.suffix.lower() in SUFFIXES)
        if not inside:
            raise UnusableRecording(
                f"{path} holds no files that end in {', '.join(SUFFIXES)}; name the files themselves"
            )
        others = sum(1 for file in path.iterdir()) - len(inside)
        if others:
            print(f"{path}: {len(inside)} files; {others} with other endings are left out", file=sys.stderr)
        found += inside
    return found


def _report(task: str, outcomes: Sequence[FileOutcome], *, dry_run: bool) -> None:
    """Say what became of each file, and leave with the exit status."""
    refused = [outcome for outcome in outcomes if outcome.refusal]
    if len(outcomes) == 1 and refused:
        raise UnusableRecording(refused[0].refusal)
    for outcome in outcomes:
        if outcome.refusal:
            print(f"{outcome.file}: cannot be used: {outcome.refusal}")
            continue
        if outcome.understood:
            print(f"{outcome.file}: {'; '.join(outcome.understood)}")
        for d in outcome.made:
            where = f"{outcome.file}" if dry_run else f"{task} {d.number}"
            told = (*d.reasons, *d.statistics.notes)
            reasons = f": {'; '.join(told)}" if told else ""
            print(f"{where}: {d.samples} samples, {d.duration:.2f} s, {d.verdict}{reasons} ({d.id})")
    if refused:
        raise UnusableRecording(f"nothing was imported: {len(refused)} of {len(outcomes)} files cannot be used")
    verdicts = Counter(str(d.verdict) for outcome in outcomes for d in outcome.made)
    summary = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())
    print(
        f"{len(outcomes)} files, {verdicts.total()} demonstrations: {summary}"
        + (" (nothing stored)" if dry_run else "")
    )
    if verdicts["reject"]:
        raise typer.Exit(REJECTED)
