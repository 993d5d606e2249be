"""import: files become demonstrations, in the data folder itself."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, Json, opened_store, stored_settings
from teachpath.commands.printing import print_json, verdict_word
from teachpath.commands.progress import progress_bar
from teachpath.commands.references import id_or_words
from teachpath.errors import UnusableRecording

if TYPE_CHECKING:
    from teachpath.config import Settings
    from teachpath.io.import_settings import ImportSettings
    from teachpath.io.store.store import Store
    from teachpath.jobs.limited_process import LimitedProcess
    from teachpath.offline.batch_import import FileOutcome
    from teachpath.offline.file_report import FileReport
    from teachpath.offline.import_job import ImportOrder
    from teachpath.records import Demonstration, Task

REJECTED_EXIT_STATUS = 3  # exit status: all are stored, and some are rejected
FIRST_SECOND = 1.0  # [s] of a motion that a dry run shows
MAX_SHOWN = 5  # points of it
# That are imported of a folder.
SUFFIXES = (
    ".csv", ".tsv", ".npy", ".npz", ".mat", ".hdf5", ".h5", ".traj", ".trc", ".c3d", ".tum", ".mcap", ".db3", ".bag",
    ".parquet",
)  # fmt: skip


Format = Annotated[
    str,
    typer.Option(
        help="csv, npy, npz, mat, hdf5, matrices (4x4), robottasks (.npy), motive, vicon, trc, c3d, tum, euroc, arkit, "
        "rosbag, lerobot, mcap, or of an installed reader; empty: what the file has."
    ),
]
Columns = Annotated[
    str,
    typer.Option(
        help="Where a table has what, by name or number: t=Time,x=Position.X,y=3,...; also qw, qx, qy, qz, number, "
        "tracked, grasp, flexion."
    ),
]
AtGrasp = Annotated[
    bool, typer.Option("--object-at-grasp", help="Of a new task: each motion begins at its object, wherever it is.")
]
Files = Annotated[list[Path], typer.Argument(help="Files to import, folders of files, or one archive of a task (zip).")]


def import_(
    task: Annotated[str, typer.Argument(help="Task to add demonstrations to; made when missing. Any name will do.")],
    file: Files,
    format: Format = "",
    units: Annotated[str, typer.Option(help="Of the positions: m, cm, mm or in; empty: as the file says.")] = "",
    time: Annotated[str, typer.Option(help="Unit of the clock: s, ms, us or ns; empty: as the file says.")] = "",
    rate: Annotated[float, typer.Option(help="[Hz] for a format without a clock; 0: 50.")] = 0.0,
    columns: Columns = "",
    quaternion: Annotated[str, typer.Option(help="Order of four columns without names: wxyz or xyzw.")] = "",
    track: Annotated[str, typer.Option(help="Which body, marker, topic or frame, of a file with several.")] = "",
    grasp: Annotated[float | None, typer.Option(help="[s] at which the object is taken; 0: the file begins.")] = None,
    release: Annotated[float | None, typer.Option(help="[s] at which it is put.")] = None,
    whole: Annotated[bool, typer.Option("--whole", help="All of every motion is the transport.")] = False,
    scene: Annotated[str, typer.Option(help="Scene of a new task.", callback=id_or_words)] = "",
    calibration: Annotated[str, typer.Option(help="Of the file's frame; empty: that of the task, or identity.")] = "",
    object_at_grasp: AtGrasp = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be made of the files.")] = False,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Make demonstrations from files, all of them or none.

    Every motion in a file becomes one, with the same verdict as a live recording. Its transport is told by columns of
    flexions or grasp, by --grasp and --release, or by where the hand dwells. A killed import goes on when the same
    command is given again. The service need not run. Exit status: 0, 1 (nothing stored), 3 (some are rejected).
    """
    from teachpath.io.readers.contract import ReadOptions
    from teachpath.io.readers.registry import check_options
    from teachpath.offline.track_samples import PhaseMarks

    settings = stored_settings(config, data, may_make=True)
    options, marks = ReadOptions(units, time, rate, columns, quaternion, track), PhaseMarks(grasp, release, whole)
    check_options("import", format, options)
    found: Sequence[FileReport] | Sequence[FileOutcome]
    typed, task = task, id_or_words(task)
    called = typed if typed != task else ""
    with _inputs(file, settings.imports) as (files, exported), opened_store(settings) as store:
        if exported:
            scene, object_at_grasp = scene or exported.scene, object_at_grasp or exported.object_at_grasp
            called = called or exported.display_name
        order = _order(store, settings, task, format, scene, calibration, object_at_grasp=object_at_grasp)
        order = replace(order, options=options, marks=marks)
        if dry_run:
            found = reports = _examined(store, settings, files, order)
        else:
            is_new = task not in {each.name for each in store.tasks()}
            found = outcomes = _imported(store, settings, files, order, ", ".join(each.name for each in file))
            if called and is_new:
                store.task_changes.rename(task, task, called)
    if json_:
        print_json([*found])
        raise typer.Exit(_status([each.made for each in found], any(each.refusal for each in found)))
    if dry_run:
        _report_examination(reports)
    else:
        _report(task, outcomes, Path(settings.store.data_dir))


