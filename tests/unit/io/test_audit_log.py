"""The audit log: whatever is done to its file is found, and named by the first entry that is broken."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import pytest

from teachpath.errors import StorageUnavailable, UnusableInput
from teachpath.io.audit_log import HEAD, LOG, MAX_TEXT_LENGTH, AuditLog, Happening
from teachpath.io.store.pages import PageRequest
from tests.waiting import HANG

Lines = list[bytes]


def happening(number: int) -> Happening:
    return Happening("anna", "10.0.0.7", f"POST /stop {number}", "200")


def written(folder: Path, count: int = 9) -> AuditLog:
    log = AuditLog(folder)
    for number in range(1, count + 1):
        log.append([happening(number)])
    assert log.verify() == ""
    return log


def lines(folder: Path) -> Lines:
    return (folder / LOG).read_bytes().splitlines(keepends=True)


def changed(line: bytes, **fields: object) -> bytes:
    return json.dumps(json.loads(line) | fields).encode() + b"\n"


def edited(all_: Lines) -> Lines:
    return [*all_[:4], changed(all_[4], who="bert"), *all_[5:]]


def spaced(all_: Lines) -> Lines:
    return [*all_[:4], all_[4].replace(b": ", b":  ", 1), *all_[5:]]


def swapped(all_: Lines) -> Lines:
    return [*all_[:4], all_[5], all_[4], *all_[6:]]


def renumbered(all_: Lines) -> Lines:
    return [*all_[:4], *(changed(line, number=json.loads(line)["number"] - 1) for line in all_[5:])]


ATTACKS: list[tuple[Callable[[Lines], Lines], str]] = [
    (edited, "entry 5: it was changed"),
    (spaced, "entry 5: it was changed"),
    (swapped, "entry 5: it says that it is number 6"),
    (renumbered, "entry 5: the one before is not the one that was before it"),
    (lambda a: [*a[:4], *a[5:]], "entry 5: it says that it is number 6"),
    (lambda a: [*a[:4], a[3], *a[4:]], "entry 5: it says that it is number 4"),
    (lambda a: [*a[:4], b"nonsense\n", *a[4:]], "entry 5: it is no entry"),
    (lambda a: [*a[:4], b"[" * 9000 + b"\n", *a[5:]], "entry 5: it is no entry"),
    (lambda a: [*a[:4], changed(a[4], number=True), *a[5:]], "entry 5: it is no entry"),
    (lambda a: [*a[:4], changed(a[4], more=1), *a[5:]], "entry 5: it is no entry"),
    (lambda a: a[1:], "entry 1: it says that it is number 2"),
    (lambda a: a[:-1], "entry 9: it is gone"),
    (lambda a: [*a[:-1], a[-1][:-9]], "entry 9: it is not whole"),
    (lambda a: [], "entry 9: it is gone"),
]


@pytest.mark.parametrize(("attack", "said"), ATTACKS)
def test_whatever_is_done_to_the_file_is_named_and_stays_named(
    tmp_path: Path, attack: Callable[[Lines], Lines], said: str
) -> None:
    log = written(tmp_path)
    (tmp_path / LOG).write_bytes(b"".join(attack(lines(tmp_path))))
    assert log.verify() == said
    log.append([happening(10)])  # what comes later hides nothing
    assert log.verify() != ""


def test_whoever_makes_the_end_anew_is_found_by_the_head(tmp_path: Path) -> None:
    written(tmp_path)
    before = lines(tmp_path)
    (tmp_path / LOG).write_bytes(b"".join(before[:8]))
    other = tmp_path / "other"
    other.mkdir()
    (other / LOG).write_bytes(b"".join(before[:8]))
    AuditLog(other).append([Happening("bert", "", "nothing", "200")])
    (tmp_path / LOG).write_bytes((other / LOG).read_bytes())
    assert AuditLog(tmp_path).verify().startswith("entry 9: ")


def test_a_head_that_is_gone_is_missed(tmp_path: Path) -> None:
    log = written(tmp_path)
    (tmp_path / HEAD).unlink()
    assert log.verify() == "after entry 9: audit.head is missing or unreadable, which says what the newest entry is"
    log.append([happening(10)])
    assert log.verify() == "entry 10: audit.head was missing or unreadable"


def test_a_log_that_was_made_anew_lacks_what_was_noted_elsewhere(tmp_path: Path) -> None:
    log = written(tmp_path)
    newest = log.newest()
    assert newest is not None
    log.append([happening(10)])
    assert log.verify(newest.hash) == ""
    (tmp_path / LOG).unlink()
    (tmp_path / HEAD).unlink()
    assert written(tmp_path, 12).verify(newest.hash) == f"after entry 12: none has the hash {newest.hash}"


def test_a_service_that_runs_misses_what_it_wrote_though_all_of_it_is_made_anew(tmp_path: Path) -> None:
    log = written(tmp_path)
    newest = log.newest()
    assert newest is not None
    for name in (LOG, HEAD):
        (tmp_path / name).unlink()
    written(tmp_path, 3)
    assert log.verify() == ""
    log.append([happening(10)])
    assert log.verify() == f"entry 4: entries up to 9 ({newest.hash}) were written, and are not there"


def test_what_a_dying_process_left_is_removed_and_breaks_nothing(tmp_path: Path) -> None:
    log = written(tmp_path)
    with (tmp_path / LOG).open("ab") as file:
        file.write(b'{"number": 10, "at_')
    assert log.verify() == "entry 10: it is not whole"
    log.append([happening(11)])
    assert log.verify() == ""
    said = [(entry.number, entry.who, entry.action) for entry in log.entries()][-2:]
    assert said == [(10, "the audit log", "found torn"), (11, "anna", "POST /stop 11")]


def test_entries_that_the_head_does_not_know_yet_are_whole(tmp_path: Path) -> None:
    """A process that dies between the two files has written the entry."""
    log = written(tmp_path)
    head = (tmp_path / HEAD).read_bytes()
    log.append([happening(10)])
    (tmp_path / HEAD).write_bytes(head)
    assert log.verify() == ""
    log.append([happening(11)])
    assert log.verify() == ""


def test_several_write_at_a_time(tmp_path: Path) -> None:
    def write() -> None:
        log = AuditLog(tmp_path)
        for number in range(20):
            log.append([happening(number), happening(number)])

    threads = [threading.Thread(target=write) for _ in range(4)]
    for thread in threads:
        thread.start()
    code = (
        "import sys; from pathlib import Path; from teachpath.io.audit_log import AuditLog, Happening\n"
        "for n in range(20): AuditLog(Path(sys.argv[1])).append([Happening('other process', '', str(n), '')])"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True, timeout=HANG)
    for thread in threads:
        thread.join()
    log = AuditLog(tmp_path)
    assert log.verify() == ""
    assert len(list(log.entries())) == 4 * 40 + 20


def test_a_full_disk_leaves_the_log_as_it_was(tmp_path: Path) -> None:
    log = written(tmp_path)
    before = (tmp_path / LOG).read_bytes()
    code = (
        "import resource, signal, sys; from pathlib import Path\n"
        "from teachpath.io.audit_log import AuditLog, Happening\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({len(before) + 40},) * 2)\n"
        "AuditLog(Path(sys.argv[1])).append([Happening('anna', '', 'POST', '200')])"
    )
    ended = subprocess.run([sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, timeout=HANG)
    assert "StorageUnavailable: cannot write the audit log" in ended.stderr
    assert (tmp_path / LOG).read_bytes() == before
    assert log.verify() == ""


def test_a_place_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / LOG).mkdir()
    with pytest.raises(StorageUnavailable, match="cannot write the audit log"):
        AuditLog(tmp_path).append([happening(1)])


def test_nobody_else_may_read_it(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        written(tmp_path)
    finally:
        os.umask(before)
    assert {(tmp_path / name).stat().st_mode & 0o777 for name in (LOG, HEAD)} == {0o600}


def test_what_is_long_or_strange_is_one_entry(tmp_path: Path) -> None:
    log = written(tmp_path)
    strange = "\n\0\u2028\ud800é" + "\U0001f916" * 5000
    log.append([Happening(strange, strange, strange, strange)])
    assert log.verify() == ""
    newest = log.newest()
    assert newest is not None
    assert newest.who == strange[: MAX_TEXT_LENGTH - 1] + "…"


def test_pages_go_back_to_the_beginning_while_others_write(tmp_path: Path) -> None:
    log = written(tmp_path, 1)
    log.append([happening(number) for number in range(2, 701)])  # of several blocks
    numbers, after = list[int](), ""
    while True:
        page = log.page(PageRequest(50, after))
        numbers += [entry.number for entry in page.entries]
        log.append([happening(0)])
        after = page.next
        if not after:
            break
    assert numbers == list(range(700, 0, -1))
    for cursor in ("x", "-1", "9" * 18, "9" * 30, "²"):
        with pytest.raises(UnusableInput, match="is no cursor of this list"):
            log.page(PageRequest(5, cursor))


def test_there_may_be_none(tmp_path: Path) -> None:
    log = AuditLog(tmp_path)
    assert log.verify() == "there is no audit log"
    assert (log.newest(), list(log.entries()), log.page(PageRequest()).entries) == (None, [], [])
    assert list(tmp_path.iterdir()) == []


def test_an_entry_says_all(tmp_path: Path) -> None:
    log = AuditLog(tmp_path, now_ns=lambda: 7)
    log.append([happening(1)])
    newest = log.newest()
    assert newest is not None
    document = asdict(newest)
    assert document.pop("hash") != document["previous"] == "0" * 64
    assert list(document.values())[:-1] == [1, 7, "anna", "10.0.0.7", "POST /stop 1", "200"]
