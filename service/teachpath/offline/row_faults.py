"""Rows whose recordings are gone, elsewhere, damaged, or not what was recorded."""

from __future__ import annotations

import os
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Final

from teachpath.io.store.faults import TEMPORARY
from teachpath.offline.examination import RESTORE, Examination, Repair
from teachpath.offline.findings import FaultKind
from teachpath.offline.recording_checks import Inspection
from teachpath.offline.torn_recordings import set_aside
from teachpath.records import Demonstration

DAMAGED_SUFFIX: Final = ".damaged"


def check_rows(examination: Examination) -> None:
    """Compare every row with its recording."""
    named: dict[str, str] = {}  # of a recording: the row that it belongs to
    for row in examination.rows.values():
        if row.recording in examination.unreadable or row.id in examination.distant:
            continue
        inspection = examination.files.get(row.recording)
        if inspection is None:
            _check_missing(examination, row)
        elif (owner := named.setdefault(row.recording, _owner(examination, row, inspection))) != row.id:
            fault = f"it names the recording of {owner}"
            report_lost(examination, FaultKind.DOUBLED, row, fault)
        elif row.digest is None:
            _check_unhashed(examination, row, inspection)
        elif inspection.digest.sha256 != row.digest.sha256:
            _check_changed(examination, row, inspection)


def _owner(examination: Examination, row: Demonstration, inspection: Inspection) -> str:
    """Return which of the rows that name one recording it belongs to: the one it says, else the first."""
    stated = examination.rows.get(inspection.stated.id) if inspection.stated else None
    return stated.id if stated and stated.recording == row.recording else row.id


def _check_missing(examination: Examination, row: Demonstration) -> None:
    if (copy := _find_copy(examination, row)) is None:
        fault = f"its recording {row.recording} is gone"
        report_lost(examination, FaultKind.MISSING, row, fault)
        return
    place = examination.store.recordings.place(copy.file)
    fault = f"its recording {row.recording} lies at {place}"
    examination.report(FaultKind.MOVED, called(row), fault, partial(_move_back, examination, copy, row))


def _check_unhashed(examination: Examination, row: Demonstration, inspection: Inspection) -> None:
    count = len(inspection.samples)
    if not inspection.is_whole:
        _check_changed(examination, row, inspection)
    elif count != row.samples:
        fault = f"{row.recording} has {count} samples, and its row says {row.samples}"
        report_lost(examination, FaultKind.EDITED, row, fault)
    else:
        fault = f"it was stored before digests were, and {row.recording} can be read whole"
        repair = partial(_keep_digest, examination, row, inspection)
        examination.report(FaultKind.UNHASHED, called(row), fault, repair, inspection=inspection)


def _check_changed(examination: Examination, row: Demonstration, inspection: Inspection) -> None:
    kind = FaultKind.EDITED if inspection.is_whole else FaultKind.DAMAGED
    fault = f"{row.recording} is {_difference(row, inspection)}"
    content = inspection.with_new_summary
    if content is not None and _is_content_of(content, row):
        repair = partial(_rewrite, inspection.file, content)
        examination.report(kind, called(row), fault, repair, inspection=inspection)
    elif (copy := _find_copy(examination, row)) is not None:
        repair = partial(_replace, examination, inspection, copy, row)
        examination.report(kind, called(row), fault, repair, inspection=inspection)
    else:
        report_lost(examination, kind, row, fault)


def _difference(row: Demonstration, inspection: Inspection) -> str:
    if not inspection.is_whole:
        return f"damaged ({inspection.fault}); {len(inspection.samples)} of its {row.samples} samples can be read"
    recorded = row.digest.sha256[:12] if row.digest else "unknown"
    return (
        f"whole, but not what was recorded: its SHA-256 is {inspection.digest.sha256[:12]}…, recorded was {recorded}…"
    )


def _is_content_of(content: bytes, row: Demonstration) -> bool:
    return row.digest is None or sha256(content).hexdigest() == row.digest.sha256


def _find_copy(examination: Examination, row: Demonstration) -> Inspection | None:
    """Return a whole recording that no row names and that is the one of this row; it is spare no longer."""
    for place, inspection in examination.spare.items():
        if row.digest is not None:
            found = inspection.digest.sha256 == row.digest.sha256
        else:
            found = inspection.is_whole and inspection.stated is not None and inspection.stated.id == row.id
        if found:
            return examination.spare.pop(place)
    return None


def _move_back(examination: Examination, copy: Inspection, row: Demonstration) -> Repair:
    recordings = examination.store.recordings
    recordings.move(recordings.place(copy.file), row.recording)
    return Repair("it is back in its place")


def _replace(examination: Examination, damaged: Inspection, copy: Inspection, row: Demonstration) -> Repair:
    aside = set_aside(damaged.file, DAMAGED_SUFFIX)
    _move_back(examination, copy, row)
    return Repair(f"a whole copy took its place, and it is kept as {aside.name}")


def _rewrite(file: Path, content: bytes) -> Repair:
    rewrite(file, content)
    return Repair("only its summary was damaged; it was written anew")


def rewrite(file: Path, content: bytes) -> None:
    """Replace the content of a file, whole or not at all."""
    temporary = file.with_name(file.name + TEMPORARY)
    with temporary.open("wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(file)


def _keep_digest(examination: Examination, row: Demonstration, inspection: Inspection) -> Repair:
    examination.store.change_demonstration(row.id, digest=inspection.digest)
    return Repair("its SHA-256 is kept from now on")


def called(row: Demonstration) -> str:
    """Return what a finding calls a row."""
    return f"{row.task} {row.number} ({row.id})"


def report_lost(examination: Examination, kind: FaultKind, row: Demonstration, fault: str, back: str = RESTORE) -> None:
    """Report a row whose samples are lost; there is nothing to do where it is discarded."""
    if row.discarded_ns:
        advice = "it is discarded, and nothing is learned from it"
    else:
        advice = f"{back}; or give it up: teachpath amend {row.task} {row.number} --discard"
    examination.report(kind, called(row), fault, advice=advice, settled=bool(row.discarded_ns))
