"""The calibrations of a station, from its settings and as measured, and demonstrations with outdated ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.store import Store
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.recording_work import Call, call_directly
from teachpath.recording.frame_fit import fit_frame
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, MeasuredCalibration, Scene, TaughtPoint
from teachpath_proto.keys import is_name, name_refusal

VERSION_SEPARATOR = "@"  # lab@2 is the second version of lab; no name has this character


@dataclass(frozen=True)
class Calibrations:
    """Finds, measures and compares calibrations.

    Attributes:
        configured: the calibrations of the settings, which cannot be measured.
        scene: returns the scene of a name; raises NotFound.
        call: calls what reads a whole recording.
    """

    store: Store
    settings: RecordingSettings
    configured: Sequence[Calibration]
    scene: Callable[[str], Scene]
    call: Call = call_directly

    def __post_init__(self) -> None:
        for calibration in self.configured:
            if self.store.calibrations.versions(calibration.name):
                raise Conflict(
                    f"the calibration {calibration.name} was measured here and is in the settings too; rename it in "
                    "the settings, or take it out there"
                )

    def get(self, name: str) -> Calibration:
        """Return the calibration `name` in its newest version, or one version of it (`lab@2`).

        Raises:
            NotFound: there is none of that name; the message lists the known ones.
        """
        for calibration in self.configured:
            if calibration.name == name:
                return calibration
        base, mark, version = name.partition(VERSION_SEPARATOR)
        if mark:
            if not version.isdecimal():
                raise NotFound(f"{name!r} names no version of a calibration; write e.g. {base}{VERSION_SEPARATOR}1")
            return self.store.calibrations.version(base, int(version)).calibration
        versions = self.store.calibrations.versions(name)
        if not versions:
            newest = ", ".join(measured.calibration.name for measured in self.newest())
            raise NotFound(f"there is no calibration {name!r}; known: {newest}")
        return versions[0].calibration

    def newest(self) -> list[MeasuredCalibration]:
        """List the calibrations of the settings, then the newest version of each measured one."""
        return [MeasuredCalibration(calibration) for calibration in self.configured] + self.store.calibrations.newest()

    def measure(
        self,
        name: str,
        points: Sequence[TaughtPoint],
        *,
        source: str = "",
        fit_scale: bool = False,
        keep: bool = True,
        author: str = "",
    ) -> MeasuredCalibration:
        """Fit the calibration `name` to taught points and keep it as its next version.

        Args:
            name: of the calibration; every version of it is kept.
            points: see `fit_frame`.
            source: tracker that measured the points.
            fit_scale: see `fit_frame`.
            keep: store the calibration; if False, it is only returned.
            author: who measures it.

        Raises:
            UnusableInput: a bad name, or points that fix no frame.
            Conflict: a calibration of this name is in the settings.
        """
        if not is_name(name):
            raise UnusableInput(name_refusal("calibration", name))
        if any(calibration.name == name for calibration in self.configured):
            raise Conflict(f"the calibration {name} is in the settings; choose another name, or take it out there")
        fitted = fit_frame(name, points, largest_residual=self.settings.largest_residual, fit_scale=fit_scale)
        measured = replace(fitted, source=source, author=author)
        return self.store.calibrations.add(measured) if keep else measured

    def require_current(self, demonstrations: Sequence[Demonstration], *, command: str = "learn") -> None:
        """Refuse demonstrations whose calibration has been measured or set anew since they were recorded.

        Demonstrations under calibrations of different names are all in world coordinates and agree. An older version
        of one name may still be right for an old demonstration, because the tracker was moved since, or it was wrong
        from the beginning and the new version corrects it; only the operator knows.

        Args:
            demonstrations: of one task.
            command: which needs them; for the message.

        Raises:
            Conflict: the message names the demonstrations and both ways out.
        """
        outdated = [d for d in demonstrations if self._current_version(d.calibration) != d.calibration]
        if outdated:
            numbers, first = ", ".join(str(d.number) for d in outdated), outdated[0]
            raise Conflict(
                f"demonstrations {numbers} were recorded under another version of the calibration "
                f"{first.calibration.name}; if it was wrong then, convert them and learn anew: teachpath recalibrate "
                f"{first.task}; if the tracker was moved since, take them as they were recorded: teachpath {command} "
                f"--as-recorded {first.task}"
            )

    def convert(self, demonstrations: Sequence[Demonstration], name: str = "") -> list[Demonstration]:
        """Change the calibration of demonstrations to its present version, or to `name`, and assess them again.

        The samples stay in the tracker's frame and the phases where they were cut, so that a second conversion can
        undo the first. Either all are changed or none.

        Raises:
            NotFound: no such calibration, or a recording is missing.
        """
        changes = {d.id: self._conversion_changes(d, self.get(name or d.calibration.name)) for d in demonstrations}
        return [self.store.change_demonstration(key, **changed) for key, changed in changes.items()]

    def numbered(self, calibration: Calibration) -> Calibration:
        """Return a calibration under the name of its version (lab@2), if it was measured here; else itself."""
        for measured in self.store.calibrations.versions(calibration.name):
            if measured.calibration == calibration:
                return replace(calibration, name=f"{calibration.name}{VERSION_SEPARATOR}{measured.version}")
        return calibration

    def newest_numbered(self, calibration: Calibration) -> Calibration:
        """Return the newest version of a calibration that `numbered` returned, likewise."""
        name = calibration.name.partition(VERSION_SEPARATOR)[0]
        return self.numbered(self._current_version(replace(calibration, name=name)))

    def _current_version(self, calibration: Calibration) -> Calibration:
        try:
            return self.get(calibration.name)
        except NotFound:  # of another station: nothing here contradicts it
            return calibration

    def _conversion_changes(self, demonstration: Demonstration, calibration: Calibration) -> dict[str, Any]:
        if calibration == demonstration.calibration:
            return {}
        annotations = Annotations(self.store, self.settings, self.scene, call=self.call)
        changed = replace(demonstration, calibration=calibration)
        return {"calibration": calibration, **annotations.reassessed(demonstration, changed)}
