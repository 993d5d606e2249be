"""Learning jobs: the worker reads the recordings itself, so that the service does not."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from teachpath.io.store.recordings import Recordings
from teachpath.jobs import worker
from teachpath.learning.settings import LearningSettings
from teachpath.recording.demonstration import object_trajectory
from teachpath.recording.phases import TransportSpan
from teachpath.records import Demonstration, Learned, ObjectPose, Trajectory

SAME_PLACE = 0.001  # m, within which a path begins where the scene has the object


@dataclass(frozen=True)
class StoredDemonstrations:
    """Demonstrations of one task that are still to be read.

    Attributes:
        recordings: of the station.
        rows: of the demonstrations.
        object_pose: where the scene has the object, or None.
    """

    recordings: Recordings
    rows: tuple[Demonstration, ...]
    object_pose: ObjectPose | None

    def read(self) -> dict[str, Trajectory]:
        """Return the object's trajectories by the ids of the demonstrations.

        Raises:
            NotFound: a recording is missing.
            UnusableRecording: one is not what was recorded.
            StorageUnavailable: the object storage does not answer.
        """
        return {
            row.id: object_trajectory(
                self.recordings.columns(row.recording, row.digest),
                TransportSpan(*row.transport),
                row.calibration,
                pose.position if (pose := row.object_pose or self.object_pose) else None,
                left_out=row.left_out,
            )
            for row in self.rows
        }


def learn_stored(stored: StoredDemonstrations, settings: LearningSettings, *, progress: worker.Progress) -> Learned:
    """Read demonstrations and learn from them."""
    return _placed(worker.learn_paths(stored.read(), settings, progress=progress), stored.object_pose)


def recut_stored(
    learned: Learned,
    stored: StoredDemonstrations,
    threshold: float | None,
    clusters: int | None,
    *,
    progress: worker.Progress,
) -> Learned:
    """Read demonstrations and cut the dendrogram of a run over them elsewhere."""
    found = worker.recut_run(learned, stored.read(), threshold, clusters, progress=progress)
    return _placed(found, stored.object_pose)


def _placed(learned: Learned, scene_pose: ObjectPose | None) -> Learned:
    """Let the paths that begin elsewhere than where the scene has the object say where they take it."""
    if scene_pose is None:
        return learned
    starts = [path.curve(0.0) for path in learned.paths]
    poses = [
        None
        if math.dist(start, scene_pose.position) <= SAME_PLACE
        else replace(scene_pose, position=tuple(start.tolist()))
        for start in starts
    ]
    paths = zip(learned.paths, poses, strict=True)
    return replace(learned, paths=tuple(replace(path, object_pose=pose) for path, pose in paths))
