"""Imports as jobs: an uploaded file becomes demonstrations in a folder of its own; the service takes them over."""

from __future__ import annotations

import itertools
import shutil
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from teachpath.errors import NotFound, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.importing import Source, import_file
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene

UPLOAD, PREPARED = "upload", "prepared"  # in the folder of an import: the file, and what was made of it


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """What a job of kind `import` keeps of its request; `upload` names the folder of the file."""

    upload: str
    name: str
    format: str
    units: str
    rate: float
    scene: str
    calibration: str
    object_at_grasp: bool = False


@dataclass(frozen=True)
class ImportOrder:
    """An uploaded file, and what demonstrations are made of it with; `folder` holds the file.

    The ids of the demonstrations follow from `key`, that of the job, so that a job which is run again makes the same
    ones, and never a second set beside recordings that were taken over just before a crash.
    """

    key: str
    folder: Path
    task: str
    name: str
    kind: str
    units: str
    rate: float
    scene: Scene
    calibration: Calibration
    recording: RecordingSettings
    limits: ImportSettings
    object_at_grasp: bool = False


def prepare_import(order: ImportOrder, *, progress: Callable[[float, str], None]) -> list[Demonstration]:
    """Make the demonstrations of an uploaded file, with their recordings below `order.folder / PREPARED`.

    Their numbers, and the places of their recordings, are those of a station that has nothing else.

    Raises:
        UnusableInput: the file cannot be used.
        NotFound: the file is gone.
    """
    prepared = order.folder / PREPARED
    shutil.rmtree(prepared, ignore_errors=True)  # of an attempt whose process died
    progress(0.05, f"reading {order.name}")
    try:
        content = (order.folder / UPLOAD).read_bytes()
    except OSError as error:
        raise NotFound(f"the upload of {order.name} cannot be read: {error.strerror}; send it again") from None
    store = Store(StoreSettings(data_dir=str(prepared), database="sqlite://"))
    try:
        made = import_file(
            store,
            order.recording,
            Source(order.name, content, order.kind, order.units, order.rate),
            task=order.task,
            scene=order.scene,
            calibration=order.calibration,
            limits=order.limits,
            object_at_grasp=order.object_at_grasp,
            progress=progress,
            new_id=derived_ids(order.key),
        )
    finally:
        store.close()
    if not made:
        raise UnusableRecording(f"{order.name}: no recording could be written; is the disk full?")
    return [demonstration for demonstration, _ in made]


def derived_ids(key: str) -> Callable[[], str]:
    """Return a function that returns one id after another, which follow from `key`."""
    numbers = itertools.count()
    return lambda: f"demo-{uuid.uuid5(uuid.NAMESPACE_OID, f'{key} {next(numbers)}').hex[:12]}"
