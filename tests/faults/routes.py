"""The three ways on which samples become a demonstration: live, from a file, and repaired after a crash."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from teachpath.errors import UnusableInput
from teachpath.io.import_settings import ImportSettings
from teachpath.io.store.recordings import RecordingFile
from teachpath.io.store.salvage import RecordingHeader
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
    return run_all([stream], route)


def run_all(streams: Sequence[Stream], route: str) -> Outcome:
    """Record streams on a route, each by itself, in one station; the statistics are those of the last one."""
    with tempfile.TemporaryDirectory() as folder:
        store = Store(StoreSettings(data_dir=folder, database="sqlite://"))
        try:
            store.ensure_task("lift", scene=SCENE.name, calibration=CALIBRATION.name)
            return {"live": _live, "import": _imported, "repair": _repaired}[route](store, streams, Path(folder))
        finally:
            store.close()


def _live(store: Store, streams: Sequence[Stream], _folder: Path) -> Outcome:
    made: list[FinishedTake | None] = []
    statistics = None
    for stream in streams:
        session = RecordingSession(store, SETTINGS, RecordingSetup("lift", "glove", CALIBRATION, SCENE, RATE))
        for event in stream.events:
            if event.refused:
                session.counter.count_refused("refused", event.sample.sequence if event.readable else None)
            else:
                made.append(session.add(event.sample))
        session.counter.count_missing_until(stream.sent)
        made += session.finish()
        statistics = session.counter.statistics()
    learned = tuple(each[1] for each in made if each is not None)
    return Outcome(tuple(store.demonstrations("lift")), learned, statistics)


def _imported(store: Store, streams: Sequence[Stream], _folder: Path) -> Outcome:
    for number, stream in enumerate(streams):
        file = _written(store, stream, f"demo-file-{number}")
        content = file.finish({}).read_bytes()
        with suppress(UnusableInput):
            import_file(
                store,
                SETTINGS,
                Source("file", content, "mcap"),
                task="lift",
                scene=SCENE,
                calibration=CALIBRATION,
                limits=ImportSettings(),
            )
    return Outcome(tuple(store.demonstrations("lift")))


def _repaired(store: Store, streams: Sequence[Stream], folder: Path) -> Outcome:
    for number, stream in enumerate(streams):
        file = _written(store, stream, f"demo-torn-{number}")
        file.flush()
        file.leave()
    examine(store, SETTINGS, {SCENE.name: SCENE}, folder)
    return Outcome(tuple(store.demonstrations("lift")))


def _written(store: Store, stream: Stream, key: str) -> RecordingFile:
    """Return a file with what can be used of a stream."""
    file = store.recordings.begin(key, HEADER)
    for event in stream.events:
        if not event.refused:
            file.write(event.sample)
    return file
