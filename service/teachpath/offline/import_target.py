"""Scene and calibration of an import: those of the task, as for a live recording, unless another one is named."""

from __future__ import annotations

from contextlib import suppress

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.store import Store
from teachpath.recorder.calibrations import Calibrations
from teachpath.records import Calibration, Task

NEW_SCENE = "empty"  # of a task that an import makes
NEW_CALIBRATION = {"robottasks": "robottasks"}  # by format; else identity


def import_scene(store: Store, task: str, scene: str) -> str:
    """Return the name of the scene in which a file is judged; `scene` may be empty.

    Raises:
        Conflict: the task has another scene, or is archived.
    """
    existing = existing_task(store, task)
    if existing is None:
        return scene or NEW_SCENE
    if scene and scene != existing.scene:
        raise Conflict(
            f"task {task} has the scene {existing.scene}, not {scene}; leave the scene out, or name another task"
        )
    return existing.scene


def import_calibration(store: Store, calibrations: Calibrations, task: str, kind: str, calibration: str) -> Calibration:
    """Return the calibration of a file's frame; `calibration` may be empty, `kind` is its format.

    Raises:
        NotFound: there is none of that name.
    """
    existing = existing_task(store, task)
    own = existing.calibration if existing else ""
    return calibrations.get(calibration or NEW_CALIBRATION.get(kind, "") or own or "identity")


def starts_at_object(store: Store, task: str, wanted: bool) -> bool:
    """Return whether the object lies where the hand grasps: as the task says, or as `wanted` for a new one."""
    existing = existing_task(store, task)
    return existing.object_at_grasp if existing else wanted


def existing_task(store: Store, task: str) -> Task | None:
    """Return the task that an import adds to; None: it makes one. Raises Conflict where it is archived."""
    with suppress(NotFound):
        return store.open_task(task)
    return None
