"""The writer of the audit log: in order, and without a flood of refusals."""

import threading

from teachpath.access.audit import MAX_REFUSALS, MAX_WAITING, WINDOW, Audit
from teachpath.errors import StorageUnavailable
from teachpath.io.audit_log import Happening
from teachpath.records import JournalEntry
from teachpath_proto.control import JournalVerb


class MemoryLog:
    def __init__(self) -> None:
        self.entries = list[Happening]()
        self.is_full = False
        self.may_write = threading.Event()
        self.may_write.set()

    def append(self, happenings: list[Happening]) -> None:
        self.may_write.wait()
        if self.is_full:
            raise StorageUnavailable("the disk is full")
        self.entries += happenings


def test_entries_come_in_order_and_none_is_left_at_the_end() -> None:
    log = MemoryLog()
    audit = Audit(log)
    audit.start()
    for number in range(1000):
        audit.note("anna", "10.0.0.7", f"order {number}", "200")
    audit.note_journal(JournalEntry(0, "anna", JournalVerb.START, "e1", "done"))
    audit.stop()
    assert [entry.action for entry in log.entries] == [*(f"order {number}" for number in range(1000)), "start e1"]


def test_of_a_flood_of_refusals_some_are_written_and_the_others_are_counted() -> None:
    now, log = [0.0], MemoryLog()
    audit = Audit(log, lambda: now[0])
    for _ in range(5000):
        audit.note("", "10.0.0.66", "GET /tasks", "401", is_refusal=True)
    audit.note("", "10.0.0.7", "GET /tasks", "401", is_refusal=True)  # of another
    audit.note("anna", "10.0.0.66", "POST /stop", "200")  # nothing that is done is left out
    now[0] = WINDOW
    audit.note("", "10.0.0.66", "GET /tasks", "401", is_refusal=True)
    audit.start()
    audit.stop()
    assert len(log.entries) == MAX_REFUSALS + 3
    assert log.entries[-1].answer == f"401 (and {5000 - MAX_REFUSALS} further refusals before)"


def test_what_cannot_be_written_is_said_and_counted() -> None:
    log = MemoryLog()
    log.is_full = True
    audit = Audit(log)
    audit.start()
    audit.note("anna", "", "order", "200")
    audit.stop()
    assert audit.notes() == ["what people and programs do is not written down: the disk is full"]
    log.is_full = False
    audit.start()
    audit.note("anna", "", "next order", "200")
    audit.stop()
    assert audit.notes() == []
    assert [(entry.action, entry.answer) for entry in log.entries] == [
        ("next order", "200"), ("lost entries", "1 entries could not be written"),
    ]  # fmt: skip


def test_a_disk_that_hangs_holds_nobody_up() -> None:
    log = MemoryLog()
    log.may_write.clear()
    audit = Audit(log)
    audit.start()
    for _ in range(MAX_WAITING + 1000):
        audit.note("anna", "", "order", "200")
    log.may_write.set()
    audit.stop()
    assert 0 < len(log.entries) <= MAX_WAITING + 1000
    assert any(entry.action == "lost entries" for entry in log.entries)
