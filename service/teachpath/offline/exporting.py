"""Demonstrations become files: MCAP, CSV, a LeRobot dataset, or an archive of the task; whole or not at all."""

from __future__ import annotations

import csv
import io
import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.sample_files import write_samples
from teachpath.io.store.recording_facts import amended
from teachpath.io.store.store import Store
from teachpath.offline import task_archive
from teachpath.records import Demonstration, Trajectory

DATASETS = ("lerobot", "lerobot-2.1")
FORMATS = ("csv", "mcap", *DATASETS, "trajectory", "archive")
SUFFIXES = {"csv": ".csv", "mcap": ".mcap", "trajectory": "-trajectory.csv"}
PART_SUFFIX = ".part"
Progress = Callable[[float, str], None]


def chosen(store: Store, task: str, *, numbers: Sequence[int] = (), all_: bool = False) -> list[Demonstration]:
    """Return the demonstrations of a task to export: those that are learned from, all of them, or some by number.

    Raises:
        NotFound: there are none.
    """
    stored = store.demonstrations(store.task(task).name)
    if missing := set(numbers) - {d.number for d in stored}:
        raise NotFound(f"task {task} has no demonstration {min(missing)}; it has {len(stored)}")
    found = [d for d in stored if d.number in numbers] if numbers else [d for d in stored if all_ or d.is_usable]
    if not found:
        raise NotFound(f"task {task} has no usable demonstrations to export, of {len(stored)} in all")
    return found


def export_demonstrations(
    store: Store,
    demonstrations: Sequence[Demonstration],
    kind: str,
    into: Path,
    *,
    trajectory: Callable[[Demonstration], Trajectory],
    progress: Progress = lambda fraction, what: None,
) -> list[Path]:
    """Write demonstrations of one task into a folder, which is made when it is missing, and return what was written.

    csv and mcap make a file each, `TASK-NUMBER.csv`, with every sample; trajectory makes a CSV file of the object's
    motion, as `trajectory` gives it; lerobot and lerobot-2.1 make one dataset, the folder `TASK`, and archive one file,
    `TASK.zip` (`task_archive`). What is being written ends in `.part` and is renamed when it is whole; what is there
    already is never overwritten.

    Raises:
        UnusableInput: an unknown format, a folder that cannot be written, or pyarrow is missing.
        Conflict: something of that name is there already.
        UnusableRecording: a recording is damaged.
    """
    if kind not in FORMATS:
        raise UnusableInput(f"format {kind!r} is unknown; known: {', '.join(FORMATS)}")
    first = demonstrations[0]
    try:
        into.mkdir(parents=True, exist_ok=True)
        if kind in DATASETS:
            return [_whole(into / first.task, lambda part: _write_lerobot(store, demonstrations, kind, part, progress))]
        if kind == "archive":
            archive = into / f"{first.task}{task_archive.SUFFIX}"
            return [_whole(archive, lambda part: task_archive.write_archive(store, demonstrations, part, progress))]
        written = []
        for done, d in enumerate(demonstrations):
            progress(done / len(demonstrations), f"demonstration {d.number}")
            content = _content_of(store, d, kind, trajectory)
            file = into / f"{d.task}-{d.number:03d}{SUFFIXES[kind]}"
            written.append(_whole(file, lambda part, content=content: part.write_bytes(content)))  # type: ignore[misc]
    except OSError as error:
        raise UnusableInput(
            f"cannot write into {into}: {error.strerror or error}; free space, or name another folder"
        ) from None
    progress(1.0, "done")
    return written


def _content_of(
    store: Store, demonstration: Demonstration, kind: str, trajectory: Callable[[Demonstration], Trajectory]
) -> bytes:
    """Return the content of a demonstration's file in the format csv, mcap or trajectory.

    csv and mcap say what is thought of the demonstration now: verdict, mark, trim, discarded.
    """
    if kind == "mcap":
        content = store.recordings.content(demonstration.recording, demonstration.digest)
        return amended(content, demonstration)
    if kind == "trajectory":
        return _trajectory_csv(trajectory(demonstration))
    return write_samples(demonstration, store.recordings.samples(demonstration.recording, demonstration.digest))


def _trajectory_csv(trajectory: Trajectory) -> bytes:
    turned = trajectory.orientations
    columns = [trajectory.times[:, None], trajectory.positions] + ([] if turned is None else [turned])
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["t", "x", "y", "z"] + ([] if turned is None else ["qw", "qx", "qy", "qz"]))
    writer.writerows([repr(v) for v in row] for row in np.hstack(columns).tolist())
    return text.getvalue().encode()


def _whole(target: Path, write: Callable[[Path], object]) -> Path:
    """Write to a place beside `target` and rename it; nothing is left of a failure."""
    if target.exists():
        raise Conflict(f"{target} is there already; move it away, or name another folder")
    part = target.with_name(f".{target.name}.{os.getpid()}{PART_SUFFIX}")
    try:
        write(part)
        part.rename(target)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        part.unlink(missing_ok=True)
        raise
    return target


def _write_lerobot(
    store: Store, demonstrations: Sequence[Demonstration], kind: str, root: Path, progress: Progress
) -> None:
    try:
        from teachpath.offline.lerobot_dataset import write_lerobot
    except ModuleNotFoundError as error:
        raise UnusableInput(
            f"the format {kind} needs {error.name}, which is not installed; install it with: pip install "
            "'teachpath[lerobot]'"
        ) from None
    write_lerobot(store, demonstrations, kind, root, progress)
