"""Rows, files and objects that disagree on where a recording is; objects that are gone, damaged or without a row."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from hashlib import sha256
from typing import Final

from teachpath.errors import Conflict, NotFound, StorageUnavailable
from teachpath.io.store.object_storage import is_address
from teachpath.offline.examination import Examination, Repair
from teachpath.offline.findings import FaultKind
from teachpath.offline.row_faults import called, report_lost, rewrite
from teachpath.records import Demonstration

RERUN_SUGGESTION: Final = "mend that, then run the doctor again"
RESTORE_SUGGESTION: Final = "bring it back from another version or a copy of the bucket"
PLACE: Final = re.compile(r"[^/]+/[^/]+\.mcap")


def check_objects(examination: Examination) -> None:
    """Compare rows and files with the object storage; before the rows are compared with the files.

    A recording that waits to be uploaded is no fault. While the object storage cannot be read, one finding says so.
    """
    recordings = examination.store.recordings
    examination.distant |= {row.id for row in examination.rows.values() if is_address(row.recording)}
    with _reported(examination):
        for row in list(examination.rows.values()):
            if row.id in examination.distant:
                _check_object(examination, row)
            elif recordings.objects.url and row.recording not in examination.files:
                _check_uploaded(examination, row)
        if recordings.objects.url:
            _check_spare_objects(examination)


@contextmanager
def _reported(examination: Examination) -> Iterator[None]:
    try:
        yield
    except StorageUnavailable as error:
        unknown = {row.id for row in examination.rows.values() if row.recording not in examination.files}
        examination.distant |= unknown  # whether they are there, nobody can say
        examination.report(FaultKind.UNREADABLE, f"{len(unknown)} recordings", str(error), advice=RERUN_SUGGESTION)


def _check_object(examination: Examination, row: Demonstration) -> None:
    """Compare the object that a row names with what was recorded, and remove the file that was uploaded."""
    objects = examination.store.recordings.objects
    place = objects.place(row.recording)
    here = examination.files.get(place)
    if here is not None and (row.digest is None or here.digest.sha256 != row.digest.sha256):
        here = None  # a copy of another one, which the spare files are looked at for
    try:
        whole = _is_recording_of(row, objects.read(row.recording))
    except NotFound:
        _report_gone(examination, row, place if here else "")
    else:
        if not whole:
            advice = f"move it away and run the doctor again, which uploads {place}" if here else RESTORE_SUGGESTION
            fault = f"the object {row.recording} is not what was recorded"
            examination.report(FaultKind.DAMAGED, called(row), fault, advice=advice)
        elif here is not None:
            fault = f"it was uploaded to {row.recording}, which is whole"
            examination.report(FaultKind.LEFTOVER, place, fault, partial(_remove, examination, place))
    if here is not None:
        examination.spare.pop(place, None)


def _report_gone(examination: Examination, row: Demonstration, place: str) -> None:
    fault = f"its object {row.recording} is gone"
    if place:
        repair = partial(_upload, examination, row, place)
        examination.report(FaultKind.MISSING, called(row), fault, repair)
    else:
        report_lost(examination, FaultKind.MISSING, row, fault, RESTORE_SUGGESTION)


def _check_uploaded(examination: Examination, row: Demonstration) -> None:
    """Let a row whose file is gone name the object that was made of it, as after an older database was restored."""
    objects = examination.store.recordings.objects
    address = objects.address(row.recording)
    try:
        content = objects.read(address)
    except NotFound:
        return
    if row.digest is not None and _is_recording_of(row, content):
        examination.distant.add(row.id)
        repair = partial(_name, examination, row, address)
        examination.report(FaultKind.MOVED, called(row), f"its recording {row.recording} lies at {address}", repair)


def _check_spare_objects(examination: Examination) -> None:
    """Fetch the objects that no row names, of any station; what is fetched is looked at like any file without a row."""
    recordings = examination.store.recordings
    named = examination.store.checks.named_recordings(everywhere=True)
    named |= {row.recording for row in examination.rows.values()}
    for address in recordings.objects.listed():
        place = recordings.objects.place(address)
        if not PLACE.fullmatch(place):
            continue  # it is none of ours
        if not named & {address, place} and place not in examination.files:
            examination.report(FaultKind.ORPHANED, address, "no row names it", partial(_fetch, examination, place))


def _upload(examination: Examination, row: Demonstration, place: str) -> Repair:
    recordings = examination.store.recordings
    content = recordings.path(place).read_bytes()
    if not recordings.objects.put_new(row.recording, content, lambda: False):
        raise Conflict(f"somebody stored another object at {row.recording} just now; run the doctor again")
    return Repair("uploaded again from the data folder")


def _remove(examination: Examination, place: str) -> Repair:
    examination.store.recordings.remove([place])
    return Repair("the file was removed")


def _name(examination: Examination, row: Demonstration, address: str) -> Repair:
    changed = examination.store.change_demonstration(row.id, recording=address)
    examination.rows[row.id] = changed
    return Repair("its row names the object now")


def _fetch(examination: Examination, place: str) -> Repair:
    recordings = examination.store.recordings
    task, _, name = place.partition("/")
    file = recordings.folder(task) / name
    file.parent.mkdir(parents=True, exist_ok=True)
    rewrite(file, recordings.objects.read(recordings.objects.address(place)))
    if (inspection := examination.inspect(file)) is not None:
        examination.files[place] = examination.spare[place] = inspection
    return Repair(f"fetched to {place}")


def _is_recording_of(row: Demonstration, content: bytes) -> bool:
    return row.digest is None or sha256(content).hexdigest() == row.digest.sha256
