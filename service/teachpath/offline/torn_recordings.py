"""A recording that was cut off becomes demonstrations, by the same cut and verdict as live; never twice."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Final

from teachpath.io.store.recordings import RECORDINGS
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.import_job import derived_ids
from teachpath.offline.leftovers import REPAIRS
from teachpath.offline.recording_checks import Inspection
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Scene, Shape, Task

SALVAGED_SUFFIX: Final = ".salvaged"
NOTE: Final = "repaired after the service was cut off; what came after the last flush is missing"
OBJECT_SIZE: Final = (0.04, 0.04, 0.04)  # [m] of an object of which a file says the place alone


def repair(
    torn: Inspection, header: RecordingHeader, scene: Scene, store: Store, settings: RecordingSettings, data_dir: Path
) -> list[str]:
    """Make demonstrations of what can be read of a recording, and return their ids; the torn file is kept, renamed.

    They are made in a folder beside, and taken over with their rows in one transaction. Their ids follow from what
    is in it, so that a repair that was cut off is repeated without making one twice.
    """
    folder = data_dir / REPAIRS
    shutil.rmtree(folder, ignore_errors=True)
    made = _demonstrations(torn, header, scene, settings, folder)
    if made:
        task = Task(header.task, scene.name, header.calibration.name, 0, header.object_at_grasp)
        store.take_over(task, [(made, folder / RECORDINGS)])
    set_aside(torn.file, SALVAGED_SUFFIX)
    shutil.rmtree(folder, ignore_errors=True)
    return [demonstration.id for demonstration in made]


def scene_of(header: RecordingHeader, task: Task | None, scenes: dict[str, Scene], default: str) -> Scene | None:
    """Return the scene in which a take was recorded: as its file says, else as its task and the settings do."""
    if header.scene:
        carried = header.carried and Shape("object", "box", OBJECT_SIZE, header.carried)
        return Scene(header.scene, carried=carried)
    return scenes.get(task.scene if task else default)


def set_aside(file: Path, ending: str) -> Path:
    """Rename a file so that it is no recording any more; nothing is overwritten."""
    aside, number = file.with_name(file.name + ending), 2
    while aside.exists():
        aside, number = file.with_name(f"{file.name}{ending}-{number}"), number + 1
    return file.rename(aside)


def _demonstrations(
    torn: Inspection, header: RecordingHeader, scene: Scene, settings: RecordingSettings, folder: Path
) -> list[Demonstration]:
    scratch = Store(StoreSettings(data_dir=str(folder), database="sqlite://"))
    try:
        scratch.ensure_task(header.task, scene=scene.name, calibration=header.calibration.name)
        new_id = derived_ids(torn.digest.sha256)
        setup = RecordingSetup(
            header.task,
            header.tracker,
            header.calibration,
            scene,
            new_id=new_id,
            reported_object=lambda: header.object_pose,
            object_at_grasp=header.object_at_grasp,
        )
        session = RecordingSession(scratch, settings, setup)
        session.counter.note(NOTE)
        finished = [session.add(sample) for sample in torn.samples]
        finished += session.finish(torn=True)
        return [each[0] for each in finished if each is not None]
    finally:
        scratch.close()
