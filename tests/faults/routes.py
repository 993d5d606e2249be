"""The three ways on which samples become a demonstration: live, from a file, and repaired after a crash."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from teachpath.errors import UnusableInput
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.recordings import RecordingHeader
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.doctor import examine
from teachpath.offline.file_samples import Source
from teachpath.offline.importing import import_file
from teachpath.recorder.recording_setup import RecordingSetup
from teachpath.recorder.session import RecordingSession
from teachpath.recorder.take import FinishedTake
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Demonstration, Scene, Shape, StreamStatistics, Trajectory
from tests.faults.streams import OBJECT, RATE, Stream

SETTINGS = RecordingSettings()
SCENE = Scene("paper", (), Shape("block", "box", (0.04, 0.04, 0.04), OBJECT))
CALIBRATION = Calibration("identity")
HEADER = RecordingHeader("lift", "glove", CALIBRATION)
ROUTES = ("live", "import", "repair")


@dataclass(frozen=True)
class Outcome:
    """What became of a stream.

    Attributes:
        rows: the demonstrations made.
        learned: the trajectory of each, as it was made live.
        statistics: of the whole recording; None on the routes that keep none.
    """

    rows: tuple[Demonstration, ...]
    learned: tuple[Trajectory, ...] = ()
    statistics: StreamStatistics | None = None

    @property
    def verdict(self) -> str:
        """The best verdict, or `none`: no demonstration was made."""
        found = {str(row.verdict) for row in self.rows}
        return next((word for word in ("clean", "repaired", "reject") if word in found), "none")


def run(stream: Stream, route: str) -> Outcome:
    """Record a stream on a route."""
    with tempfile.TemporaryDirectory() as folder:
        store = Store(StoreSettings(data_dir=folder, database="sqlite://"))
        try:
            store.ensure_task("lift", scene=SCENE.name, calibration=CALIBRATION.name)
            return {"live": _live, "import": _imported, "repair": _repaired}[route](store, stream, Path(folder))
        finally:
            store.close()


def _live(store: Store, stream: Stream, _folder: Path) -> Outcome:
    session = RecordingSession(store, SETTINGS, RecordingSetup("lift", "glove", CALIBRATION, SCENE, RATE))
    made: list[FinishedTake | None] = []
    for event in stream.events:
        if event.refused:
            session.counter.count_refused("refused", event.sample.sequence if event.readable else None)
        else:
            made.append(session.add(event.sample))
    session.counter.count_missing_until(stream.sent)
    made += session.finish()
    learned = tuple(each[1] for each in made if each is not None)
    return Outcome(tuple(store.demonstrations("lift")), learned, session.counter.statistics())


def _imported(store: Store, stream: Stream, _folder: Path) -> Outcome:
    file = store.recordings.begin("demo-file", HEADER)
    for event in stream.events:
        if not event.refused:
            file.write(event.sample)
    content = file.finish({}).read_bytes()
    try:
        import_file(
            store,
            SETTINGS,
            Source("file", content, "mcap"),
            task="lift",
            scene=SCENE,
            calibration=CALIBRATION,
            limits=ImportSettings(),
        )
    except UnusableInput:
        return Outcome(())
    return Outcome(tuple(store.demonstrations("lift")))


def _repaired(store: Store, stream: Stream, folder: Path) -> Outcome:
    file = store.recordings.begin("demo-torn", HEADER)
    for event in stream.events:
        if not event.refused:
            file.write(event.sample)
    file.flush()
    file.leave()
    examine(store, SETTINGS, {SCENE.name: SCENE}, folder)
    return Outcome(tuple(store.demonstrations("lift")))
