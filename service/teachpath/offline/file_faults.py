"""Recordings without a row, and recordings that were cut off."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Final

from teachpath.errors import NotFound
from teachpath.offline.examination import Examination, Repair
from teachpath.offline.findings import FaultKind
from teachpath.offline.recording_checks import Inspection
from teachpath.offline.row_faults import rewrite
from teachpath.offline.torn_recordings import SALVAGED_SUFFIX, repair, scene_of, set_aside
from teachpath.records import Demonstration, Scene, Task

COPY: Final = ".copy"
NO_SCENE: Final = (
    "its task {task} is in no row, or its scene {scene!r} in no settings, and the file does not say what the object's "
    "place was; name a scene of the settings: teachpath doctor --scene NAME --config FILE"
)


def check_spare_files(examination: Examination) -> None:
    """Adopt the finished recordings that no row names, oldest first, so that they are numbered as they were."""
    for place, inspection in sorted(examination.spare.items(), key=lambda item: _order(item[1])):
        owner = _owner(examination, inspection)
        if owner is not None:
            fault = f"it is a copy of the recording of {owner.task} {owner.number} ({owner.id})"
            aside = partial(_set_aside, inspection, COPY)
            examination.report(FaultKind.DOUBLED, place, fault, aside, inspection=inspection)
        elif inspection.header is None:
            examination.report(
                FaultKind.DAMAGED,
                place,
                f"it has no row, and it is no recording of hand samples that can be read ({inspection.fault})",
                advice="bring it back from a backup, or move it out of the folder",
            )
        elif inspection.is_whole and inspection.stated is not None:
            fault, adopt = "it was whole but for its row", partial(_adopt, examination, inspection)
            examination.report(FaultKind.ORPHANED, place, fault, adopt, inspection=inspection)
        elif inspection.with_new_summary is not None and inspection.stated is not None:
            fault, adopt = "it has no row, and its summary is damaged", partial(_adopt, examination, inspection)
            examination.report(FaultKind.DAMAGED, place, fault, adopt, inspection=inspection)
        else:
            kind = FaultKind.ORPHANED if inspection.is_whole else FaultKind.DAMAGED
            fault = f"it has no row, and its own facts make none ({inspection.fault or 'it states none'})"
            examination.report(kind, place, fault, partial(_repair, examination, inspection), inspection=inspection)


def check_torn_files(examination: Examination) -> None:
    """Make demonstrations of the recordings that were never finished."""
    for part in examination.store.recordings.unfinished():
        if (inspection := examination.inspect(part)) is None:
            continue
        place = examination.store.recordings.place(part)
        key = inspection.stated.id if inspection.stated else part.name.partition(".")[0]
        owner = examination.rows.get(key)
        if inspection.header is None:
            fault = f"nothing could be read ({inspection.fault})"
            examination.report(FaultKind.TORN, place, fault, partial(_set_aside, inspection, SALVAGED_SUFFIX))
        elif owner is not None:
            fault = f"its demonstration {owner.task} {owner.number} ({owner.id}) is there already"
            examination.report(FaultKind.DOUBLED, place, fault, partial(_set_aside, inspection, COPY))
        else:
            fault = (
                f"{len(inspection.samples)} samples ({inspection.seconds:.1f} s) are whole, at most the last second is "
                "missing"
            )
            mend = partial(_repair, examination, inspection)
            examination.report(FaultKind.TORN, place, fault, mend, inspection=inspection)


def _order(inspection: Inspection) -> tuple[int, bool, str]:
    stated = inspection.stated
    if stated is None:
        return (inspection.samples[0].receive_ns if inspection.samples else 0), True, inspection.file.name
    return stated.created_ns, inspection.file.stem != stated.id, inspection.file.name


def _owner(examination: Examination, inspection: Inspection) -> Demonstration | None:
    """Return the row of the demonstration that a file without a row is a copy of, if there is one."""
    return examination.rows.get(inspection.stated.id if inspection.stated else inspection.file.stem)


def _set_aside(inspection: Inspection, ending: str) -> Repair:
    return Repair(f"kept as {set_aside(inspection.file, ending).name}")


def _adopt(examination: Examination, inspection: Inspection) -> Repair:
    """Store the row that a recording states of itself."""
    stated, store = inspection.stated, examination.store
    assert stated is not None
    scene = _scene_of(examination, inspection, stated.task)
    if (content := inspection.with_new_summary) is not None:
        rewrite(inspection.file, content)
        inspection = examination.inspect(inspection.file) or inspection
    calibration = stated.calibration.name.partition("@")[0]
    at_grasp = inspection.header is not None and inspection.header.object_at_grasp
    store.ensure_task(stated.task, scene=scene.name, calibration=calibration, object_at_grasp=at_grasp)
    place = store.recordings.place(inspection.file)
    row = store.add_demonstration(replace(stated, recording=place, digest=inspection.digest))
    examination.rows[row.id] = row
    return Repair(f"made {row.id}", (row.id,))


def _repair(examination: Examination, inspection: Inspection) -> Repair:
    """Make demonstrations of the samples that can be read."""
    header = inspection.header
    assert header is not None
    scene = _scene_of(examination, inspection, header.task)
    made = repair(inspection, header, scene, examination.store, examination.settings, examination.data_dir)
    if not made:
        return Repair("the hand grasped nothing in it, so there is no demonstration to make")
    return Repair(f"made {', '.join(made)}", tuple(made))


def _scene_of(examination: Examination, inspection: Inspection, task: str) -> Scene:
    """Return the scene in which a take was recorded; raises NotFound, with the way out."""
    header = inspection.header
    assert header is not None
    stored: Task | None
    try:
        stored = examination.store.task(task)
    except NotFound:
        stored = None
    scene = scene_of(header, stored, examination.scenes, examination.default_scene)
    if scene is None:
        named = stored.scene if stored else examination.default_scene
        raise NotFound(NO_SCENE.format(task=task, scene=named))
    return scene
