"""Recordings: one MCAP file a demonstration, every hand sample with its source time, receive time and sequence.

A file also holds messages for viewers. While it is written its name ends in `.part`; it is flushed every second and
renamed when finished, so that a crash costs at most the samples since the last flush, and `salvage` reads the others.
"""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import BinaryIO

from teachpath.errors import NotFound, StorageUnavailable, UnusableRecording
from teachpath.io import documents
from teachpath.io.store.integrity import add_integrity
from teachpath.io.store.kept_rows import KeptRows
from teachpath.io.store.mcap_file import McapFile
from teachpath.io.store.object_cache import CACHE, CACHE_SIZE, ObjectCache
from teachpath.io.store.object_storage import ObjectStorage, is_address
from teachpath.io.store.salvage import HEADER, TOPIC, RecordingHeader, salvage_columns
from teachpath.io.store.sample_rows import SampleRows
from teachpath.io.store.suspensions import PART_SUFFIX, SUSPENDED_SUFFIX, Suspensions
from teachpath.io.store.viewer_messages import ViewerMessages, message_batch
from teachpath.io.wire import encode_sample, message_types
from teachpath.records import RecordingDigest, Sample, SampleColumns

RECORDINGS = "recordings"  # their folder, in that of the data
FACTS = "facts"  # name of the metadata that a finished file says of itself
BATCH_SIZE = 200  # samples; small chunks, of about 64 KiB, lose less when a file is cut off

Opener = Callable[[Path], BinaryIO]


def open_new(file: Path) -> BinaryIO:
    """Open a file that must not exist yet for writing; makes its folder."""
    file.parent.mkdir(parents=True, exist_ok=True)
    return file.open("xb")


class RecordingFile:
    """A recording that is being written.

    Attributes:
        digest: of the finished file; None before its end.
    """

    def __init__(self, part: Path, header: RecordingHeader, opener: Opener = open_new) -> None:
        self._part = part
        self._file = opener(part)
        self._count, self._first, self._last = 0, 0, 0
        self.digest: RecordingDigest | None = None
        try:
            self._begin(header)
        except OSError:
            self.discard()  # an empty file would only puzzle the doctor
            raise

    def _begin(self, header: RecordingHeader) -> None:
        self._mcap = McapFile(self._file)
        self._mcap.add_metadata(HEADER, {"header": documents.encode(header).decode()})
        self._channel = self._mcap.add_channel(TOPIC, message_types.HAND_SAMPLE)
        self._viewer_messages = ViewerMessages(self._mcap, header.calibration)
        self._samples = SampleRows()  # that wait to be written
        self._payloads: list[bytes] = []
        self.flush()

    def write(self, sample: Sample, payload: bytes = b"") -> None:
        """Append one sample; `payload` is its message as it came, made anew when empty."""
        self._payloads.append(payload or encode_sample(sample))
        self._samples.append(sample)
        if len(self._payloads) >= BATCH_SIZE:
            self._write_batch()

    def write_run(self, samples: SampleColumns, payloads: Sequence[bytes]) -> None:
        """Append samples, `payloads` as they came."""
        begin = 0
        while begin < len(payloads):
            end = min(len(payloads), begin + BATCH_SIZE - len(self._payloads))
            self._payloads += payloads[begin:end]
            self._samples.extend(samples[begin:end] if end - begin < len(payloads) else samples)
            if len(self._payloads) >= BATCH_SIZE:
                self._write_batch()
            begin = end

    def flush(self) -> None:
        """Hand all that was written to the operating system; a killed process loses none of it."""
        self._write_batch()
        self._file.flush()

    def finish(self, facts: dict[str, str]) -> Path:
        """End the recording with `facts` (verdict, counts) and return its final file."""
        self._write_batch()
        self._mcap.add_metadata(FACTS, facts)
        add_integrity(self._mcap, self._count, self._first, self._last)
        self._mcap.finish()
        self.digest = RecordingDigest(self._mcap.sha256, self._mcap.size, self._count, self._first, self._last)
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        return self._part.rename(self._part.with_suffix(""))

    def _write_batch(self) -> None:
        samples, payloads = self._samples, self._payloads
        if not samples:
            return
        self._samples, self._payloads = SampleRows(), []
        columns = samples.arrays()
        lowest, highest = int(columns.sequence.min()), int(columns.sequence.max())
        self._first = min(self._first, lowest) if self._count else lowest
        self._last = max(self._last, highest)
        self._count += len(samples)
        own = message_batch(self._channel, payloads, columns.receive_ns, columns.device_ns, columns.sequence)
        self._mcap.add_messages([own, *self._viewer_messages.batches(columns)])

    def leave(self) -> None:
        """Stop writing and leave the unfinished file for `teachpath doctor`."""
        with suppress(OSError):
            self._file.close()

    def suspend(self) -> None:
        """Stop writing, and leave the file for the service's next start; raises OSError."""
        self.flush()
        self._file.close()
        self._part.rename(self._part.with_name(self._part.name.removesuffix(PART_SUFFIX) + SUSPENDED_SUFFIX))

    def discard(self) -> None:
        """Throw the recording away."""
        self.leave()
        self._part.unlink(missing_ok=True)


