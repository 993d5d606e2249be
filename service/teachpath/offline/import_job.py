"""Imports as jobs: uploaded files become demonstrations, each in a folder of its own; the service takes them over."""

from __future__ import annotations

import hashlib
import itertools
import shutil
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from io import BufferedReader
from pathlib import Path

from teachpath.errors import NotFound, UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions, unheard
from teachpath.io.readers.registry import reads_from_disk
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.offline.file_samples import FileSamples, Source, read_source
from teachpath.offline.importing import import_samples
from teachpath.offline.track_samples import MotionMarks, PhaseMarks
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, Trajectory

UPLOAD, PREPARED_FOLDER = "upload", "prepared"  # in the folder of an import: the file, and what was made of it
BEGINNING = 65536  # bytes of a file, by which its format is told


Progress = Callable[[float, str], None]


@dataclass(frozen=True, slots=True)
class UploadedFile:
    """What a job keeps of one file and of how it is read; `upload` names its folder."""

    upload: str
    name: str
    format: str = ""
    units: str = ""
    rate: float = 0.0
    time_unit: str = ""
    columns: str = ""
    quaternion: str = ""
    track: str = ""
    marks: PhaseMarks = field(default_factory=PhaseMarks)
    motion_marks: tuple[MotionMarks, ...] = ()

    @property
    def options(self) -> ReadOptions:
        """What is said of the format of the file."""
        return ReadOptions(self.units, self.time_unit, self.rate, self.columns, self.quaternion, self.track)


@dataclass(frozen=True, slots=True)
class ImportRequest:
    """What a job of kind `import` keeps of its request.

    Scene and calibration are those of the task where they are empty.
    """

    files: tuple[UploadedFile, ...]
    scene: str = ""
    calibration: str = ""
    object_at_grasp: bool = False


@dataclass(frozen=True)
class ImportOrder:
    """An uploaded file, and what demonstrations are made of it with; `folder` holds the file.

    The ids of the demonstrations follow from `key`, that of the job, so that a job which is run again makes the same
    ones, and never a second set beside recordings that were taken over just before a crash. `arm` is that of joint
    angles in the file; None: no arm is known.
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
    motion_marks: tuple[MotionMarks, ...] = ()
    arm: Arm | None = None


@dataclass(frozen=True, slots=True)
class PreparedImport:
    """What was made of a file.

    Attributes:
        made: the demonstrations, one at least.
        understood: what was taken for time, units and phases.
    """

    made: tuple[Demonstration, ...]
    understood: tuple[str, ...] = ()


def prepare_imports(
    orders: Sequence[ImportOrder], *, progress: Progress = lambda fraction, what: None
) -> list[PreparedImport]:
    """Make the demonstrations of several files, as `prepare_import`.

    Raises:
        UnusableRecording: some cannot be used; each is named with its reason.
    """
    if len(orders) == 1:
        return [prepare_import(orders[0], progress=progress)]
    prepared, refusals = [], []
    for number, order in enumerate(orders):
        progress(number / len(orders), f"{order.name}, {number + 1} of {len(orders)}")
        try:
            prepared.append(prepare_import(order))
        except UnusableInput as error:
            refusals.append(str(error))
    if refusals:
        raise UnusableRecording(
            f"nothing was imported, {len(refusals)} of {len(orders)} files cannot be used: {'; '.join(refusals)}"
        )
    return prepared


def prepare_import(order: ImportOrder, *, progress: Progress = lambda fraction, what: None) -> PreparedImport:
    """Make the demonstrations of an uploaded file, with their recordings below `order.folder / PREPARED_FOLDER`.

    Their numbers, and the places of their recordings, are those of a station that has nothing else.

    Raises:
        UnusableInput: the file cannot be used.
        NotFound: the file is gone.
    """
    prepared = order.folder / PREPARED_FOLDER
    shutil.rmtree(prepared, ignore_errors=True)  # of an attempt whose process died
    progress(0.05, f"reading {order.name}")
    read = read_upload(order, progress=lambda share: progress(0.05 + 0.25 * share, f"reading {order.name}"))
    made = record_upload(order, read, prepared, progress=progress)
    sha256 = upload_digest(order)
    return PreparedImport(tuple(replace(row, source_sha256=sha256) for row, _ in made), read.understood)


def read_upload(order: ImportOrder, *, progress: Callable[[float], None] = unheard) -> FileSamples:
    """Return what an uploaded file holds, and tell the share that was read; raises as `prepare_import`."""
    file = None
    content = upload_content(order, BEGINNING)
    if reads_from_disk(order.kind, content, order.name):
        file = order.folder / UPLOAD
    else:
        content = upload_content(order)
    return read_source(
        Source(order.name, content, order.kind, order.options, order.marks, order.motion_marks, file),
        order.calibration,
        order.limits,
        order.recording,
        order.arm,
        progress=progress,
    )


def upload_content(order: ImportOrder, most: int = -1) -> bytes:
    """Return the bytes of an uploaded file, `most` of them at most; raises NotFound."""
    with _upload(order) as stream:
        return stream.read(most)


def upload_digest(order: ImportOrder) -> str:
    """Return the SHA-256 of an uploaded file in hexadecimal digits; raises NotFound."""
    with _upload(order) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@contextmanager
def _upload(order: ImportOrder) -> Iterator[BufferedReader]:
    try:
        with (order.folder / UPLOAD).open("rb") as stream:
            yield stream
    except OSError as error:
        raise NotFound(f"the upload of {order.name} cannot be read: {error.strerror}; send it again") from None


def record_upload(
    order: ImportOrder, read: FileSamples, folder: Path, *, progress: Progress = lambda fraction, what: None
) -> list[tuple[Demonstration, Trajectory]]:
    """Make demonstrations of what was read from a file, with their recordings in a folder; raises UnusableInput."""
    store = Store(StoreSettings(data_dir=str(folder), database="sqlite://"))
    try:
        return import_samples(
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


def derived_ids(key: str) -> Callable[[], str]:
    """Return a function that returns one id after another, which follow from `key`."""
    numbers = itertools.count()
    return lambda: f"demo-{uuid.uuid5(uuid.NAMESPACE_OID, f'{key} {next(numbers)}').hex[:12]}"
