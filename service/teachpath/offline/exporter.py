"""Exports for download: a process of their own writes the files, one export after another, within limits."""

from __future__ import annotations

import asyncio
import zipfile
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from teachpath.errors import OverLimit, QueueFull, Unreachable
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.jobs import worker
from teachpath.jobs.pool import KillablePool
from teachpath.jobs.settings import JobSettings
from teachpath.offline.exporting import export_demonstrations
from teachpath.offline.task_archive import SUFFIX
from teachpath.recorder.annotations import Annotations
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Scene
from teachpath.robot.scenes import Scenes

FILES: Final = "files"  # in the folder of an export


@dataclass(frozen=True)
class ExportSource:
    """What exports are made from: the store, and what the trajectories of its demonstrations follow from."""

    store: StoreSettings
    recording: RecordingSettings
    scenes: tuple[Scene, ...]


class Exporter:
    """Writes exports in a process that begins with the first one and is limited in memory and time."""

    def __init__(self, source: ExportSource, settings: JobSettings) -> None:
        self._source, self._settings = source, settings
        self._pool = KillablePool(worker.init_limited, settings.max_file_memory, part="exporter")
        self._waiting: Counter[str] = Counter()  # exports by who asked for them

    async def write(
        self, demonstrations: Sequence[Demonstration], kind: str, folder: Path, *, zipped: bool, submitter: str
    ) -> Path:
        """Write demonstrations of one task below `folder` and return the file: of the one, or a zip file of all.

        Raises:
            QueueFull: too many exports wait, or too many of this submitter.
            OverLimit: it takes too much time or memory.
            Unreachable: its process died.
            TeachpathError: as `export_demonstrations`.
        """
        self._require_room(submitter)
        self._waiting[submitter] += 1
        try:
            begun = asyncio.to_thread(
                self._pool.submit, _write, self._source, list(demonstrations), kind, folder, zipped
            )
            return await self._result(await begun)  # a process that begins may be waited for
        except BrokenProcessPool:
            self._pool.kill()
            raise Unreachable("the process that writes exports died; try again") from None
        finally:
            self._waiting[submitter] -= 1

    async def _result(self, future: Future[Path]) -> Path:
        try:
            return await asyncio.wait_for(asyncio.wrap_future(future), self._settings.max_file_duration)
        except TimeoutError:
            self._pool.kill()
            raise OverLimit(
                f"the export takes over {self._settings.max_file_duration:g} s, the limit (jobs.max_file_duration); "
                "export fewer demonstrations, or use: teachpath export demonstrations"
            ) from None
        except MemoryError:
            self._pool.kill()
            raise OverLimit(
                f"the export needs over {self._settings.max_file_memory} bytes of memory, the limit "
                "(jobs.max_file_memory); export fewer demonstrations, or use: teachpath export demonstrations"
            ) from None
        except asyncio.CancelledError:
            if not future.cancelled():
                raise  # whoever asked has gone
            raise Unreachable("the process that writes exports was ended; try again") from None

    def stop(self) -> None:
        """End the process, even in the middle of an export; no other starts."""
        self._pool.close()

    def _require_room(self, submitter: str) -> None:
        limit = self._settings.max_exports
        for count, most in ((self._waiting.total(), limit), (2 * self._waiting[submitter], limit)):
            if count >= most:
                raise QueueFull(
                    f"{self._waiting.total()} exports wait or run, {self._waiting[submitter]} of them for "
                    f"{submitter or 'you'}; limit {limit} (jobs.max_exports), half of it for one; try again later"
                )


def _write(source: ExportSource, demonstrations: list[Demonstration], kind: str, folder: Path, zipped: bool) -> Path:
    worker.limit_memory()
    store = Store(source.store)
    try:
        trajectory = Annotations(store, source.recording, Scenes(store.scenes, source.scenes).get).trajectory
        written = export_demonstrations(store, demonstrations, kind, folder / FILES, trajectory=trajectory)
    finally:
        store.close()
    if not zipped or written[0].suffix == SUFFIX:
        return written[0]
    with zipfile.ZipFile(folder / "export.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for file in written:
            for each in sorted(file.rglob("*")) if file.is_dir() else [file]:
                archive.write(each, each.relative_to(folder / FILES))
    return folder / "export.zip"
