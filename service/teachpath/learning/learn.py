"""The whole of learning on one screen: cluster, select, fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from importlib.metadata import version

import numpy as np

from teachpath.learning.clustering import Grouping
from teachpath.learning.crowd import grouped
from teachpath.learning.dendrogram import Labels, groups
from teachpath.learning.describing import ambiguities, fingerprint, representatives, tube
from teachpath.learning.paper import models_of_paper, select_as_paper
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed, undersampled
from teachpath.learning.screening import screen
from teachpath.learning.selection import models_to_train, select
from teachpath.learning.settings import LearningSettings, Progress, ignore
from teachpath.learning.synthesis import synthesise, synthesise_as_paper
from teachpath.records import Array, Cluster, Learned, LearnedPath, Trajectory

PATH_POINTS = 100  # at equal arc length, for the distance of two paths
LIBRARIES = ("teachpath", "numpy", "scipy", "hmmlearn", "numba")


def learn(
    demonstrations: Mapping[str, Trajectory], settings: LearningSettings, *, progress: Progress = ignore
) -> Learned:
    """Learn a path for every way in which a task was demonstrated.

    The same demonstrations, settings and library versions give the same result to the last bit. Clusters are
    numbered from 1 in the order of their first members; paths come in the order of the clusters, without id and run.

    Args:
        demonstrations: id -> trajectory, in listed order.
        settings: see `LearningSettings`.
        progress: told the fraction done and a sentence; what it raises passes through.

    Raises:
        LearningFailed: a demonstration cannot be used, or a path cannot keep the error bound.
    """
    screen(demonstrations)
    progress(0.0, f"comparing {len(demonstrations)} demonstrations")
    metric = metric_of(settings)
    courses, length = courses_of(demonstrations, metric, settings.seed)
    grouping = grouped(courses, settings, length=length, metric=metric, progress=_part(progress, 0.0, 0.2))
    return from_ways(demonstrations, courses, grouping, settings, _part(progress, 0.2, 1.0))


def metric_of(settings: LearningSettings) -> str:
    """Return by which distance demonstrations are compared."""
    return settings.metric if settings.mode == "default" else "undersampled"


def courses_of(demonstrations: Mapping[str, Trajectory], metric: str, seed: int) -> tuple[Array, float]:
    """Return what the demonstrations are compared by, (m, n, 3) [m], and the length of a typical path [m]."""
    if metric == "undersampled":
        lengths = [arc_lengths(smoothed(each))[-1] for each in demonstrations.values()]
        return _equalised(demonstrations, seed), float(np.median(lengths))
    courses = np.stack([at_equal_arc_length(smoothed(each), PATH_POINTS) for each in demonstrations.values()])
    return courses, float(np.median([arc_lengths(course)[-1] for course in courses]))


def from_ways(
    demonstrations: Mapping[str, Trajectory],
    courses: Array,
    grouping: Grouping,
    settings: LearningSettings,
    progress: Progress,
) -> Learned:
    """Select and fit in the clusters of a grouping.

    Args:
        demonstrations: id -> trajectory, in listed order.
        courses: what they were compared by, see `courses_of`.
        grouping: of them.
        settings: see `LearningSettings`.
        progress: told the fraction done and a sentence.

    Raises:
        LearningFailed: a path cannot keep the error bound.
    """
    names = tuple(demonstrations)
    ways = groups(names, grouping.labels)
    choosing = _part(progress, 0.0, 0.75)
    if settings.mode == "default":
        tick = _ticker(choosing, models_to_train([len(way) for way in ways], settings.repeats))
        clusters = tuple(
            select(index + 1, {name: demonstrations[name] for name in way}, settings, tick=tick)
            for index, way in enumerate(ways)
        )
    else:
        tick = _ticker(choosing, models_of_paper(len(ways), settings.repeats))
        clusters = select_as_paper(dict(zip(names, courses, strict=True)), ways, settings, tick=tick)
    paths = _fitted(clusters, demonstrations, settings, _part(progress, 0.75, 1.0))
    progress(1.0, f"learned {len(paths)} {'path' if len(paths) == 1 else 'paths'}")
    return Learned(
        mode=settings.mode,
        demonstrations=names,
        linkage=grouping.linkage,
        threshold=grouping.threshold,
        clusters=_described(clusters, paths, grouping, representatives(courses, grouping.labels), demonstrations),
        paths=paths,
        notes=(grouping.note,) if grouping.note else (),
        settings=asdict(settings),
        versions={name: version(name) for name in LIBRARIES},
        inputs={name: fingerprint(trajectory) for name, trajectory in demonstrations.items()},
    )


def _equalised(demonstrations: Mapping[str, Trajectory], seed: int) -> Array:
    """Undersample all demonstrations to the length of the shortest (Aleotti & Caselli, III-A): (m, N, 3) [m]."""
    rng = np.random.default_rng(seed)
    shortest = min(len(trajectory) for trajectory in demonstrations.values())
    # Drawn in the order of the ids, so that the order in which they are listed changes nothing.
    drawn = {name: undersampled(demonstrations[name].positions, shortest, rng) for name in sorted(demonstrations)}
    return np.stack([drawn[name] for name in demonstrations])


def _fitted(
    clusters: tuple[Cluster, ...],
    demonstrations: Mapping[str, Trajectory],
    settings: LearningSettings,
    progress: Progress,
) -> tuple[LearnedPath, ...]:
    fit = synthesise if settings.mode == "default" else synthesise_as_paper
    paths = []
    for done, cluster in enumerate(clusters):
        progress(done / len(clusters), f"fitting the path of way {cluster.index}")
        paths.append(fit(cluster.index, _selected(cluster, demonstrations), settings))
    return tuple(paths)


def _described(
    clusters: tuple[Cluster, ...],
    paths: tuple[LearnedPath, ...],
    grouping: Grouping,
    central: Labels,
    demonstrations: Mapping[str, Trajectory],
) -> tuple[Cluster, ...]:
    names = tuple(demonstrations)
    return tuple(
        replace(
            cluster,
            representative=names[member],
            spread=tube(path.curve, _selected(cluster, demonstrations)),
            ambiguous=doubt,
        )
        for cluster, path, member, doubt in zip(clusters, paths, central, ambiguities(grouping), strict=True)
    )


def _selected(cluster: Cluster, demonstrations: Mapping[str, Trajectory]) -> Sequence[Trajectory]:
    return [demonstrations[score.demonstration] for score in cluster.scores if score.selected]


def _part(progress: Progress, begin: float, end: float) -> Progress:
    return lambda fraction, sentence: progress(begin + fraction * (end - begin), sentence)


def _ticker(progress: Progress, total: int) -> Callable[[], None]:
    done = 0

    def tick() -> None:
        nonlocal done
        done += 1
        progress(min(done / max(total, 1), 1.0), "looking for inconsistent demonstrations")

    return tick
