"""A service that is killed while it takes over an import: the job runs again, and nothing is there twice."""

import os
import signal
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import event
from sqlalchemy.orm import Session

from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.store.recordings import RECORDINGS
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.doctor import examine
from teachpath.offline.import_job import PREPARED_FOLDER, UPLOAD, ImportOrder, prepare_import
from teachpath.offline.track_samples import PhaseMarks
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array, Calibration, Demonstration, Job, JobState, Scene, Task
from tests.waiting import HANG

IMPORT_ARGUMENTS, JOB = Scene("empty"), "import-1"
TASK = Task("wipe", IMPORT_ARGUMENTS.name, "identity", 0)
MOTIONS = 3


def motions() -> Array:
    """Return straight motions (MOTIONS, 50, 4) of t, x, y, z."""
    steps = np.arange(50)
    return np.stack(
        [
            np.column_stack((0.02 * steps, 0.3 + 0.001 * steps, 0 * steps + 0.01 * k, 0 * steps + 0.5))
            for k in range(MOTIONS)
        ]
    )


def prepared(folder: Path) -> list[Demonstration]:
    """Run the job in its folder, as its process does."""
    order = ImportOrder(
        JOB,
        folder,
        TASK.name,
        "motions.npy",
        "npy",
        ReadOptions(),
        PhaseMarks(),
        IMPORT_ARGUMENTS,
        Calibration("identity"),
        RecordingSettings(),
        ImportSettings(),
    )
    return list(prepare_import(order).made)


def finish(store: Store, folder: Path) -> str:
    return store.finish_import(JOB, TASK, [(prepared(folder), folder / PREPARED_FOLDER / RECORDINGS)])


def finish_and_die(data: Path, folder: Path) -> None:
    """Be killed when the recordings are taken over, and their rows are not."""
    store = Store(StoreSettings(data_dir=str(data)))

    @event.listens_for(Session, "before_commit")
    def die(_: Session) -> None:
        if store.recordings.finished():
            os.kill(os.getpid(), signal.SIGKILL)

    finish(store, folder)


@pytest.mark.parametrize("examined", [False, True])
def test_an_import_that_was_killed_between_recordings_and_rows_is_there_once(tmp_path: Path, examined: bool) -> None:
    data, folder = tmp_path / "data", tmp_path / "upload"
    folder.mkdir()
    with (folder / UPLOAD).open("wb") as file:
        np.save(file, motions())
    store = Store(StoreSettings(data_dir=str(data)))
    store.ensure_task(TASK.name, scene=TASK.scene, calibration=TASK.calibration)
    store.add_job(Job(JOB, TASK.name, "import", {}, JobState.RUNNING, 0.0, "", "", 1, 0, 0))
    killed = get_context("spawn").Process(target=finish_and_die, args=(data, folder))
    killed.start()
    killed.join(HANG)
    assert killed.exitcode == -signal.SIGKILL
    assert (len(store.recordings.finished()), store.demonstrations(TASK.name)) == (MOTIONS, [])
    if examined:
        assert len(examine(store, RecordingSettings(), {IMPORT_ARGUMENTS.name: IMPORT_ARGUMENTS}, data)) == MOTIONS
    assert finish(store, folder) == f"1-{MOTIONS}"
    stored = store.demonstrations(TASK.name)
    assert [len(store.recordings.samples(row.recording)) for row in stored] == [50] * MOTIONS
    assert sorted(row.recording for row in stored) == list(map(store.recordings.place, store.recordings.finished()))
    store.close()
