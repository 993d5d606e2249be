"""What the doctor works on: rows, files, and the report of what was found and mended."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from teachpath.errors import TeachpathError
from teachpath.io.store.store import Store
from teachpath.offline.findings import FaultKind, Finding
from teachpath.offline.recording_checks import Inspection, inspect
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Scene


@dataclass(frozen=True, slots=True)
class Repair:
    """What the doctor did: a piece of a sentence, and the ids of the demonstrations it made."""

    sentence: str
    demonstrations: tuple[str, ...] = ()


@dataclass
class Examination:
    """One examination of a data folder.

    Attributes:
        store: rows and recordings.
        settings: by which torn recordings are cut and judged.
        scenes: of the settings, by their names.
        data_dir: folder of the station's data.
        mend: whether to mend; if False, only to say what would be mended.
        default_scene: of tasks that no row and no file says the scene of.
        rows: demonstrations by their ids.
        files: finished recordings that can be read, by their places.
        spare: those of them that no row names.
        distant: ids of the rows whose recordings are in object storage, not among the files.
        findings: what was found so far.
    """

    store: Store
    settings: RecordingSettings
    scenes: dict[str, Scene]
    data_dir: Path
    mend: bool = True
    default_scene: str = ""
    rows: dict[str, Demonstration] = field(default_factory=dict)
    files: dict[str, Inspection] = field(default_factory=dict)
    unreadable: set[str] = field(default_factory=set)
    spare: dict[str, Inspection] = field(default_factory=dict)
    distant: set[str] = field(default_factory=set)
    findings: list[Finding] = field(default_factory=list)

    def read(self) -> None:
        """Read all rows and all finished recordings."""
        for key, row in self.store.checks.demonstrations():
            if isinstance(row, Demonstration):
                self.rows[key] = row
            else:
                self.report(FaultKind.UNREADABLE, key, f"its row says nothing that can be used ({row})", advice=RESTORE)
        for file in self.store.recordings.finished():
            if (inspection := self.inspect(file)) is not None:
                self.files[self.store.recordings.place(file)] = inspection
        named = {row.recording for row in self.rows.values()}
        self.spare = {place: inspection for place, inspection in self.files.items() if place not in named}

    def inspect(self, file: Path) -> Inspection | None:
        """Read one recording; one that may not be read is reported."""
        place = self.store.recordings.place(file)
        try:
            return inspect(file)
        except OSError as error:
            self.unreadable.add(place)
            advice = "let this user read it, then run the doctor again"
            self.report(FaultKind.UNREADABLE, place, f"it cannot be read ({error.strerror})", advice=advice)
            return None

    def report(
        self,
        kind: FaultKind,
        file: str,
        fault: str,
        repair: Callable[[], Repair] | None = None,
        *,
        advice: str = "",
        inspection: Inspection | None = None,
        settled: bool = False,
    ) -> bool:
        """Report a fault, and mend it first where that is possible; return whether it is mended.

        Args:
            kind: what is the matter.
            file: or row, within the data folder.
            fault: what was found.
            repair: mends it; None: the doctor cannot.
            advice: what to do where it cannot.
            inspection: of the file, if it can be read.
            settled: whether nothing is to be done.
        """
        done, mended = Repair(""), settled
        if repair is None:
            outcome = advice
        elif not self.mend:
            outcome = "the doctor mends it"
        else:
            try:
                done = repair()
                outcome, mended = done.sentence, True
            except (TeachpathError, OSError) as error:
                outcome = f"it could not be mended: {error}"
        facts = (len(inspection.samples), inspection.seconds) if inspection else (0, 0.0)
        sentence = f"{file}: {fault}; {outcome}"
        self.findings.append(Finding(kind, file, sentence, mended, repair is not None, done.demonstrations, *facts))
        return mended


RESTORE = "bring it back from a backup: teachpath restore"