class Recordings:
    """The folder of all recordings, and those of them that were uploaded to object storage.

    Args:
        root: the folder.
        opener: opens a new file in it.
        url: of the object storage to which finished recordings are uploaded; empty: they stay in the folder.
        cache_size: bytes of the objects of which copies are kept beside the folder.

    Attributes:
        objects: the object storage.
        suspensions: what waits for the service's next start.
        kept_rows: rows that wait for the database.
    """

    def __init__(self, root: Path, opener: Opener = open_new, url: str = "", cache_size: int = CACHE_SIZE) -> None:
        self._root, self._opener = root, opener
        self.objects: ObjectStorage = ObjectStorage(url)
        self.suspensions: Suspensions = Suspensions(root)
        self.kept_rows: KeptRows = KeptRows(root)
        self._cache = ObjectCache(root.parent / CACHE, cache_size, self.objects)

    def begin(self, demonstration: str, header: RecordingHeader) -> RecordingFile:
        """Open the recording of a new demonstration."""
        return RecordingFile(self.folder(header.task) / f"{demonstration}{PART_SUFFIX}", header, self._opener)

    def folder(self, task: str) -> Path:
        """Return the folder of a task's recordings."""
        return self._root / task

    def place(self, file: Path) -> str:
        """Return where `file` lies within the recordings, as a demonstration's row says it."""
        return file.relative_to(self._root).as_posix()

    def path(self, place: str) -> Path:
        """Return the file at `place`, or a copy of the object at that address.

        Raises:
            NotFound: it is missing.
            StorageUnavailable: the object storage does not answer.
        """
        if is_address(place):
            return self._cache.file(place)
        file = self._root / place
        if file.is_file():
            return file
        if self.objects.url:  # it may have been uploaded since its row was read
            with suppress(NotFound):
                return self._cache.file(self.objects.address(place))
        beside = f" and in {self.objects.url}" if self.objects.url else ""
        raise NotFound(f"recording {place} is missing under {self._root}{beside}; was the folder moved?")

    def require_uploaded(self, places: Sequence[str]) -> None:
        """Raise StorageUnavailable while recordings are neither here nor in the object storage."""
        away = sum(not is_address(place) and not (self._root / place).is_file() for place in places)
        if away and self.objects.url:
            raise StorageUnavailable(f"{away} recordings wait at their station to be uploaded to {self.objects.url}")

    def take_over(self, folder: Path, place: str) -> None:
        """Move the finished recording at `place` within `folder` to the same place here; one disk must hold both.

        One that was taken over before stays.
        """
        file = self._root / place
        if file.exists() and not (folder / place).exists():
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        (folder / place).rename(file)

    def move(self, place: str, to: str) -> None:
        """Move a recording to another place, at which there is none."""
        file = self._root / to
        file.parent.mkdir(parents=True, exist_ok=True)
        (self._root / place).rename(file)

    def remove(self, places: Sequence[str]) -> None:
        """Remove recordings that no row names; those that are not there are passed over."""
        for place in places:
            (self._root / place).unlink(missing_ok=True)

    def content(self, place: str, digest: RecordingDigest | None) -> bytes:
        """Return the content of a finished recording.

        Raises:
            NotFound: it is missing.
            UnusableRecording: it is not what `digest` says, if that is known.
            StorageUnavailable: the object storage does not answer.
        """
        content = self._read(place)
        if digest is not None and sha256(content).hexdigest() != digest.sha256 and is_address(place):
            self._cache.drop(place)  # a copy may be damaged where the object is not
            content = self._read(place)
        if digest is not None and (found := sha256(content).hexdigest()) != digest.sha256:
            raise UnusableRecording(
                f"recording {place} is not what was recorded: {len(content)} bytes with SHA-256 {found[:12]}…, "
                f"recorded were {digest.size} with {digest.sha256[:12]}…; run: teachpath doctor"
            )
        return content

    def _read(self, place: str) -> bytes:
        try:
            return self.path(place).read_bytes()
        except FileNotFoundError:  # it was uploaded, and its file removed, since it was looked for
            return self.path(place).read_bytes()

    def samples(self, place: str, digest: RecordingDigest | None = None) -> list[Sample]:
        """Read all samples of a finished recording, in the order they were received; raises as `content`."""
        return list(self.columns(place, digest))

    def columns(self, place: str, digest: RecordingDigest | None = None) -> SampleColumns:
        """Read all samples of a finished recording, as `samples`, in a fraction of the time."""
        header, columns, fault = salvage_columns(io.BytesIO(self.content(place, digest)))
        if header is None or fault:
            raise UnusableRecording(f"recording {place} is damaged ({fault or 'no header'}); run: teachpath doctor")
        return columns

    def finished(self) -> list[Path]:
        """List the files of recordings that ended."""
        return sorted(self._root.glob("*/*.mcap"))

    def unfinished(self) -> list[Path]:
        """List the `.part` files: takes that are running, or that a crash left."""
        return sorted(self._root.glob(f"*/*{PART_SUFFIX}"))

    def cut_off(self, is_writing: Callable[[], bool]) -> list[Path]:
        """List the `.part` files that a crash or a fault left; none while takes are written."""
        found = self.unfinished()
        # What was being written when it was found has its final name, or is gone, once nothing is written any more.
        return [file for file in found if file.exists()] if found and not is_writing() else []

    def notes(self, is_writing: Callable[[], bool]) -> list[str]:
        """Say what an operator should know of recordings that were cut off."""
        left = self.cut_off(is_writing)
        return [f"{len(left)} recordings were cut off; stop the service and run: teachpath doctor"] if left else []
