"""Learning from demonstrations: cluster, select, fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from importlib.metadata import version

import numpy as np

from teachpath.learning.adaptation.common_ends import CommonEnds, common_ends
from teachpath.learning.adaptation.same_way import moving_ends
from teachpath.learning.clustering.dendrogram import Labels, members_by_label
from teachpath.learning.clustering.incomplete import Stop, describe
from teachpath.learning.clustering.partition import Partition
from teachpath.learning.clustering.subsampled_clustering import cluster_paths
from teachpath.learning.fitting.synthesis import fit_mean_path, fit_pooled_points
from teachpath.learning.input_validation import set_aside_motionless, validate
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed, undersampled
from teachpath.learning.selection.default_mode import select, step_count
from teachpath.learning.selection.paper_mode import paper_step_count, select_as_paper
from teachpath.learning.settings import LearningSettings, Progress, StepCallback, StepCounter, Subprogress, no_progress
from teachpath.learning.summary import ambiguities, copies, fingerprint, representatives, tube_radius
from teachpath.records import Array, Cluster, Deviation, Learned, LearnedPath, Score, Trajectory

PATH_POINTS = 100  # at equal arc length, for the distance of two paths
SELECTION_MESSAGE = "looking for inconsistent demonstrations"
# Read once, because each reads a file.
LIBRARY_VERSIONS = tuple((name, version(name)) for name in ("teachpath", "numpy", "scipy", "hmmlearn", "numba"))


def learn(
    demonstrations: Mapping[str, Trajectory], settings: LearningSettings, *, progress: Progress = no_progress
) -> Learned:
    """Learn one path for every cluster of demonstrations.

    The same demonstrations, settings and library versions give the same result to the last bit. Clusters are
    numbered from 1 in the order of their first members; paths come in the order of the clusters, without id and run.
    In mode default a demonstration that does not move is left out with a note: it must not hold up the others.

    Args:
        demonstrations: id -> trajectory, in listed order.
        settings: see `LearningSettings`.
        progress: receives the fraction done and a sentence; what it raises passes through.

    Raises:
        LearningFailed: a demonstration cannot be used, or a path cannot keep the error bound.
    """
    moving, told = set_aside_motionless(demonstrations) if settings.mode == "default" else (demonstrations, [])
    validate(moving)
    progress(0.0, f"comparing {len(moving)} demonstrations")
    metric = metric_of(settings)
    courses, length = comparable_paths(moving, metric, settings.seed, Subprogress(progress, 0.0, 0.05))
    ends = common_ends(courses, settings, length)
    if ends is None:
        comparing = Subprogress(progress, 0.05, 0.2)
        grouping = cluster_paths(courses, settings, length=length, metric=metric, progress=comparing)
    else:
        grouping = ends.partition(settings, metric)
    learned = learn_partition(moving, courses, grouping, ends, settings, Subprogress(progress, 0.2, 1.0))
    return replace(learned, notes=(*learned.notes, *told))


def metric_of(settings: LearningSettings) -> str:
    """Return the distance by which demonstrations are compared: in modes paper and repaired the published one."""
    return settings.metric if settings.mode == "default" else "undersampled"


def comparable_paths(
    demonstrations: Mapping[str, Trajectory], metric: str, seed: int, progress: Progress = no_progress
) -> tuple[Array, float]:
    """Resample demonstrations so that their points correspond: (m, n, 3) [m], and the median length of a path [m]."""
    on_step = StepCounter(progress, len(demonstrations), "smoothing the demonstrations")
    courses, lengths = [], []
    for trajectory in demonstrations.values():
        path = smoothed(trajectory)
        courses.append(at_equal_arc_length(path, PATH_POINTS))
        lengths.append(arc_lengths(courses[-1])[-1])
        on_step()
    paired = _equalised(demonstrations, seed) if metric == "undersampled" else np.stack(courses)
    return paired, float(np.median(lengths))


def learn_partition(
    demonstrations: Mapping[str, Trajectory],
    courses: Array,
    grouping: Partition,
    ends: CommonEnds | None,
    settings: LearningSettings,
    progress: Progress,
) -> Learned:
    """Select and fit in the clusters of a partition.

    Args:
        demonstrations: id -> trajectory, in listed order.
        courses: (m, n, 3) [m], see `comparable_paths`.
        grouping: partition of the demonstrations.
        ends: of a task with a moving start or goal.
        settings: see `LearningSettings`.
        progress: receives the fraction done and a sentence.

    Raises:
        LearningFailed: a path cannot keep the error bound.
    """
    names, inputs = tuple(demonstrations), {name: fingerprint(shown) for name, shown in demonstrations.items()}
    if ends is not None:
        demonstrations, courses = ends.brought(demonstrations), ends.courses
    clusters = _selected(demonstrations, courses, grouping, settings, Subprogress(progress, 0.0, 0.75))
    fitted = _fitted(clusters, demonstrations, settings, Subprogress(progress, 0.75, 1.0))
    central = representatives(courses, _labels_of_complete(grouping))
    notes = _partition_notes(names, grouping, ends)
    if settings.mode == "default":
        notes += moving_ends(courses[central], min_separation=settings.min_separation) if ends is None else []
        notes += copies(inputs)
    progress(1.0, f"learned {len(fitted)} {'path' if len(fitted) == 1 else 'paths'}")
    return Learned(
        mode=settings.mode,
        demonstrations=names,
        linkage=grouping.linkage,
        threshold=grouping.threshold,
        clusters=_described(clusters, fitted, [names[number] for number in central], ambiguities(grouping)),
        paths=tuple(path for path, _ in fitted),
        notes=tuple(notes),
        settings=asdict(settings),
        versions=dict(LIBRARY_VERSIONS),
        inputs=inputs,
    )


def _selected(
    demonstrations: Mapping[str, Trajectory],
    courses: Array,
    grouping: Partition,
    settings: LearningSettings,
    progress: Progress,
) -> tuple[Cluster, ...]:
    """Select in every cluster, as the mode does."""
    names = tuple(demonstrations)
    members = members_by_label(names, grouping.labels)
    if settings.mode != "default":
        on_step = StepCounter(progress, paper_step_count(len(members), settings.repeats), SELECTION_MESSAGE)
        return select_as_paper(dict(zip(names, courses, strict=True)), members, settings, on_step=on_step)
    on_step = StepCounter(progress, step_count([len(ids) for ids in members]), SELECTION_MESSAGE)
    stops = _stops(names, grouping)
    return tuple(
        _select_complete(index, ids, demonstrations, stops, settings, on_step) for index, ids in enumerate(members, 1)
    )


def _described(
    clusters: Sequence[Cluster],
    fitted: Sequence[tuple[LearnedPath, Array]],
    central: Sequence[str],
    doubts: Sequence[str],
) -> tuple[Cluster, ...]:
    """Return the clusters with their central demonstrations, the tubes around their paths, and what is doubtful."""
    return tuple(
        replace(cluster, representative=name, spread=spread, ambiguous=doubt)
        for cluster, (_, spread), name, doubt in zip(clusters, fitted, central, doubts, strict=True)
    )


def _partition_notes(names: Sequence[str], grouping: Partition, ends: CommonEnds | None) -> list[str]:
    told = [ends.note if ends else "", grouping.note]
    told += [f"demonstration {name} {describe(stop)}" for name, stop in _stops(names, grouping).items()]
    return list(filter(None, told))


def _stops(names: Sequence[str], grouping: Partition) -> dict[str, Stop]:
    """Return where incomplete demonstrations stop, by their ids."""
    return {names[number]: stop for number, stop in grouping.incomplete.items()}


def _select_complete(
    index: int,
    ids: Sequence[str],
    demonstrations: Mapping[str, Trajectory],
    stops: Mapping[str, Stop],
    settings: LearningSettings,
    on_step: StepCallback,
) -> Cluster:
    """Select among the complete demonstrations of a cluster; the incomplete ones follow them, not selected."""
    complete = [name for name in ids if name not in stops] or list(ids)
    cluster = select(index, {name: demonstrations[name] for name in complete}, settings, on_step=on_step)
    last: list[Score] = []
    for name in sorted(set(ids) - set(complete)):
        duration = float(np.ptp(demonstrations[name].times))
        deviation = Deviation((stops[name].share, 1.0), (duration, duration), describe(stops[name]))
        rank = len(complete) + len(last) + 1
        last.append(Score(name, 0.0, rank, False, describe(stops[name]), deviation=deviation))
    members = (*cluster.members, *(score.demonstration for score in last))
    return replace(cluster, members=members, scores=(*cluster.scores, *last))


def _labels_of_complete(grouping: Partition) -> Labels:
    """Return the labels with 0 for incomplete demonstrations, unless a cluster has no others."""
    labels = grouping.labels.copy()
    labels[list(grouping.incomplete)] = 0
    alone = ~np.isin(grouping.labels, labels)
    labels[alone] = grouping.labels[alone]
    return labels


def _equalised(demonstrations: Mapping[str, Trajectory], seed: int) -> Array:
    """Undersample all demonstrations to the length of the shortest (Aleotti & Caselli, III-A): (m, N, 3) [m]."""
    rng = np.random.default_rng(seed)
    shortest = min(len(trajectory) for trajectory in demonstrations.values())
    # The draws follow the order of the ids, so the order in which demonstrations are listed changes nothing.
    drawn = {name: undersampled(demonstrations[name].positions, shortest, rng) for name in sorted(demonstrations)}
    return np.stack([drawn[name] for name in demonstrations])


def _fitted(
    clusters: tuple[Cluster, ...],
    demonstrations: Mapping[str, Trajectory],
    settings: LearningSettings,
    progress: Progress,
) -> list[tuple[LearnedPath, Array]]:
    """Fit the path of every cluster and measure the tube around it."""
    fit = fit_mean_path if settings.mode == "default" else fit_pooled_points
    found = []
    for done, cluster in enumerate(clusters):
        selected = [demonstrations[score.demonstration] for score in cluster.scores if score.selected]
        own = Subprogress(progress, done / len(clusters), (done + 1) / len(clusters))
        on_step = StepCounter(own, 3 * len(selected), f"fitting the path of way {cluster.index}")
        path = fit(cluster.index, selected, settings, on_step=on_step)
        found.append((path, tube_radius(path.curve, selected, on_step=on_step)))
    return found
