"""Where the objects of the scenes lie: as told over REST or on the bus, else as the scenes have them."""

from __future__ import annotations

import logging
import math
import threading
from collections.abc import Callable
from typing import Final

import numpy as np

from teachpath.errors import NotFound, TeachpathError, UnusableInput
from teachpath.io import documents
from teachpath.io.bus import Bus, Handle
from teachpath.records import LearnedPath, ObjectPose, Scene, SceneQuery
from teachpath.records.poses import SAME_PLACE, SAME_TURN, unit_quaternion
from teachpath_proto.keys import Keys

log: logging.Logger = logging.getLogger(__name__)

MAX_COORDINATE: Final = 10.0  # m


class ObjectPoses:
    """Keeps the newest told pose of the object of every scene; a restart forgets them.

    While the arm moves, its object moves along, so the scenes stay as they were until it rests. A pose that differs by
    less than what a camera sees of an object at rest changes nothing: plans are certified for the pose.

    Args:
        saved: returns the scene of a name as it was saved; raises NotFound.
        moving: tells whether the arm is under way.
        on_change: called with the name of a scene whose object was told to lie elsewhere.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        saved: Callable[[str], Scene],
        moving: Callable[[], bool],
        on_change: Callable[[str], None] = lambda scene: None,
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._saved = saved
        self._moving = moving
        self._on_change = on_change
        self._lock = threading.Lock()
        self._reported: dict[str, ObjectPose] = {}  # newest
        self._current: dict[str, ObjectPose] = {}  # that scenes are given with
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Listen on the bus, and answer the executor what stands in a scene, from now on."""
        self._handles = [
            self._bus.subscribe(self._keys.all_objects, self._receive),
            self._bus.serve(self._keys.station_scene, self._answer),
        ]

    def stop(self) -> None:
        """Listen and answer no longer."""
        while self._handles:
            self._handles.pop().close()

    def scene(self, name: str) -> Scene:
        """Return a scene with its object where it was told to lie; raises NotFound."""
        saved, moving = self._saved(name), self._moving()
        with self._lock:
            reported, current = self._reported.get(name), self._current.get(name)
            if not moving and (reported is None or current is None or not _same(reported, current)):
                current = reported
                self._current.pop(name, None)
                if reported is not None:
                    self._current[name] = reported
        return saved.with_object(current) if current else saved

    def scene_for(self, name: str, path: LearnedPath) -> Scene:
        """Return the scene for a path: its object lies where an adapted path takes it; raises NotFound."""
        scene = self.scene(name)
        return scene.with_object(path.object_pose) if path.object_pose else scene

    def pose(self, name: str) -> ObjectPose:
        """Return where the object of a scene lies; raises NotFound: no such scene, or it has no object."""
        carried = self.scene(name).carried
        if carried is None:
            raise NotFound(f"scene {name} has no object; give it one: teachpath scene add (carried)")
        return ObjectPose(carried.position, carried.orientation)

    def reported(self, name: str) -> ObjectPose | None:
        """Return where the object of a scene was told to lie; None: where the scene has it. Raises NotFound."""
        carried = self.scene(name).carried
        with self._lock:
            return self._current.get(name) if carried else None

    def tell(self, name: str, pose: ObjectPose) -> ObjectPose:
        """Say where the object of a scene lies, and return where it lies as far as scenes are concerned.

        Raises:
            NotFound: no such scene, or it has no object.
            UnusableInput: what is told is no pose.
        """
        self.pose(name)
        checked = _checked(pose)
        with self._lock:
            self._reported[name] = checked
        return self._changed(name)

    def forget(self, name: str) -> ObjectPose:
        """Put the object of a scene back to where the scene has it; raises NotFound."""
        self.pose(name)
        with self._lock:
            self._reported.pop(name, None)
        return self._changed(name)

    def _changed(self, name: str) -> ObjectPose:
        before = self._current.get(name)
        now = self.pose(name)
        if self._current.get(name) is not before:
            self._on_change(name)
        return now

    def _answer(self, payload: bytes) -> bytes:
        return documents.encode(self.scene(documents.decode(SceneQuery, payload).name))

    def _receive(self, key: str, payload: bytes) -> None:
        try:
            self.tell(self._keys.scene_of(key), documents.decode(ObjectPose, payload))
        except TeachpathError as error:
            log.warning("a pose of an object on %s was not taken: %s", key, error)


def _checked(pose: ObjectPose) -> ObjectPose:
    """Return the pose with a unit quaternion; raises UnusableInput."""
    if not (len(pose.position) == 3 and all(abs(value) <= MAX_COORDINATE for value in pose.position)):
        raise UnusableInput(
            f"{list(pose.position)} is no position of an object; it has x, y and z, each within ±{MAX_COORDINATE:g} m"
        )
    px, py, pz = pose.position
    return ObjectPose((px, py, pz), unit_quaternion(pose.orientation))


def _same(one: ObjectPose, other: ObjectPose) -> bool:
    cosine = min(abs(float(np.dot(one.orientation, other.orientation))), 1.0)
    return math.dist(one.position, other.position) <= SAME_PLACE and 2 * math.acos(cosine) <= SAME_TURN
