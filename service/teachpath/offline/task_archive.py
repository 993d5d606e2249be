"""All demonstrations of a task in one zip file, with a SHA-256 of each file in it, and the way back.

The folder in the archive holds a recording per demonstration, `task.json`, and `SHA256SUMS`, which `sha256sum --check`
reads, too: whoever unpacks it elsewhere sees without teachpath that nothing is missing or changed.
"""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Final

from teachpath.errors import OverLimit, UnusableInput, UnusableRecording
from teachpath.io.documents import decode, encode
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.recording_facts import amended
from teachpath.io.store.store import Store
from teachpath.records import Demonstration, Task

SUFFIX: Final = ".zip"
SUMS, TASK = "SHA256SUMS", "task.json"
RECORDING: Final = ".mcap"
LINE: Final = re.compile(r"([0-9a-f]{64})  ([^/\\\0]+)")
MAX_TEXT_SIZE: Final = 1_000_000  # of SHA256SUMS and of task.json [bytes]
MAX_EXPANSION: Final = 10  # times the size of the archive; recordings are compressed already
PIECE: Final = 1 << 20


@dataclass(frozen=True)
class UnpackedTask:
    """What an archive held.

    Attributes:
        task: as it was exported.
        files: its recordings, in the order of their numbers.
    """

    task: Task
    files: tuple[Path, ...]


def write_archive(
    store: Store,
    demonstrations: Sequence[Demonstration],
    file: Path,
    progress: Callable[[float, str], None] = lambda fraction, what: None,
) -> None:
    """Write demonstrations of one task, each with what is thought of it now, to a new zip file.

    Raises:
        NotFound, UnusableRecording: a recording is missing, or is not what was recorded.
    """
    task = store.task(demonstrations[0].task)
    sums = []
    # Recordings are compressed already.
    with zipfile.ZipFile(file, "x", zipfile.ZIP_STORED) as archive:

        def add(name: str, content: bytes) -> None:
            sums.append(f"{sha256(content).hexdigest()}  {name}\n")
            archive.writestr(f"{task.name}/{name}", content)

        add(TASK, encode(task))
        for done, each in enumerate(demonstrations):
            progress(done / len(demonstrations), f"demonstration {each.number}")
            content = store.recordings.content(each.recording, each.digest)
            add(f"{task.name}-{each.number:03d}{RECORDING}", amended(content, each))
        archive.writestr(f"{task.name}/{SUMS}", "".join(sums))


@contextmanager
def unpacked_archive(file: Path, limits: ImportSettings) -> Iterator[UnpackedTask]:
    """Unpack an archive into a temporary folder, after every file of it was compared with its SHA-256.

    Raises:
        UnusableInput: it is no archive of a task, or something in it is missing, changed, or not listed.
        OverLimit: it holds more, or larger, files than may be imported.
    """
    with TemporaryDirectory(prefix="teachpath-") as folder:
        try:
            with zipfile.ZipFile(file) as archive:
                unpacked = _unpacked(archive, file, Path(folder), limits)
        except OSError as error:
            raise UnusableRecording(f"cannot read {file}: {error.strerror or error}") from None
        except (zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError) as e:
            raise UnusableRecording(f"{file.name} is damaged, or no zip file: {e}") from None
        yield unpacked


def _unpacked(archive: zipfile.ZipFile, file: Path, folder: Path, limits: ImportSettings) -> UnpackedTask:
    name = file.name
    entries = {PurePosixPath(each.filename).name: each for each in archive.infolist() if not each.is_dir()}
    if SUMS not in entries or TASK not in entries:
        raise UnusableInput(
            f"{name} is no archive of a task: it has no {SUMS} and {TASK}; unpack it, and import the files in it"
        )
    sums = _listed(_text(archive, entries[SUMS], name), name)
    if spare := entries.keys() - sums.keys() - {SUMS}:
        raise UnusableInput(f"{name}: {min(spare)} is in it and not in its {SUMS}; export the task again")
    if len(sums) - 1 > limits.max_motions:
        raise OverLimit(f"{name} holds {len(sums) - 1} recordings, limit {limits.max_motions} (imports.max_motions)")
    room = MAX_EXPANSION * file.stat().st_size
    for each, digest in sums.items():
        if each not in entries:
            raise UnusableInput(f"{name}: {each} is missing in it; nothing was imported, copy it again")
        limit = min(MAX_TEXT_SIZE if each == TASK else limits.max_expanded_size, room)
        found, size = _unpack(archive, entries[each], folder / each, limit, name)
        room -= size
        if found != digest:
            raise UnusableInput(f"{name}: {each} is not what its {SUMS} says; nothing was imported, copy it again")
    recordings = sorted((each for each in sums if each != TASK), key=lambda each: (len(each), each))
    return UnpackedTask(decode(Task, (folder / TASK).read_bytes()), tuple(folder / each for each in recordings))


def _listed(text: str, name: str) -> dict[str, str]:
    """Return the SHA-256 of each file that an archive lists."""
    sums = {}
    for number, line in enumerate(text.splitlines(), 1):
        match = LINE.fullmatch(line)
        if match is None or not (match[2] == TASK or match[2].endswith(RECORDING)):
            raise UnusableInput(f"{name}: line {number} of its {SUMS} names no recording: {line[:80]!r}")
        sums[match[2]] = match[1]
    return sums


def _text(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, name: str) -> str:
    with archive.open(entry) as stream:
        content = stream.read(MAX_TEXT_SIZE + 1)
    if len(content) > MAX_TEXT_SIZE:
        raise OverLimit(f"{name}: its {SUMS} is over {MAX_TEXT_SIZE} bytes, the limit")
    return content.decode(errors="replace")


def _unpack(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, target: Path, limit: int, name: str) -> tuple[str, int]:
    """Write one file of an archive, whatever the archive says of its size; return its SHA-256 and its size [bytes]."""
    digest, size = sha256(), 0
    with archive.open(entry) as stream, target.open("xb") as out:
        while piece := stream.read(PIECE):
            size += len(piece)
            if size > limit:
                raise OverLimit(f"{name}: {target.name} expands to over {limit} bytes, the limit")
            digest.update(piece)
            out.write(piece)
    return digest.hexdigest(), size
