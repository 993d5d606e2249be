"""What was understood of a file, and what would be made of it: looked at before it is imported."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from teachpath.errors import OverLimit, UnusableInput
from teachpath.io.readers.contract import OpenQuestion, OptionNeeded
from teachpath.io.readers.registry import reads_from_disk, recognized
from teachpath.io.readers.tables import EUROC, TABLE, TUM, table_columns
from teachpath.io.sample_files import holds_samples
from teachpath.io.store.recordings import RECORDINGS, Recordings
from teachpath.offline.file_samples import FileSamples
from teachpath.offline.import_job import (
    BEGINNING,
    UPLOAD,
    ImportOrder,
    read_upload,
    record_upload,
    upload_content,
    upload_digest,
)
from teachpath.recording.demonstration import to_world, usable_samples
from teachpath.records import Demonstration, Vector

EXAMINATION_FOLDER: Final = "examined"  # folder beside an upload, removed at once
MAX_POINTS: Final = 400  # of the curve that is shown


@dataclass(frozen=True, slots=True)
class FileReport:
    """What was understood of a file, and what would be made of it.

    Attributes:
        file: its name.
        format: name of its reader; empty: no reader could read it.
        understood: what was taken for time, units, orientation, phases and frame, one phrase each.
        columns: what the columns of a table are called; those without a name by their numbers from 1.
        choices: bodies, markers or topics of which one is read; empty: there is no choice.
        motions: how many there are in it.
        unsure: numbers of those of which it is not known where the object was taken and put, from 1.
        motion: number of the one that is shown.
        dwell_times: where its hand dwells, when that is not known [s].
        grasp: when its object is taken, from the beginning of the motion [s].
        release: likewise, when it is put [s].
        times: of its points, from its beginning [s].
        positions: of these points [m, world].
        made: demonstrations that would be made, with their verdicts.
        refusal: why it cannot be imported as it is, and the way out at the command line; empty: it can.
        question: what of it an answer would mend; null: it is another fault.
        sha256: of the file, hexadecimal.
        imported_before: that the task has demonstrations of the same file, in words; empty: it has none.
    """

    file: str
    format: str = ""
    understood: tuple[str, ...] = ()
    columns: tuple[str, ...] = ()
    choices: tuple[str, ...] = ()
    motions: int = 0
    unsure: tuple[int, ...] = ()
    motion: int = 1
    dwell_times: tuple[float, ...] = ()
    grasp: float | None = None
    release: float | None = None
    times: tuple[float, ...] = ()
    positions: tuple[Vector, ...] = ()
    made: tuple[Demonstration, ...] = ()
    refusal: str = ""
    question: OpenQuestion | None = None
    sha256: str = ""
    imported_before: str = ""


def examine_files(
    files: Sequence[Path],
    order: ImportOrder,
    *,
    call: Callable[..., Any],
    progress: Callable[[float, str], None] = lambda fraction, what: None,
) -> list[FileReport]:
    """Return what was understood of files, in their order; nothing is stored.

    Args:
        order: what all of them have in common; `key`, `folder` and `name` are those of each file.
        call: calls what reads a file, perhaps in another process.
    """
    reports = []
    for number, file in enumerate(files):
        progress(number / len(files), f"{file.name}, {number + 1} of {len(files)}")
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / UPLOAD).symlink_to(file.resolve())
            each = replace(order, key="examination", folder=Path(folder), name=file.name)
            try:
                reports.append(call(examine_upload, each))
            except OverLimit as error:
                reports.append(FileReport(file.name, refusal=str(error)))
    return reports


def examine_upload(order: ImportOrder, motion: int = 1) -> FileReport:
    """Return what was understood of an uploaded file, with one of its motions, or the first; raises NotFound."""
    sha256 = upload_digest(order)
    report = FileReport(order.name, columns=_columns(order), sha256=sha256)
    try:
        read = read_upload(order)
    except OptionNeeded as error:
        choices = error.question.values if error.question.option == "track" else ()
        return replace(report, refusal=str(error), question=error.question, choices=choices)
    except UnusableInput as error:
        return replace(report, refusal=str(error))
    shown = motion if 1 <= motion <= len(read.motions) else 1
    one = read.only(shown)
    times, positions = _curve(one)
    report = replace(
        report,
        format=read.format,
        understood=(*(read.understood or (f"{read.format}: a recording of {read.tracker}",)), _frame(read)),
        choices=read.choices,
        motions=len(read.motions),
        unsure=tuple(number for number, dwells in enumerate(read.dwell_times, 1) if dwells),
        motion=shown,
        dwell_times=one.dwell_times[0] if one.dwell_times else (),
        times=times,
        positions=positions,
    )
    folder = order.folder / EXAMINATION_FOLDER
    try:
        made = tuple(row for row, _ in record_upload(order, read, folder))
        first = made[0]
        if len(read.motions) > 1:  # a motion may have become several
            shutil.rmtree(folder)
            first = record_upload(order, one, folder)[0][0]
        grasp, release = _transport(one, first, folder)
    except UnusableInput as error:
        return replace(report, refusal=str(error))
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return replace(report, made=made, grasp=grasp, release=release)


def _columns(order: ImportOrder) -> tuple[str, ...]:
    if reads_from_disk(order.kind, upload_content(order, BEGINNING), order.name):
        return ()
    content = upload_content(order)
    kind = order.kind or recognized(content, order.name)
    if kind not in (TABLE.name, TUM.name, EUROC.name) or holds_samples(content):
        return ()
    try:
        return table_columns(content, order.name, order.limits)
    except UnusableInput:
        return ()


def _frame(read: FileSamples) -> str:
    name = read.calibration.name
    return "frame: that of the robot" if name == "identity" else f"frame: calibration {name}"


def _curve(read: FileSamples) -> tuple[tuple[float, ...], tuple[Vector, ...]]:
    """Return times (n,) [s] and positions (n, 3) [m, world] of the only motion, evenly thinned out."""
    samples = sorted(usable_samples(read.motions[0]), key=lambda sample: sample.device_ns)
    chosen = np.unique(np.linspace(0, len(samples) - 1, min(len(samples), MAX_POINTS)).round().astype(int))
    begin = _begin(read)
    positions = to_world(read.calibration, np.array([samples[k].position for k in chosen]))
    times = tuple(round((samples[k].device_ns - begin) * 1e-9, 4) for k in chosen)
    return times, tuple((x, y, z) for x, y, z in positions.round(5).tolist())


def _transport(read: FileSamples, row: Demonstration, folder: Path) -> tuple[float, float]:
    """Return when the object of a demonstration is taken and put [s]."""
    begin, end = row.transport
    samples = Recordings(folder / RECORDINGS).samples(row.recording)
    since = _begin(read)
    grasp, release = ((samples[k].device_ns - since) * 1e-9 for k in (begin, end - 1))
    return round(grasp, 4), round(release, 4)


def _begin(read: FileSamples) -> int:
    return min(sample.device_ns for sample in read.motions[0])
