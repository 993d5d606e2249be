"""Learning jobs: recordings are read in a process of the jobs, not in the service."""

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


@dataclass(frozen=True)
class ReadDemonstrations:
    """Demonstrations that were read: the object's trajectories by their ids, and where the scene has the object."""

    trajectories: dict[str, Trajectory]
    object_pose: ObjectPose | None


def read_to_learn(
    stored: StoredDemonstrations, settings: LearningSettings
) -> tuple[ReadDemonstrations, LearningSettings]:
    """Read what `learn_read` takes."""
    return ReadDemonstrations(stored.read(), stored.object_pose), settings


def learn_read(shown: ReadDemonstrations, settings: LearningSettings, *, progress: worker.Progress) -> Learned:
    """Learn from demonstrations that were read."""
    return _placed(worker.learn_paths(shown.trajectories, settings, progress=progress), shown.object_pose)


def read_to_recut(
    learned: Learned, stored: StoredDemonstrations, threshold: float | None, clusters: int | None
) -> tuple[Learned, ReadDemonstrations, float | None, int | None]:
    """Read what `recut_read` takes."""
    return learned, ReadDemonstrations(stored.read(), stored.object_pose), threshold, clusters


def recut_read(
    learned: Learned,
    shown: ReadDemonstrations,
    threshold: float | None,
    clusters: int | None,
    *,
    progress: worker.Progress,
) -> Learned:
    """Cut the dendrogram of a run over demonstrations that were read elsewhere."""
    found = worker.recut_run(learned, shown.trajectories, threshold, clusters, progress=progress)
    return _placed(found, shown.object_pose)


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
