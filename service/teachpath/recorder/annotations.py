"""The operator's edits of stored demonstrations: discard, restore, mark, trim. Nothing is ever deleted."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final

from teachpath.errors import NotFound, UnusableInput
from teachpath.io.store.store import Store
from teachpath.recorder.recording_work import Call, call_directly, read_trajectory, reassess_recording
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Amendment, Demonstration, Scene, Trajectory, Vector

MARKS: Final = ("", "good", "bad")


@dataclass(frozen=True)
class Annotations:
    """Changes stored demonstrations as the operator wants.

    Attributes:
        scene: returns the scene of a name; raises NotFound.
        on_change: called with every demonstration that has changed.
        call: calls what reads a whole recording.
        wait_for_takes: waits until the takes that have ended are stored, of which one may be meant.
    """

    store: Store
    settings: RecordingSettings
    scene: Callable[[str], Scene]
    on_change: Callable[[Demonstration], None] = field(default=lambda demonstration: None)
    call: Call = call_directly
    wait_for_takes: Callable[[], None] = lambda: None

    def trajectory(self, demonstration: Demonstration) -> Trajectory:
        """Return the object's trajectory of a stored demonstration, from its recording."""
        trajectory: Trajectory = self.call(
            read_trajectory, self.store.recordings, demonstration, self.carried(demonstration)
        )
        return trajectory

    def carried(self, demonstration: Demonstration) -> Vector | None:
        """Return the start of the object's centre [m, world] in a demonstration, or None."""
        if demonstration.object_pose is not None:
            return demonstration.object_pose.position
        carried = self.scene(self.store.task(demonstration.task).scene).carried
        return carried.position if carried else None

    def discard_last(self, task: str, *, who: str = "") -> Demonstration:
        """Discard the newest demonstration of a task that is kept; raises NotFound when this station has none."""
        kept = [d for d in self._own(task) if not d.discarded_ns]
        if not kept:
            raise NotFound(f"task {task} has no demonstration that could be discarded{self._station_hint}")
        return self.amend(kept[-1].id, Amendment(discarded=True), who=who)

    def restore_last(self, task: str, *, who: str = "") -> Demonstration:
        """Bring back the demonstration of a task discarded last; raises NotFound when this station has none."""
        discarded = [d for d in self._own(task) if d.discarded_ns]
        if not discarded:
            raise NotFound(f"task {task} has no discarded demonstration{self._station_hint}")
        return self.amend(max(discarded, key=lambda d: d.discarded_ns).id, Amendment(discarded=False), who=who)

    def _own(self, task: str) -> list[Demonstration]:
        """Return what this station made of a task, or none by name: whoever says "the last" sees no other station's."""
        self.wait_for_takes()
        demonstrations = self.store.demonstrations(self.store.task(task).name)
        station = self.store.services.station
        return [d for d in demonstrations if not station or d.station in ("", station)]

    @property
    def _station_hint(self) -> str:
        station = self.store.services.station
        return f" of station {station!r}; another station's is discarded or brought back by its id" if station else ""

    def amend(self, key: str, amendment: Amendment, *, who: str = "") -> Demonstration:
        """Change a demonstration and return it; after a trim its quality is assessed again. `who` changes it.

        Raises:
            NotFound: no such demonstration.
            UnusableInput: an unknown mark, or a trim outside the recording or too short.
        """
        stored = self.store.demonstration(key)
        changes: dict[str, Any] = {"amended_by": who}
        if amendment.mark is not None:
            if amendment.mark not in MARKS:
                raise UnusableInput(f"{amendment.mark!r} is no mark: say good, bad, or nothing")
            changes["mark"] = amendment.mark
        if amendment.discarded is not None:
            changes["discarded_ns"] = time.time_ns() if amendment.discarded else 0
        if amendment.trim is not None:
            changes |= self._trim_changes(stored, amendment.trim)
        changed = self.store.change_demonstration(key, **changes)
        self.on_change(changed)
        return changed

    def _trim_changes(self, stored: Demonstration, trim: tuple[int, int]) -> dict[str, Any]:
        begin, end = trim
        chosen = None if begin == end else trim
        least = self.settings.shortest_transport
        if chosen and not (begin >= 0 and end <= stored.samples and end - begin >= least):
            raise UnusableInput(
                f"{begin} to {end} is no transport phase of a recording with {stored.samples} samples: it needs at "
                f"least {least} of them"
            )
        return {"trim": chosen, **self.reassessed(stored, replace(stored, trim=chosen))}

    def reassessed(self, before: Demonstration, after: Demonstration) -> dict[str, Any]:
        """Return what else changes in the row of a demonstration whose calibration or trim changes."""
        changes: dict[str, Any] = self.call(
            reassess_recording,
            self.store.recordings,
            self.settings,
            before,
            after,
            self.carried(before),
            self.store.task(before.task).object_at_grasp,
        )
        return changes
