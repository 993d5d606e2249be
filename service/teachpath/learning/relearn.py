"""Another cut of a run: its dendrogram and settings stay, selection and fitting are repeated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from teachpath.errors import LearningFailed
from teachpath.learning.adaptation.common_ends import common_ends
from teachpath.learning.clustering.cuts import recut_partition
from teachpath.learning.clustering.ends import end_groups
from teachpath.learning.clustering.incomplete import find_incomplete
from teachpath.learning.clustering.partition import Partition
from teachpath.learning.learn import comparable_paths, learn_partition, metric_of
from teachpath.learning.settings import LearningSettings, Progress, no_progress, settings_of_run
from teachpath.learning.summary import fingerprint
from teachpath.lengths import describe_length
from teachpath.records import Learned, Trajectory


def relearn(
    learned: Learned,
    demonstrations: Mapping[str, Trajectory],
    *,
    threshold: float | None = None,
    clusters: int | None = None,
    progress: Progress = no_progress,
) -> Learned:
    """Cut the dendrogram of a run elsewhere, then select and fit with the settings of the run.

    The settings of the result hold the new cut, so learning with them from the beginning gives the same result.

    Args:
        learned: the run.
        demonstrations: id -> trajectory; the run was learned from them.
        threshold: height of the cut [m], or
        clusters: number of clusters.
        progress: as in `learn`.

    Raises:
        UnusableSettings: see `cuts.recut_partition`.
        LearningFailed: a demonstration is missing or has changed since, or as in `learn`.
    """
    grouping = recut_partition(learned, threshold, clusters)
    _check_unchanged(learned, demonstrations)
    progress(0.0, f"cutting the dendrogram at {describe_length(grouping.threshold, digits=3)}")
    settings = _with_cut(settings_of_run(learned.settings), grouping, clusters)
    listed = {name: demonstrations[name] for name in learned.demonstrations}
    metric = metric_of(settings)
    courses, length = comparable_paths(listed, metric, settings.seed)
    ends = common_ends(courses, settings, length)
    if metric != "undersampled" and ends is None:
        groups = end_groups(courses, min_separation=settings.min_separation, length=length)
        grouping = replace(grouping, incomplete=find_incomplete(courses, groups, length))
    return learn_partition(listed, courses, grouping, ends, settings, progress)


def _with_cut(settings: LearningSettings, grouping: Partition, clusters: int | None) -> LearningSettings:
    if clusters is not None and settings.mode == "default":
        return replace(settings, threshold=None, clusters=clusters)
    return replace(settings, threshold=grouping.threshold, clusters=None)


def _check_unchanged(learned: Learned, demonstrations: Mapping[str, Trajectory]) -> None:
    for name in learned.demonstrations:
        known = learned.inputs.get(name)
        if name not in demonstrations or (known and known != fingerprint(demonstrations[name])):
            told = "has changed" if name in demonstrations else "is no longer learned from"
            raise LearningFailed(
                f"demonstration {name} {told} since that run: its dendrogram is out of date, learn anew", name
            )
