"""A service that only learns: on another machine or beside the station, for a station whose database it shares."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

from teachpath.config import Settings
from teachpath.errors import NotFound, UnusableSettings
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.services import WORKER
from teachpath.io.store.store import Store
from teachpath.job_kinds import LearningKinds
from teachpath.jobs.jobs import Jobs
from teachpath.jobs.limited_process import LimitedProcess
from teachpath.recorder.calibrations import Calibrations
from teachpath.robot.scenes import Scenes
from teachpath_proto.keys import Keys


class JobService:
    """Does the learning jobs of a station that nobody else does; use it as a context manager.

    It needs the station's settings, its database, and its recordings: in object storage, or in its data folder.

    Raises:
        UnusableSettings: the database is not one that services share, or the recordings are neither in the data folder
            nor in object storage.
    """

    def __init__(self, settings: Settings) -> None:
        self._store = Store(settings.store)
        try:
            self._require_use(Path(settings.store.data_dir))
        except BaseException:
            self._store.close()
            raise
        self._reader = LimitedProcess(settings.jobs)
        scenes = Scenes(self._store.scenes, settings.scenes)
        calibrations = Calibrations(
            self._store, settings.recording, settings.calibrations, scenes.get, self._reader.call
        )
        kinds = LearningKinds(self._store, settings, calibrations, scenes, is_away=True).by_name()
        self._jobs = Jobs(MemoryBus(), Keys(settings.bus.prefix), self._store, settings.jobs, kinds)

    def __enter__(self) -> JobService:
        self._store.services.begin(WORKER)
        self._jobs.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._jobs.stop()
        self._reader.stop()
        self._store.close()

    def _require_use(self, folder: Path) -> None:
        if not self._store.services.is_shared:
            raise UnusableSettings(
                "a worker needs a database that several services share: name one on PostgreSQL in the setting "
                "store.database; with SQLite the service itself does all jobs"
            )
        if self._store.recordings.objects.url:
            return  # what is not there yet, jobs wait for
        for place in sorted(self._store.checks.places())[:1]:
            try:
                self._store.recordings.path(place)
            except NotFound:
                raise UnusableSettings(
                    f"recording {place} of station {self._store.services.station!r} is not under {folder}; name the "
                    "station's data folder with --data, and the station in the setting store.station; or keep "
                    "recordings in object storage (store.recordings)"
                ) from None
