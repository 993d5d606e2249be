"""Imports as jobs: an uploaded file becomes demonstrations in a folder of its own; the service takes them over."""

from __future__ import annotations

import itertools
import shutil
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from teachpath.errors import NotFound
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.file_samples import Source, read_source
from teachpath.offline.importing import import_samples
from teachpath.offline.track_samples import PhaseMarks
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene

UPLOAD, PREPARED = "upload", "prepared"  # in the folder of an import: the file, and what was made of it


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """What a job of kind `import` keeps of its request; `upload` names the folder of the file.

    Scene and calibration are those of the task where they are empty.
    """

    upload: str
    name: str
    format: str = ""
    units: str = ""
    rate: float = 0.0
    scene: str = ""
    calibration: str = ""
    time_unit: str = ""
    columns: str = ""
    quaternion: str = ""
    track: str = ""
    marks: PhaseMarks = field(default_factory=PhaseMarks)
    object_at_grasp: bool = False

    @property
    def options(self) -> ReadOptions:
        """What the request says of the format of the file."""
        return ReadOptions(self.units, self.time_unit, self.rate, self.columns, self.quaternion, self.track)


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
    options: ReadOptions
    marks: PhaseMarks
    scene: Scene
    calibration: Calibration
    recording: RecordingSettings
    limits: ImportSettings
    object_at_grasp: bool = False


@dataclass(frozen=True, slots=True)
class PreparedImport:
    """What was made of a file.

    Attributes:
        made: the demonstrations, one at least.
        understood: what was taken for time, units and phases.
    """

    made: tuple[Demonstration, ...]
    understood: tuple[str, ...] = ()


def prepare_import(
    order: ImportOrder, *, progress: Callable[[float, str], None] = lambda fraction, what: None
) -> PreparedImport:
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
    source = Source(order.name, content, order.kind, order.options, order.marks)
    store = Store(StoreSettings(data_dir=str(prepared), database="sqlite://"))
    try:
        read = read_source(source, order.calibration, order.limits, order.recording)
        made = import_samples(
            store,
            order.recording,
            read,
            order.name,
            task=order.task,
            scene=order.scene,
            limits=order.limits,
            object_at_grasp=order.object_at_grasp,
            progress=progress,
            new_id=derived_ids(order.key),
        )
    finally:
        store.close()
    return PreparedImport(tuple(demonstration for demonstration, _ in made), read.understood)


def derived_ids(key: str) -> Callable[[], str]:
    """Return a function that returns one id after another, which follow from `key`."""
    numbers = itertools.count()
    return lambda: f"demo-{uuid.uuid5(uuid.NAMESPACE_OID, f'{key} {next(numbers)}').hex[:12]}"
