"""The calibrations of a station, from its settings and as measured; and demonstrations under another than today's."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.store.store import Store
from teachpath.recorder.annotations import Annotations
from teachpath.recorder.take_completion import reassess
from teachpath.recording.frame_fit import fit_frame
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, MeasuredCalibration, Scene, TaughtPoint
from teachpath_proto.keys import is_name, name_refusal

VERSION_SEPARATOR = "@"  # lab@2 is the second version of lab; no name has this character


@dataclass(frozen=True)
class Calibrations:
    """Gives, measures and compares calibrations.

    Attributes:
        fixed: those of the settings; they cannot be measured anew.
        scene: gives the scene of a name; raises NotFound.
    """

    store: Store
    settings: RecordingSettings
    configured: Sequence[Calibration]
    scene: Callable[[str], Scene]

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
            NotFound: there is none of that name; names the known ones.
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
        """List those of the settings, then the newest version of each measured one."""
        return [MeasuredCalibration(calibration) for calibration in self.configured] + self.store.calibrations.newest()

    def measure(
        self, name: str, points: Sequence[TaughtPoint], *, source: str = "", fit_scale: bool = False, keep: bool = True
    ) -> MeasuredCalibration:
        """Fit the calibration `name` to taught points and keep it as its next version.

        Args:
            name: of the calibration; every version of it is kept.
            points: see `fit_frame`.
            source: tracker that was shown the points.
            fit_scale: see `fit_frame`.
            keep: False: only say what it would be.

        Raises:
            UnusableInput: a bad name, or points that fix no frame.
            Conflict: a calibration of this name is in the settings.
        """
        if not is_name(name):
            raise UnusableInput(name_refusal("calibration", name))
        if any(calibration.name == name for calibration in self.configured):
            raise Conflict(f"the calibration {name} is in the settings; choose another name, or take it out there")
        fitted = fit_frame(name, points, largest_residual=self.settings.largest_residual, fit_scale=fit_scale)
        measured = replace(fitted, source=source)
        return self.store.calibrations.add(measured) if keep else measured

    def require_current(self, demonstrations: Sequence[Demonstration], *, command: str = "learn") -> None:
        """Refuse demonstrations whose calibration has been measured or set anew since they were recorded.

        Each is in the world by its own calibration, so those of different names agree. Whether an older mapping of
        one name is still true of an old demonstration (the tracker was moved since) or never was (the new one
        corrects it), only the operator knows.

        Args:
            demonstrations: of one task.
            command: that they are refused to.

        Raises:
            Conflict: names them and both ways out.
        """
        outdated = [d for d in demonstrations if self._present(d.calibration) != d.calibration]
        if outdated:
            numbers, first = ", ".join(str(d.number) for d in outdated), outdated[0]
            raise Conflict(
                f"demonstrations {numbers} were recorded under another version of the calibration "
                f"{first.calibration.name}; if it was wrong then, convert them and learn anew: teachpath recalibrate "
                f"{first.task}; if the tracker was moved since, take them as they were recorded: teachpath {command} "
                f"--as-recorded {first.task}"
            )

    def convert(self, demonstrations: Sequence[Demonstration], name: str = "") -> list[Demonstration]:
        """Put demonstrations under their calibration as it is today, or under `name`, and judge them again.

        The samples stay in the tracker's frame and the phases where they were cut, so it can be undone by converting
        them back. Either all are changed or none.

        Raises:
            NotFound: no such calibration, or a recording is missing.
        """
        changes = {d.id: self._converted(d, self.get(name or d.calibration.name)) for d in demonstrations}
        return [self.store.change_demonstration(key, **changed) for key, changed in changes.items()]

    def _converted(self, demonstration: Demonstration, calibration: Calibration) -> dict[str, Any]:
        if calibration == demonstration.calibration:
            return {}
        samples = self.store.recordings.samples(demonstration.recording)
        changed = replace(demonstration, calibration=calibration)
        changes = reassess(demonstration, changed, samples, self.settings)
        moved = replace(changed, **changes)
        times = Annotations(self.store, self.settings, self.scene).trajectory(moved).times
        return {"calibration": calibration, **changes, "duration": float(times[-1])}

    def _present(self, calibration: Calibration) -> Calibration:
        try:
            return self.get(calibration.name)
        except NotFound:  # of another station: nothing here contradicts it
            return calibration
