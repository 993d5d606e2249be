"""Batches of files to import, and an import of them that is killed at every moment in turn.

`python -m tests.unit.offline.batches FOLDER MOMENTS` prints what it found as JSON; see `kill_at_moments`.
"""

import json
import os
import shutil
import sys
from pathlib import Path

from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.batch_import import FileOutcome, import_batch
from teachpath.offline.import_job import ImportOrder
from teachpath.offline.staging import STAGING
from teachpath.offline.track_samples import PhaseMarks
from teachpath.recorder.recording_work import call_directly
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Scene

TASK, FILES = "wipe", 3
STRIDE = 41  # actions between two moments
# What a process does to its surroundings; it is killed before one of them.
ACTIONS = ("open", "os.rename", "os.remove", "os.rmdir", "os.mkdir", "shutil.copyfile", "shutil.rmtree")


def write_files(folder: Path, *, bad: bool = False) -> list[Path]:
    """Write tables of straight motions; `bad`: the last one is none."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / f"{k}.csv" for k in range(FILES)]
    for k, file in enumerate(files):
        file.write_text("t,x,y,z\n" + "".join(f"{i * 0.02:.2f},{i / 100},{k / 10},0.5\n" for i in range(40)))
    if bad:
        files[-1].write_text("t,x,y,z\n0,1,2,3\n")
    return files


ORDER = ImportOrder(
    "", Path(), TASK, "", "", ReadOptions(), PhaseMarks(), Scene("empty"), Calibration("identity"),
    RecordingSettings(), ImportSettings(),
)  # fmt: skip


def run_batch(data: Path, files: list[Path]) -> list[FileOutcome]:
    """Import files into the store of a folder."""
    store = Store(StoreSettings(data_dir=str(data)))
    try:
        return import_batch(store, data, files, ORDER, call=call_directly)
    finally:
        store.close()


def state(data: Path) -> tuple[int, int, int]:
    """Return how many rows, whole recordings without a doubt of theirs, and staging folders there are."""
    store = Store(StoreSettings(data_dir=str(data)))
    try:
        rows = store.demonstrations(TASK) if TASK in {task.name for task in store.tasks()} else []
        whole = [row for row in rows if len(store.recordings.samples(row.recording)) == row.samples]
        staged = list((data / STAGING).glob("*")) if (data / STAGING).exists() else []
        assert len({row.recording for row in rows}) == len(rows)
        return len(rows), len(whole), len(staged)
    finally:
        store.close()


def kill_at_moments(folder: Path, moments: int) -> list[list[int]]:
    """Kill an import before its first, second, ... action, then import the same files again, and so on.

    Returns:
        Of each moment the rows after the kill, and then rows, whole recordings, recordings without a row after the
        import was repeated; ends with the first import that was not killed.
    """
    files = write_files(folder / "files")
    found: list[list[int]] = []
    for moment in range(1, moments + 1):
        data = folder / f"data{moment}"
        child = os.fork()
        if child == 0:
            _die_at(1 + (moment - 1) * STRIDE)
            run_batch(data, files)
            os._exit(0)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        rows, _, _ = state(data)
        if status == 9:
            run_batch(data, files)
        again, whole, _ = state(data)
        orphans = len(list((data / "recordings").glob("*/*.mcap*"))) - again
        found.append([rows, again, whole, orphans])
        shutil.rmtree(data)
        if status == 0:
            break
    return found


def _die_at(action: int) -> None:
    left = [action]

    def on_event(event: str, _: object) -> None:
        if event in ACTIONS:
            left[0] -= 1
            if not left[0]:
                os._exit(9)

    sys.addaudithook(on_event)


if __name__ == "__main__":
    print(json.dumps(kill_at_moments(Path(sys.argv[1]), int(sys.argv[2]))))
