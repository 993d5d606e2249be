"""A task that is shown between changing starts or goals: its demonstrations are compared between common ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.distance import pdist, squareform

from teachpath.learning.adaptation.kriged_shapes import KrigedShapes
from teachpath.learning.adaptation.same_way import USUAL_SHAPE_SCATTER
from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.ends import end_groups
from teachpath.learning.clustering.partition import Partition, cut_as_set, separated_clusters, separations
from teachpath.learning.resampling import arc_lengths, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory

MIN_PLACES = 3  # different pairs of start and goal: two are two ways
MAX_DEMONSTRATIONS_PER_PLACE = 2  # less than so many, in the mean: what is shown again and again is a place of its own
MIN_PLACES_PER_WAY = 2  # in the mean, at which the shapes are those of one task
MAX_DEMONSTRATIONS = 2000  # of more, nobody has moved the object each time


@dataclass(frozen=True, eq=False)
class CommonEnds:
    """The start and the goal to which demonstrations are brought, as one of them has them.

    A demonstration keeps its shape, what it has beside the straight line from its start to its goal, in the frame from
    start to goal: turned about the vertical and in units of a power of the distance (see `kriged_shapes.py`).

    Attributes:
        shapes: of all demonstrations.
        central: number of the demonstration whose ends are the common ones.
        courses: (m, n, 3) [m] all of them between the common ends, at equal arc lengths.
        note: that the task has a moving start or goal, in words.
    """

    shapes: KrigedShapes
    central: int
    courses: Array
    note: str

    def brought(self, demonstrations: Mapping[str, Trajectory]) -> dict[str, Trajectory]:
        """Bring demonstrations, all of them in their order, to the common ends; orientations stay as they are."""
        return {
            name: replace(trajectory, positions=self._brought(number, trajectory))
            for number, (name, trajectory) in enumerate(demonstrations.items())
        }

    def partition(self, settings: LearningSettings, metric: str) -> Partition:
        """Cluster the demonstrations by the ways that they take between the common ends."""
        tree = average_linkage(pairwise_distances(self.courses, metric), len(self.courses))
        return cut_as_set(tree, settings, length=_typical_length(self.courses), usual_scatter=USUAL_SHAPE_SCATTER)

    def _brought(self, number: int, trajectory: Trajectory) -> Array:
        s = arc_lengths(smoothed(trajectory))
        return self.shapes.moved(number, trajectory.positions, s / s[-1], self.central)


def common_ends(courses: Array, settings: LearningSettings, length: float) -> CommonEnds | None:
    """Return the common ends of a task with a moving start or goal; None of any other task.

    The start or the goal moves when there are three or more places, most of them shown once, and the shapes between
    common ends belong to fewer ways than there are places: then the ends scatter more than the shapes do.

    Args:
        courses: (m, n, 3) [m] at equal arc lengths.
        settings: see `LearningSettings`.
        length: of a typical path [m].
    """
    m = len(courses)
    comparable = settings.mode == "default" and settings.metric != "undersampled"
    if not (comparable and MIN_PLACES <= m <= MAX_DEMONSTRATIONS):
        return None
    places = _count(courses, settings, length)
    if places < MIN_PLACES or m >= MAX_DEMONSTRATIONS_PER_PLACE * places:
        return None
    apart = squareform(pdist(courses[:, 0])) + squareform(pdist(courses[:, -1]))
    central = int(np.argmin(apart.sum(axis=1)))
    shapes, share = KrigedShapes(courses), np.linspace(0.0, 1.0, courses.shape[1])
    brought = np.array([shapes.moved(number, course, share, central) for number, course in enumerate(courses)])
    if _ways(brought, settings).max() * MIN_PLACES_PER_WAY > places:
        return None
    return CommonEnds(shapes, central, brought, _note(courses, settings, length))


def _count(courses: Array, settings: LearningSettings, length: float) -> int:
    return int(end_groups(courses, min_separation=settings.min_separation, length=length).max())


def _ways(brought: Array, settings: LearningSettings) -> Labels:
    tree = average_linkage(pairwise_distances(brought, "arc"), len(brought))
    ratios = separations(tree, _typical_length(brought), USUAL_SHAPE_SCATTER) / settings.min_separation
    return labels_for_count(tree, separated_clusters(ratios))


def _typical_length(courses: Array) -> float:
    return float(np.median([arc_lengths(course)[-1] for course in courses]))


def _note(courses: Array, settings: LearningSettings, length: float) -> str:
    moving = [
        (name, float(pdist(courses[:, end]).max()))
        for name, end in (("start", 0), ("goal", -1))
        if _count(courses[:, [end, end]], settings, length) > 1
    ]
    ends = " and ".join(name for name, _ in moving)
    extents = " and ".join(f"{name}s up to {extent * 100:.0f} cm" for name, extent in moving)
    return (
        f"a task with a moving {ends}: {extents} apart. Each way is learned in a frame from start to goal and leads "
        "between ends that were shown; adapt it to take it anywhere else"
    )
