"""What may be removed to make room, and only when somebody says so: no demonstration, row or recording of one."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.store.database_files import DATABASE
from teachpath.io.store.database_files import REPLACED_SUFFIX as DATABASE_ASIDE
from teachpath.io.store.recordings import RECORDINGS
from teachpath.offline.backup import EXECUTIONS, REPLACED_FOLDER
from teachpath.offline.file_faults import COPY
from teachpath.offline.lock import StationLock
from teachpath.offline.row_faults import DAMAGED_SUFFIX
from teachpath.offline.staging import abandoned_imports
from teachpath.offline.torn_recordings import SALVAGED_SUFFIX

DAY: Final = 86_400.0  # [s]


def prune(data: Path, days: float, *, dry_run: bool = False, executions: bool = False) -> list[Path]:
    """Remove what is older than so many days and return it: what doctor and restore set aside, and abandoned imports.

    Args:
        data: folder of the station's data.
        days: age by which a file was written last; at least 0.
        dry_run: only return what would be removed.
        executions: also the recordings of executions.

    Raises:
        Conflict: the service is running.
        UnusableInput: a negative age.
    """
    if not days >= 0.0:
        raise UnusableInput(f"an age of {days:g} days is under 0")
    with StationLock(data):
        found = [
            file
            for ending in (SALVAGED_SUFFIX, COPY, DAMAGED_SUFFIX)
            for file in (data / RECORDINGS).glob(f"*/*{ending}*")
        ]
        found += [
            *(data / EXECUTIONS).glob("*.torn"),
            *data.glob(f"{REPLACED_FOLDER}-*"),
            *data.glob(f"{DATABASE}{DATABASE_ASIDE}*"),
        ]
        abandoned = [path for each in abandoned_imports(data) for path in (each.folder, each.summary)]
        found += [path for path in abandoned if path.exists()]
        found += (data / EXECUTIONS).glob("*.mcap") if executions else ()
        before = time.time() - days * DAY
        old = sorted(path for path in found if path.stat().st_mtime <= before)
        for path in () if dry_run else old:
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink()
    return old
