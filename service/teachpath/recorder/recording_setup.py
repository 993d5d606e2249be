"""What a recording session records, and how."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from teachpath.io.store.recordings import RecordingHeader
from teachpath.recorder.object_place import ObjectPlace
from teachpath.recorder.take import random_id
from teachpath.records import Calibration, ObjectPose, Routine, Scene


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