def _order(
    store: Store, settings: Settings, task: str, kind: str, scene: str, calibration: str, *, object_at_grasp: bool
) -> ImportOrder:
    """Return what every file is imported with; the batch gives each its own key, folder and name."""
    from teachpath.io.readers.contract import ReadOptions
    from teachpath.offline.import_job import ImportOrder
    from teachpath.offline.import_target import import_calibration, import_scene, starts_at_object
    from teachpath.offline.track_samples import PhaseMarks
    from teachpath.recorder.calibrations import Calibrations
    from teachpath.robot.scenes import Scenes
    from teachpath.stored_arm import with_stored_arm

    scenes = Scenes(store.scenes, settings.scenes)
    calibrations = Calibrations(store, settings.recording, settings.calibrations, scenes.get)
    return ImportOrder(
        key="",
        folder=Path(),
        task=task,
        name="",
        kind=kind,
        options=ReadOptions(),
        marks=PhaseMarks(),
        scene=scenes.get(import_scene(store, task, scene)),
        calibration=import_calibration(store, calibrations, task, kind, calibration),
        recording=settings.recording,
        limits=settings.imports,
        object_at_grasp=starts_at_object(store, task, object_at_grasp),
        arm=with_stored_arm(settings, store.arms).arm,
    )


def _examined(store: Store, settings: Settings, files: Sequence[Path], order: ImportOrder) -> list[FileReport]:
    """Return what is understood of each file; nothing is stored."""
    from teachpath.offline.file_report import examine_files

    with _reading_process(settings) as process, progress_bar("examining") as show:
        reports = examine_files(files, order, call=process.call, progress=show)
    before = store.imported_files.imported_before
    return [replace(each, imported_before=before(order.task, each.sha256)) for each in reports]


def _imported(
    store: Store, settings: Settings, files: Sequence[Path], order: ImportOrder, named: str
) -> Sequence[FileOutcome]:
    """Import the files and return what became of each; `named` says in the audit log what was given."""
    from teachpath.offline.batch_import import import_batch

    folder = Path(settings.store.data_dir)
    with _reading_process(settings) as process, progress_bar("importing") as show:
        outcomes = import_batch(store, folder, files, order, call=process.call, progress=show)
    if made := sum(len(each.made) for each in outcomes):
        note(settings, f"import into {order.task}: {made} demonstrations of {named}")
    return outcomes


@contextmanager
def _reading_process(settings: Settings) -> Iterator[LimitedProcess]:
    from teachpath.jobs.limited_process import LimitedProcess

    process = LimitedProcess(settings.jobs)
    try:
        yield process
    finally:
        process.stop()


@contextmanager
def _inputs(given: Sequence[Path], limits: ImportSettings) -> Iterator[tuple[list[Path], Task | None]]:
    """Return the files to import, and the task as it was exported where they come from an archive of one."""
    from teachpath.offline.task_archive import SUFFIX, unpacked_archive

    archives = [path for path in given if path.suffix.lower() == SUFFIX]
    if not archives:
        yield _files(given), None
        return
    if len(given) > 1:
        raise UnusableRecording(f"{archives[0]} is an archive: import it alone; a second one into a task of its own")
    with unpacked_archive(archives[0], limits) as unpacked:
        yield list(unpacked.files), unpacked.task


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


def _report_examination(reports: Sequence[FileReport]) -> None:
    """Say what was understood of each file, and leave with the exit status that its import would have."""
    for report in reports:
        if report.understood:
            print(f"{report.file}: {'; '.join(report.understood)}")
        if report.columns:
            print(f"{report.file}: columns {', '.join(report.columns)}")
        if report.times:
            print(f"{report.file}: begins at {_first_second(report)}")
        if report.dwell_times:
            dwells = ", ".join(f"{time:.2f}" for time in report.dwell_times)
            print(f"{report.file}: the hand dwells at {dwells} s; say where it takes and puts: --grasp, --release")
        if report.imported_before:
            print(f"{report.file}: {report.imported_before}")
        if report.refusal:
            print(f"{report.file}: cannot be used: {report.refusal}")
        for made in report.made:
            print(f"{report.file}: {_sentence(made)}")
    refused = [report.refusal for report in reports if report.refusal]
    if len(reports) == 1 and refused:
        raise UnusableRecording(refused[0])
    _summarize([report.made for report in reports], len(refused), "nothing stored")


def _first_second(report: FileReport) -> str:
    shown = [k for k, time in enumerate(report.times) if time - report.times[0] <= FIRST_SECOND]
    chosen = shown[:: max(len(shown) // MAX_SHOWN, 1)][:MAX_SHOWN]
    places = [(report.times[k], ", ".join(f"{c:.3f}" for c in report.positions[k])) for k in chosen]
    return "; ".join(f"{time:.2f} s ({place})" for time, place in places) + " m, world"


def _report(task: str, outcomes: Sequence[FileOutcome], folder: Path) -> None:
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
        for made in outcome.made:
            print(f"{task} {made.number}: {_sentence(made)} ({made.id})")
    _summarize([outcome.made for outcome in outcomes], len(refused), f"in {folder.absolute()}")


def _sentence(made: Demonstration) -> str:
    told = (*made.reasons, *made.statistics.notes)
    return f"{made.samples} samples, {made.duration:.2f} s, {verdict_word(made.verdict)}" + (
        f": {'; '.join(told)}" if told else ""
    )


def _summarize(files: Sequence[Sequence[Demonstration]], refused: int, where: str) -> None:
    if refused:
        raise UnusableRecording(f"nothing was imported: {refused} of {len(files)} files cannot be used")
    verdicts = Counter(verdict_word(made.verdict) for file in files for made in file)
    summary = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())
    print(f"{len(files)} files, {verdicts.total()} demonstrations: {summary}" + f" ({where})")
    if status := _status(files, bool(refused)):
        raise typer.Exit(status)


def _status(files: Sequence[Sequence[Demonstration]], refused: bool) -> int:
    """Return the exit status of an import."""
    rejected = any(made.verdict == "reject" for file in files for made in file)
    return 1 if refused else REJECTED_EXIT_STATUS if rejected else 0
