"""What a recording session records, and how."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.store.salvage import RecordingHeader
from teachpath.io.store.store import Store
from teachpath.recorder.object_place import ObjectPlace
from teachpath.recorder.take import random_id
from teachpath.records import Calibration, Demonstration, ObjectPose, RecordingRequest, Routine, Scene, Trajectory
from teachpath_proto.keys import is_name, name_refusal

MAX_RATE: Final = 10_000.0  # [Hz] that a client may declare


@dataclass(frozen=True, slots=True)
class RecordingSetup:
    """What a session records, and how.

    Attributes:
        rate: [Hz] that the client declares; 0: it declares none.
        routine: how takes follow each other.
        new_id: returns the id of the next take.
        reported_object: returns where the object was told to lie; None: where the scene has it.
        object_at_grasp: the object lies where the hand grasps.
    """

    task: str
    tracker: str
    calibration: Calibration
    scene: Scene
    rate: float = 0.0
    routine: Routine = field(default_factory=Routine)
    new_id: Callable[[], str] = random_id
    reported_object: Callable[[], ObjectPose | None] = lambda: None
    object_at_grasp: bool = False

    def header(self, place: ObjectPlace) -> RecordingHeader:
        """Return what the recording of a take is of, whose object lies at `place`."""
        return RecordingHeader(
            self.task,
            self.tracker,
            self.calibration,
            self.scene.name,
            place.scene_position,
            place.reported,
            self.object_at_grasp,
        )


@dataclass(frozen=True)
class Lookup:
    """Finds what a recording names; all functions raise NotFound.

    Attributes:
        scene: returns the scene of a name as it was saved last.
        calibration: returns the calibration of a name.
        reported_object: returns where the object of a scene was told to lie; None: where the scene has it.
    """

    scene: Callable[[str], Scene]
    calibration: Callable[[str], Calibration]
    reported_object: Callable[[str], ObjectPose | None] = lambda scene: None


def find_setup(request: RecordingRequest, store: Store, lookup: Lookup) -> RecordingSetup:
    """Return what a request records; raises NotFound, or Conflict where its task is archived."""
    task = store.open_task(request.task)
    return RecordingSetup(
        task=request.task,
        tracker=request.tracker,
        calibration=lookup.calibration(request.calibration or task.calibration),
        scene=lookup.scene(task.scene),
        rate=request.rate,
        routine=request.routine,
        reported_object=partial(lookup.reported_object, task.scene),
        object_at_grasp=task.object_at_grasp,
    )


def check_request(request: RecordingRequest) -> None:
    """Raise UnusableInput for a name that cannot be a folder and a key, or a rate outside its limits."""
    for what, name in (("task", request.task), ("tracker", request.tracker)):
        if not is_name(name):
            raise UnusableInput(name_refusal(what, name))
    if not 0.0 <= request.rate <= MAX_RATE:
        raise UnusableInput(f"a rate of {request.rate:g} Hz is outside 0 (not said) to {MAX_RATE:g}")


@dataclass(frozen=True)
class DemonstrationCallbacks:
    """What the recorder calls when demonstrations come or change.

    Attributes:
        added: called with each new demonstration, on a thread that completes takes; the next take of its recording
            waits for it.
        changed: called with each demonstration that an operator has discarded, restored, marked or trimmed.
    """

    added: Callable[[Demonstration, Trajectory], None] = lambda demonstration, trajectory: None
    changed: Callable[[Demonstration], None] = lambda demonstration: None
