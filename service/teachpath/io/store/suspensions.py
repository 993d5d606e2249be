"""Recordings that a stopped service left for its next start: what is recorded, and the takes in the hand.

One file says what is recorded; of each take in the hand the unfinished file is renamed, so that nobody takes it for
one that a crash cut off. Whatever ends a start early, the next one finds them again.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io import documents
from teachpath.io.private_files import write_private
from teachpath.io.store.salvage import RecordingHeader, salvage_messages
from teachpath.io.wire import decode_sample
from teachpath.records import Sample, SuspendedRecording, SuspendedRecordings

FILE: Final = "suspended.json"
PART_SUFFIX, SUSPENDED_SUFFIX = ".mcap.part", ".mcap.suspended"

log: logging.Logger = logging.getLogger("teachpath")


class Suspensions:
    """What lies in the folder of recordings for the service's next start.

    Args:
        root: the folder.
    """

    def __init__(self, root: Path) -> None:
        self._root = root

    def keep(self, recordings: Sequence[SuspendedRecording]) -> None:
        """Keep recordings for the next start; where that cannot be written, leave their takes for the doctor."""
        if not recordings:
            return
        try:
            content = documents.encode(SuspendedRecordings(tuple(recordings))).decode()
            write_private(self._root / FILE, content)
        except OSError as error:
            log.error("%d recordings cannot be kept for the next start: %s", len(recordings), error)
            self._leave_unnamed(set())

    def read(self) -> tuple[SuspendedRecording, ...]:
        """Return what was kept; takes that it does not name are left for the doctor."""
        found = SuspendedRecordings()
        try:
            found = documents.decode(SuspendedRecordings, (self._root / FILE).read_bytes())
        except FileNotFoundError:
            pass
        except (OSError, UnusableInput) as error:
            log.error("the recordings before the last stop do not go on: %s: %s", FILE, error)
        self._leave_unnamed({each.take for each in found.recordings})
        return found.recordings

    def forget(self) -> None:
        """Forget what was kept: all of it goes on."""
        (self._root / FILE).unlink(missing_ok=True)

    def open(self, recording: SuspendedRecording) -> tuple[RecordingHeader | None, list[tuple[Sample, bytes]]]:
        """Read the take in the hand of a recording: (header, its samples, each as it came too); nothing without one.

        What an earlier start that was broken off has written of it is removed.
        """
        if not recording.take or not (file := self._file(recording, SUSPENDED_SUFFIX)).exists():
            return None, []
        self._file(recording, PART_SUFFIX).unlink(missing_ok=True)
        with file.open("rb") as stream:
            header, payloads, receive_ns, _ = salvage_messages(stream)
        tracker = recording.request.tracker
        received = zip(payloads, receive_ns, strict=True)
        return header, [(decode_sample(tracker, payload, at), payload) for payload, at in received]

    def remove(self, recording: SuspendedRecording) -> None:
        """Remove the take in the hand, which is recorded anew."""
        if recording.take:
            self._file(recording, SUSPENDED_SUFFIX).unlink(missing_ok=True)

    def leave(self, recording: SuspendedRecording) -> None:
        """Leave the take in the hand for the doctor, as one that was cut off."""
        if recording.take:
            with suppress(FileNotFoundError):
                self._file(recording, SUSPENDED_SUFFIX).rename(self._file(recording, PART_SUFFIX))

    def _file(self, recording: SuspendedRecording, ending: str) -> Path:
        return self._root / recording.request.task / f"{recording.take}{ending}"

    def _leave_unnamed(self, takes: set[str]) -> None:
        for file in self._root.glob(f"*/*{SUSPENDED_SUFFIX}"):
            if (take := file.name.removesuffix(SUSPENDED_SUFFIX)) not in takes:
                file.rename(file.with_name(take + PART_SUFFIX))
