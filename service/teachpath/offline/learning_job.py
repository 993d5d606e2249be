"""Learning jobs: the worker reads the recordings itself, so that the service does not."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from teachpath.io.store.recordings import RECORDINGS, Recordings
from teachpath.jobs import worker
from teachpath.learning.settings import LearningSettings
from teachpath.recording.demonstration import object_trajectory
from teachpath.recording.phases import TransportSpan
from teachpath.records import Demonstration, Learned, Trajectory, Vector


@dataclass(frozen=True)
class StoredDemonstrations:
    """Demonstrations of one task that are still to be read.

    Attributes:
        data_dir: folder of the station's data.
        rows: of the demonstrations.
        carried: start of the object's centre [m, world], or None.
    """

    data_dir: Path
    rows: tuple[Demonstration, ...]
    carried: Vector | None

    def read(self) -> dict[str, Trajectory]:
        """Return the object's trajectories by the ids of the demonstrations; raises UnusableRecording, NotFound."""
        recordings = Recordings(self.data_dir / RECORDINGS)
        return {
            row.id: object_trajectory(
                recordings.samples(row.recording, row.digest),
                TransportSpan(*row.transport),
                row.calibration,
                self.carried,
                left_out=row.left_out,
            )
            for row in self.rows
        }


def learn_stored(stored: StoredDemonstrations, settings: LearningSettings, *, progress: worker.Progress) -> Learned:
    """Read demonstrations and learn from them."""
    return worker.learn_paths(stored.read(), settings, progress=progress)


def recut_stored(
    learned: Learned,
    stored: StoredDemonstrations,
    threshold: float | None,
    clusters: int | None,
    *,
    progress: worker.Progress,
) -> Learned:
    """Read demonstrations and cut the dendrogram of a run over them elsewhere."""
    return worker.recut_run(learned, stored.read(), threshold, clusters, progress=progress)
