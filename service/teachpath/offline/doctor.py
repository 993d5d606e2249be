"""The doctor: examines a station's data folder, and mends what can be mended, each fault on its own.

Every repair is one rename or one transaction, or is begun anew from what is still there; so the doctor may be killed at
any moment and run again. Nothing is deleted but temporary files: what is replaced is kept beside, renamed.
"""

from __future__ import annotations

import shutil
from functools import partial
from pathlib import Path

from teachpath.errors import UnusableRecording
from teachpath.io.store.motions import read_motion
from teachpath.io.store.store import Store
from teachpath.offline.examination import RESTORE, Examination, Repair
from teachpath.offline.file_faults import check_spare_files, check_torn_files
from teachpath.offline.findings import FaultKind, Finding
from teachpath.offline.leftovers import find_leftovers, remove_leftover
from teachpath.offline.lock import StationLock
from teachpath.offline.object_faults import check_objects
from teachpath.offline.row_faults import check_rows
from teachpath.offline.staging import AbandonedImport, abandoned_imports
from teachpath.offline.torn_recordings import SALVAGED_SUFFIX, set_aside
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Scene

ABANDONED_IMPORT_SUGGESTION = (
    "import the same files again, and it goes on; or remove it: teachpath prune --older-than 0"
)


def examine(
    store: Store,
    settings: RecordingSettings,
    scenes: dict[str, Scene],
    data_dir: Path,
    *,
    mend: bool = True,
    default_scene: str = "",
) -> list[Finding]:
    """Examine the data folder of a station whose service does not run, and mend what can be mended.

    Torn recordings go through the same cut and verdict as live; the torn file is kept beside the new ones, renamed.

    Args:
        store: rows and recordings.
        settings: by which torn recordings are cut and judged.
        scenes: of the settings, by their names.
        data_dir: folder of the station's data.
        mend: whether to mend; if False, only to say what would be mended.
        default_scene: of tasks that no row and no file says the scene of.

    Raises:
        Conflict: the service is running; its takes are not torn but in progress.
    """
    with StationLock(data_dir):
        examination = Examination(store, settings, scenes, data_dir, mend, default_scene)
        _check_database(examination)
        _check_leftovers(examination)
        _check_imports(examination)
        _check_motions(examination)
        examination.read()
        check_objects(examination)
        check_rows(examination)
        check_spare_files(examination)
        check_torn_files(examination)
        return examination.findings


def _check_database(examination: Examination) -> None:
    for fault in examination.store.checks.contradictions():
        advice = "restore a backup (teachpath restore), or make the rows anew: teachpath doctor --rebuild"
        examination.report(FaultKind.DATABASE, "the database", fault, advice=advice)


def _check_leftovers(examination: Examination) -> None:
    kept = examination.store.awaited_uploads()
    for path in find_leftovers(examination.data_dir, kept):
        name = path.relative_to(examination.data_dir).as_posix()
        remove = partial(_remove, path)
        examination.report(FaultKind.LEFTOVER, name, "a process that was killed left it", remove)


def _remove(path: Path) -> Repair:
    remove_leftover(path)
    return Repair("removed")


def _check_imports(examination: Examination) -> None:
    for each in abandoned_imports(examination.data_dir):
        name = each.folder.relative_to(examination.data_dir).as_posix()
        repair = partial(_clear, each) if each.is_stored else None
        examination.report(FaultKind.ABANDONED, name, each.fault, repair, advice=ABANDONED_IMPORT_SUGGESTION)


def _clear(each: AbandonedImport) -> Repair:
    shutil.rmtree(each.folder, ignore_errors=True)
    each.summary.unlink(missing_ok=True)
    return Repair("removed what it left")


def _check_motions(examination: Examination) -> None:
    motions = examination.store.motions
    for part in motions.unfinished():
        name = f"executions/{part.name}"
        examination.report(FaultKind.TORN, name, "it was cut off", partial(_mend_motion, examination.store, part))
    for file in motions.finished():
        try:
            fault = read_motion(file).fault
        except OSError as error:
            fault = error.strerror or str(error)
        if fault:
            name = f"executions/{file.name}"
            examination.report(FaultKind.DAMAGED, name, f"it cannot be read to its end ({fault})", advice=RESTORE)


def _mend_motion(store: Store, part: Path) -> Repair:
    try:
        return Repair(f"made {store.motions.mend(part).name} of what is whole of it")
    except UnusableRecording as error:
        return Repair(f"{error}; kept as {set_aside(part, SALVAGED_SUFFIX).name}")
