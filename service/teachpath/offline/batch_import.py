"""Many files become demonstrations in one transaction: all of them or none.

The files are copied into a folder of the data, and what is made of each is kept beside it until all are taken over at
once. An import that was killed goes on from there when the same files are imported again.
"""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from teachpath.errors import OverLimit, UnusableInput, UnusableRecording
from teachpath.io.documents import decode, encode
from teachpath.io.private_files import write_private
from teachpath.io.store.recordings import RECORDINGS
from teachpath.io.store.store import Store
from teachpath.offline.import_job import PREPARED_FOLDER, UPLOAD, ImportOrder, PreparedImport, prepare_import
from teachpath.offline.staging import STAGING, begin_session, locked_staging
from teachpath.records import Demonstration, Task

RESULT = "made.json"

# `call(function, *arguments)` returns what the function returns, perhaps from another process.
Call = Callable[..., Any]


@dataclass(frozen=True)
class FileOutcome:
    """What became of one file.

    Attributes:
        file: its name.
        made: demonstrations as they are stored; empty if any file of the batch was refused.
        understood: what was taken for time, units and phases.
        refusal: why it cannot be used, or empty.
    """

    file: str
    made: tuple[Demonstration, ...] = ()
    understood: tuple[str, ...] = ()
    refusal: str = ""


@dataclass(frozen=True)
class _Summary:
    """What became of all files of an import that is stored."""

    outcomes: tuple[FileOutcome, ...]


def import_batch(
    store: Store,
    data_dir: Path,
    files: Sequence[Path],
    order: ImportOrder,
    *,
    call: Call,
    progress: Callable[[float, str], None] = lambda fraction, what: None,
) -> list[FileOutcome]:
    """Import files into a task, all or none.

    Args:
        store: of the station.
        data_dir: its folder.
        files: to import, in their order.
        order: what all of them have in common; `key`, `folder` and `name` are those of each file.
        call: calls what reads a file.
        progress: called with the share of the work that is done, and a sentence.

    Returns:
        What became of each file. If one is refused, nothing is stored.

    Raises:
        UnusableRecording: a file cannot be read from the disk.
        Conflict: the same import is under way elsewhere.
    """
    digests = [_digest(file) for file in files]
    common = repr(replace(order, key="", folder=Path(), name=""))
    key = hashlib.sha256("\n".join([common, *(file.name for file in files), *digests]).encode()).hexdigest()[:16]
    staging, summary = data_dir / STAGING / key, data_dir / STAGING / f"{key}.json"
    staging.mkdir(parents=True, exist_ok=True)
    with locked_staging(staging):
        if summary.exists():  # of an import that was killed after all was stored
            outcomes = list(decode(_Summary, summary.read_bytes()).outcomes)
        else:
            outcomes = _prepare_all(staging, files, digests, order, call, progress)
            if any(outcome.refusal for outcome in outcomes):
                shutil.rmtree(staging)
                return [replace(outcome, made=()) for outcome in outcomes]
            progress(0.95, "taking over")
            outcomes = _store_all(store, staging, order, outcomes)
            write_private(summary, encode(_Summary(tuple(outcomes))).decode())
        shutil.rmtree(staging)
        summary.unlink()
    return outcomes


def _digest(file: Path) -> str:
    try:
        with file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise UnusableRecording(f"cannot read {file}: {error.strerror}") from None


def _prepare_all(
    staging: Path,
    files: Sequence[Path],
    digests: Sequence[str],
    order: ImportOrder,
    call: Call,
    progress: Callable[[float, str], None],
) -> list[FileOutcome]:
    session = begin_session(staging, order.task, [file.name for file in files]).id
    outcomes = []
    for number, (file, digest) in enumerate(zip(files, digests, strict=True)):
        progress(0.9 * number / len(files), f"{file.name}, {number + 1} of {len(files)}")
        each = replace(order, key=f"{session} {number}", folder=staging / str(number), name=file.name)
        outcomes.append(_prepared(file, digest, each, call))
    return outcomes


def _prepared(file: Path, digest: str, order: ImportOrder, call: Call) -> FileOutcome:
    """Make the demonstrations of a file in its folder, or find that they were made before."""
    result = order.folder / RESULT
    if not result.exists():
        shutil.rmtree(order.folder, ignore_errors=True)
        order.folder.mkdir(parents=True)
        try:
            shutil.copyfile(file, order.folder / UPLOAD)
            if _digest(order.folder / UPLOAD) != digest:
                raise UnusableRecording(f"{file.name}: it changes while it is read; import it when it is finished")
            prepared = call(prepare_import, order)
        except (UnusableInput, OverLimit) as error:
            return FileOutcome(file.name, refusal=str(error))
        write_private(result, encode(prepared).decode())
    kept = decode(PreparedImport, result.read_bytes())
    return FileOutcome(file.name, kept.made, kept.understood)


def _store_all(store: Store, staging: Path, order: ImportOrder, outcomes: Sequence[FileOutcome]) -> list[FileOutcome]:
    batch = [(outcome.made, staging / str(n) / PREPARED_FOLDER / RECORDINGS) for n, outcome in enumerate(outcomes)]
    task = Task(order.task, order.scene.name, outcomes[0].made[0].calibration.name, 0, order.object_at_grasp)
    try:
        stored = iter(store.take_over(task, batch))
    except BaseException:
        shutil.rmtree(staging)  # the store has kept nothing of it
        raise
    return [replace(outcome, made=tuple(next(stored) for _ in outcome.made)) for outcome in outcomes]
