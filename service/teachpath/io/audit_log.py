"""The audit log: one line of JSON an entry, each with the hash of the one before.

A second file holds number and hash of the newest entry, so that entries which are cut off at the end are missed, too.
The service and the command line append under a lock of that file; whole lines are written at once.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Final

from teachpath.errors import StorageUnavailable, UnusableInput
from teachpath.io.store.pages import Page, PageRequest
from teachpath.records import AuditEntry

LOG: Final = "audit.jsonl"
HEAD: Final = "audit.head"
BEGINNING: Final = "0" * 64  # hash before the first entry
MAX_TEXT_LENGTH: Final = 2000  # characters of one field; an order that is longer is cut
MAX_LINE_LENGTH: Final = 131072  # bytes; four texts whose every character is escaped
BLOCK: Final = 65536  # bytes that are read at a time
LOG_SUBJECT: Final = "the audit log"  # who writes of what it finds at its end
BROKEN_CHAIN_ACTION: Final = "found broken"
TORN_END_ACTION: Final = "found torn"


@dataclass(frozen=True, slots=True)
class Happening:
    """What is to become an entry."""

    who: str
    source: str
    action: str
    answer: str


class AuditLog:
    """The audit log of a data folder.

    Args:
        folder: of the data.
        now_ns: the time.
    """

    def __init__(self, folder: Path, now_ns: Callable[[], int] = time.time_ns) -> None:
        self._log, self._head = folder / LOG, folder / HEAD
        self._now_ns = now_ns
        self._newest: tuple[int, str] | None = None  # number and hash of what this process wrote last

    def append(self, happenings: Sequence[Happening]) -> None:
        """Append entries; when it returns, they are on the disk.

        Where entries that were written are gone from the end, or cannot be read, that is written first, as an entry by
        which `verify` ends ever after. What a process left that died amid writing is removed, with a note.

        Raises:
            StorageUnavailable: the log cannot be written; it is as it was.
        """
        try:
            with self._locked() as head, self._log.open("ab+") as log:
                os.chmod(log.fileno(), 0o600)
                number, last, found = self._end(log.fileno(), head)
                text = ""
                for number, each in enumerate([*found, *happenings], number + 1):  # noqa: B020 - goes on from there
                    line, last = _line(number, self._now_ns(), each, last)
                    text += line
                _write_whole(log.fileno(), text.encode())
                _write_head(head, number, last)
                self._newest = number, last
        except OSError as error:
            raise StorageUnavailable(f"cannot write the audit log {self._log}: {error.strerror}") from None

    def verify(self, noted: str = "") -> str:
        """Return what is wrong with the first entry that is broken; empty where the log is whole.

        Args:
            noted: hash of an entry that somebody noted down elsewhere, and that has to be there.
        """
        try:
            with self._locked(make=False) as head:
                newest, size = _read_head(head), self._log.stat().st_size
        except FileNotFoundError:
            newest, size = None, self._log.stat().st_size if self._log.exists() else 0
            if not size:
                return "there is no audit log"
        number, last, hashes = 0, BEGINNING, dict[int, str]()
        for number, line in enumerate(_lines(self._log, size), 1):
            entry = _entry(line)
            if fault := _fault(line, entry, number, last):
                return f"entry {number}: {fault}"
            last = entry.hash if entry else last
            if (newest and number == newest[0]) or noted == last:
                hashes[number] = last
        if newest is None:
            return f"after entry {number}: {HEAD} is missing or unreadable, which says what the newest entry is"
        if newest != (0, BEGINNING) and hashes.get(newest[0]) != newest[1]:
            return f"entry {newest[0]}: {'it is not the one that was written' if newest[0] in hashes else 'it is gone'}"
        return f"after entry {number}: none has the hash {noted}" if noted and noted not in hashes.values() else ""

    def newest(self) -> AuditEntry | None:
        """Return the newest entry that can be read."""
        entries = self.page(PageRequest(1)).entries
        return entries[0] if entries else None

    def entries(self) -> Iterator[AuditEntry]:
        """Yield the entries that can be read, oldest first."""
        if self._log.exists():
            yield from filter(None, map(_entry, _lines(self._log, self._log.stat().st_size)))

    def page(self, wanted: PageRequest) -> Page[AuditEntry]:
        """Return a page of the entries that can be read, newest first; raises UnusableInput for a cursor of no page."""
        entries = list[AuditEntry]()
        try:
            with self._log.open("rb") as log:
                end = os.fstat(log.fileno()).st_size
                if wanted.after:
                    end = _place(wanted.after, end)
                for place, line in _lines_before(log.fileno(), end):
                    if len(entries) == wanted.limit:
                        return Page(entries, str(place + len(line)))
                    if (entry := _entry(line)) is not None:
                        entries.append(entry)
        except FileNotFoundError:
            pass
        return Page(entries)

    def _end(self, log: int, head: int) -> tuple[int, str, list[Happening]]:
        """Return number and hash of the newest entry, and what is to be said of it; a torn line is removed."""
        found, size = list[Happening](), os.fstat(log).st_size
        last = next(_lines_before(log, size), None)
        if last is not None and not last[1].endswith(b"\n"):
            os.ftruncate(log, last[0])
            found.append(
                Happening(
                    LOG_SUBJECT, "", TORN_END_ACTION, f"{len(last[1])} bytes that were not written whole are removed"
                )
            )
            last = next(_lines_before(log, last[0]), None)
        entry, newest = _entry(last[1]) if last else None, _read_head(head)
        if last is not None and entry is None:
            found.append(Happening(LOG_SUBJECT, "", BROKEN_CHAIN_ACTION, "the entry before cannot be read"))
        if last is not None and newest is None:
            found.append(Happening(LOG_SUBJECT, "", BROKEN_CHAIN_ACTION, f"{HEAD} was missing or unreadable"))
        number, hashed = (entry.number, entry.hash) if entry else (0, BEGINNING)
        for known in (newest, self._newest):  # the head, and what this process remembers where both were made anew
            if known is not None and (number < known[0] or (number == known[0] and hashed != known[1])):
                said = f"entries up to {known[0]} ({known[1]}) were written, and are not there"
                found.append(Happening(LOG_SUBJECT, "", BROKEN_CHAIN_ACTION, said))
                break
        return number, hashed, found

    @contextmanager
    def _locked(self, *, make: bool = True) -> Iterator[int]:
        """Yield the file of the head, locked; raises FileNotFoundError where there is none and none is to be made."""
        head = os.open(self._head, os.O_RDWR | (os.O_CREAT if make else 0), 0o600)
        try:
            fcntl.flock(head, fcntl.LOCK_EX)
            if make and not self._log.exists() and os.fstat(head).st_size == 0:
                _write_head(head, 0, BEGINNING)  # before the first entry, so that it is never missing beside one
            yield head
        finally:
            os.close(head)


def _line(number: int, at_ns: int, happening: Happening, previous: str) -> tuple[str, str]:
    """Return the line of an entry, and its hash."""
    texts = {name: _shortened(text) for name, text in asdict(happening).items()}
    document = {"number": number, "at_ns": at_ns, **texts, "previous": previous}
    hashed = hashlib.sha256(json.dumps(document).encode()).hexdigest()
    return json.dumps(document | {"hash": hashed}) + "\n", hashed


def _shortened(text: str) -> str:
    return text if len(text) <= MAX_TEXT_LENGTH else text[: MAX_TEXT_LENGTH - 1] + "…"


def _fault(line: bytes, entry: AuditEntry | None, number: int, previous: str) -> str:
    if entry is None:
        return "it is no entry" if line.endswith(b"\n") else "it is not whole"
    if entry.number != number:
        return f"it says that it is number {entry.number}"
    if entry.previous != previous:
        return "the one before is not the one that was before it"
    happening = Happening(entry.who, entry.source, entry.action, entry.answer)
    if _line(entry.number, entry.at_ns, happening, entry.previous)[0].encode() != line:
        return "it was changed"
    return entry.answer if (entry.who, entry.action) == (LOG_SUBJECT, BROKEN_CHAIN_ACTION) else ""


def _entry(line: bytes) -> AuditEntry | None:
    try:
        document = json.loads(line)
    except (ValueError, RecursionError):
        return None
    kinds = {field.name: int if field.name in ("number", "at_ns") else str for field in fields(AuditEntry)}
    if not isinstance(document, dict) or {name: type(value) for name, value in document.items()} != kinds:
        return None
    return AuditEntry(**document)


def _lines(file: Path, size: int) -> Iterator[bytes]:
    """Yield the lines within the first `size` bytes; one that is too long comes in pieces."""
    with file.open("rb") as log:
        while size > 0 and (line := log.readline(min(size, MAX_LINE_LENGTH))):
            size -= len(line)
            yield line


def _lines_before(log: int, end: int) -> Iterator[tuple[int, bytes]]:
    """Yield place and line, from the one that ends at `end` backwards."""
    tail, begin = b"", end
    while begin > 0:
        size = min(BLOCK, begin)
        begin -= size
        tail = os.pread(log, size, begin) + tail
        pieces = tail.splitlines(keepends=True)
        first = pieces[1:] if begin > 0 else pieces
        place = begin + len(tail)
        for line in reversed(first):
            place -= len(line)
            yield place, line
        tail = pieces[0] if begin > 0 else b""


def _place(cursor: str, end: int) -> int:
    if not (cursor.isascii() and cursor.isdigit() and len(cursor) < 19 and int(cursor) <= end):
        raise UnusableInput(
            f"after={cursor[:40]} is no cursor of this list; take the one in the header Link of the page before, or "
            "leave it out to begin at the start"
        )
    return int(cursor)


def _write_whole(log: int, content: bytes) -> None:
    """Append all of the content, onto the disk, or nothing; raises OSError."""
    size = os.fstat(log).st_size
    try:
        left = memoryview(content)
        while left:
            left = left[os.write(log, left) :]
        os.fsync(log)
    except OSError:
        os.ftruncate(log, size)
        raise


def _read_head(head: int) -> tuple[int, str] | None:
    number, _, hashed = os.pread(head, 200, 0).decode(errors="replace").strip().partition(" ")
    return (int(number), hashed) if number.isascii() and number.isdigit() and len(hashed) == 64 else None


def _write_head(head: int, number: int, hashed: str) -> None:
    text = f"{number:020d} {hashed}\n"  # always as long, so that it is written over at once
    os.pwrite(head, text.encode(), 0)
    os.ftruncate(head, len(text))
