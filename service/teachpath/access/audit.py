"""Who did what, written into the audit log on a thread of its own: no request waits for the disk."""

from __future__ import annotations

import queue
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from typing import Final, Protocol

from teachpath.errors import TeachpathError
from teachpath.io.audit_log import Happening
from teachpath.io.store.pages import Page, PageRequest
from teachpath.records import AuditEntry, JournalEntry

MAX_WAITING: Final = 10_000  # entries that wait for the disk; further ones are counted
BATCH: Final = 500  # entries that are written at a time
WINDOW: Final = 60.0  # [s] in which refusals are counted
MAX_REFUSALS: Final = 30  # of one sender that are written in it; further ones are counted, so that none fills the disk
MAX_SENDERS: Final = 10_000  # whose refusals are counted; beyond, the oldest is forgotten


class Log(Protocol):
    """Where entries are kept."""

    def append(self, happenings: list[Happening]) -> None:
        """Append entries; raises TeachpathError where they cannot be written."""

    def page(self, wanted: PageRequest) -> Page[AuditEntry]:
        """Return a page of the entries, newest first; raises UnusableInput."""


class Audit:
    """Writes entries in the order in which they come; safe to use from several threads.

    Args:
        log: to write to, and to read from.
        clock: the time [s].
    """

    def __init__(self, log: Log, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.log: Log = log
        self._waiting: queue.Queue[Happening | None] = queue.Queue(MAX_WAITING)
        self._lost = 0
        self._fault = ""
        self._senders: OrderedDict[tuple[str, str], tuple[float, int]] = OrderedDict()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Write what comes."""
        self._thread = threading.Thread(target=self._write, name="audit", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Write what has come, and end."""
        if self._thread is not None:
            self._waiting.put(None)
            self._thread.join()
            self._thread = None

    def note(self, who: str, source: str, action: str, answer: str, *, is_refusal: bool = False) -> None:
        """Write an entry soon; of the refusals of one sender only some.

        Args:
            who: did it.
            source: from where it came.
            action: what was asked for.
            answer: how it was answered.
            is_refusal: whether it was refused.
        """
        if is_refusal:
            with self._lock:
                earlier = self._count(who, source)
            if earlier < 0:
                return
            answer += f" (and {earlier} further refusals before)" if earlier else ""
        try:
            self._waiting.put_nowait(Happening(who, source, action, answer))
        except queue.Full:
            with self._lock:
                self._lost += 1

    def note_journal(self, entry: JournalEntry) -> None:
        """Write what the executor says that somebody did to the arm, whatever way it came."""
        action = f"{entry.verb} {entry.execution}".strip()
        self.note(entry.who, "executor", action, entry.answer)

    def notes(self) -> list[str]:
        """Say what an operator should know."""
        return [f"what people and programs do is not written down: {self._fault}"] if self._fault else []

    def _count(self, who: str, source: str) -> int:
        """Count a refusal; return how many before it were not written, or -1 where it is not to be written."""
        now, key = self._clock(), (who, source)
        begin, count = self._senders.pop(key, (now, 0))
        earlier = 0
        if now - begin >= WINDOW:
            earlier, begin, count = max(0, count - MAX_REFUSALS), now, 0
        self._senders[key] = begin, count + 1
        while len(self._senders) > MAX_SENDERS:
            self._senders.popitem(last=False)
        return earlier if count < MAX_REFUSALS else -1

    def _write(self) -> None:
        is_ending = False
        while not is_ending:
            batch = [self._waiting.get()]
            while len(batch) < BATCH and not self._waiting.empty():
                batch.append(self._waiting.get())
            is_ending = None in batch
            happenings = [each for each in batch if each is not None]
            with self._lock:
                lost, self._lost = self._lost, 0
            if lost:
                happenings.append(
                    Happening("the audit log", "", "lost entries", f"{lost} entries could not be written")
                )
            self._append(happenings)

    def _append(self, happenings: list[Happening]) -> None:
        if not happenings:
            return
        try:
            self.log.append(happenings)
            self._fault = ""
        except TeachpathError as error:
            self._fault = str(error)
            with self._lock:
                self._lost += len(happenings)
