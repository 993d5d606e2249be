"""The way of finished recordings from the data folder to object storage.

A recording is uploaded, then its row names the object, then its file is removed. Whatever ends the process in between,
the next pass goes on from what is there.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Final, Protocol

from teachpath.errors import NotFound, StorageUnavailable
from teachpath.io.store.recordings import Recordings
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Demonstration

INTERVAL: Final = 0.5  # [s] between two passes
LONGEST_PAUSE: Final = 30.0  # [s] before the object storage is tried again
ROW_PAUSE: Final = 2.0  # [s] for which a recording waits for its row
FAULT_PAUSE: Final = 600.0  # [s] after which a recording is tried again that cannot be uploaded
LINGER: Final = 10.0  # [s] for which a file stays whose row names the object: somebody may just read it
MAX_NAMED: Final = 3  # recordings that cannot be uploaded


class Change(Protocol):
    """How a row is changed."""

    def __call__(self, key: str, *, recording: str) -> object:
        """Let the row of a demonstration name another recording."""


class Spool:
    """Uploads the finished recordings of a station, one after the other, on a thread of its own.

    Where no object storage is named, it does nothing.

    Args:
        recordings: of the station.
        places: returns the ids of demonstrations by the places of their recordings.
        row: returns a demonstration by its id; raises NotFound.
        change: changes its row.
        clock: [s] monotonic.
    """

    def __init__(
        self,
        recordings: Recordings,
        places: Callable[[], dict[str, str]],
        row: Callable[[str], Demonstration],
        change: Change,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._recordings, self._row, self._change, self._clock = recordings, row, change, clock
        self._places = places
        self._ids: dict[str, str] | None = None  # of the rows that were there at the first pass
        self._later: dict[str, float] = {}  # by place: before which a file is left alone
        self._uploaded: dict[str, float] = {}  # by place: since when a row is known to name the object
        self._refused: dict[str, str] = {}  # by place: why a file cannot be uploaded
        self._fault, self._resume, self._pause = "", float("-inf"), INTERVAL
        self._stopped = threading.Event()
        self._thread = PeriodicThread("recording spool", INTERVAL, self.work)

    def start(self) -> None:
        """Upload from now on."""
        if self._recordings.objects.url:
            self._stopped.clear()
            self._thread.start()

    def stop(self) -> None:
        """Give up what is under way; the next start goes on with it."""
        self._stopped.set()
        self._thread.stop()

    def waiting(self) -> tuple[int, int]:
        """Return how many recordings wait to be uploaded, and their size [bytes]."""
        if not self._recordings.objects.url:
            return 0, 0
        sizes = []
        for file in self._recordings.finished():
            if self._recordings.place(file) not in self._uploaded:
                try:
                    sizes.append(file.stat().st_size)
                except FileNotFoundError:
                    continue
        return len(sizes), sum(sizes)

    def faults(self) -> list[str]:
        """Say why recordings wait, and which of them cannot be uploaded."""
        said = [f"{place} is not uploaded: {why}" for place, why in list(self._refused.items())[:MAX_NAMED]]
        if (more := len(self._refused) - MAX_NAMED) > 0:
            said.append(f"{more} more recordings are not uploaded; stop the service and run: teachpath doctor")
        if fault := self._fault:
            count, size = self.waiting()
            said.append(f"{count} recordings ({size / 1e6:.1f} MB) wait here, and are uploaded by themselves: {fault}")
        return said

    def work(self) -> None:
        """Take every finished recording a step further; when the object storage fails, pause for ever longer."""
        if self._clock() < self._resume:
            return
        try:
            if self._ids is None:
                self._ids = self._places()
            for file in self._recordings.finished():
                if self._stopped.is_set():
                    return
                place = self._recordings.place(file)
                if self._later.get(place, float("-inf")) <= self._clock():
                    self._advance(file, place)
        except StorageUnavailable as error:
            self._fault = str(error)
            self._resume = self._clock() + self._pause
            self._pause = min(2.0 * self._pause, LONGEST_PAUSE)
        else:
            self._fault, self._pause = "", INTERVAL

    def _advance(self, file: Path, place: str) -> None:
        assert self._ids is not None
        try:
            row = self._row(self._ids.get(place, file.stem))
        except NotFound:  # it is not stored yet; or never, which is the doctor's
            self._later[place] = self._clock() + ROW_PAUSE
            return
        content = file.read_bytes()
        address = self._recordings.objects.address(place)
        if row.digest is None or sha256(content).hexdigest() != row.digest.sha256:
            self._refuse(place, "it is not what was recorded; stop the service and run: teachpath doctor")
        elif row.recording == address:
            self._remove(file, place)
        elif row.recording != place:
            self._refuse(place, f"its row names {row.recording}; stop the service and run: teachpath doctor")
        elif self._put(address, content):
            self._change(row.id, recording=address)
            self._refused.pop(place, None)
            self._remove(file, place)
        else:
            self._refuse(place, f"another object lies at {address}; move that away")

    def _put(self, address: str, content: bytes) -> bool:
        """Upload a recording; False: there is another object. One that was uploaded before a kill is the same."""
        objects = self._recordings.objects
        return objects.put_new(address, content, self._stopped.is_set) or objects.read(address) == content

    def _remove(self, file: Path, place: str) -> None:
        """Remove a file whose row names the object, a while after that was seen first."""
        since = self._uploaded.setdefault(place, self._clock())
        self._later[place] = since + LINGER
        if self._clock() >= since + LINGER:
            file.unlink(missing_ok=True)
            del self._later[place], self._uploaded[place]

    def _refuse(self, place: str, why: str) -> None:
        self._refused[place] = why
        self._later[place] = self._clock() + FAULT_PAUSE
