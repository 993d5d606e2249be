"""The whole of learning on one screen: cluster, select, fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from importlib.metadata import version

import numpy as np

from teachpath.learning import clustering, symbols
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed, undersampled
from teachpath.learning.screening import screen
from teachpath.learning.selection import models_to_train, select, select_as_paper
from teachpath.learning.settings import LearningSettings, Progress, ignore
from teachpath.learning.synthesis import synthesise, synthesise_as_paper
from teachpath.records import Cluster, Learned, LearnedPath, Trajectory

PATH_POINTS = 100  # at equal arc length, for the distance of two paths
LIBRARIES = ("teachpath", "numpy", "scipy", "hmmlearn")


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
    if settings.mode == "paper":
        grouping, clusters, paths = _as_paper(demonstrations, settings, progress)
    else:
        grouping, clusters, paths = _by_default(demonstrations, settings, progress)
    progress(1.0, f"learned {len(paths)} {'path' if len(paths) == 1 else 'paths'}")
    return Learned(
        mode=settings.mode,
        demonstrations=tuple(demonstrations),
        linkage=grouping.linkage,
        threshold=grouping.threshold,
        clusters=clusters,
        paths=paths,
        notes=(grouping.note,) if grouping.note else (),
        settings=asdict(settings),
        versions={name: version(name) for name in LIBRARIES},
    )


Result = tuple[clustering.Grouping, tuple[Cluster, ...], tuple[LearnedPath, ...]]


def _by_default(demonstrations: Mapping[str, Trajectory], settings: LearningSettings, progress: Progress) -> Result:
    smooth = [smoothed(trajectory) for trajectory in demonstrations.values()]
    paths = np.stack([at_equal_arc_length(path, PATH_POINTS) for path in smooth])
    condensed = clustering.distances(paths, _part(progress, 0.0, 0.2))
    if settings.threshold is None:
        length = float(np.median([arc_lengths(path)[-1] for path in paths]))
        grouping = clustering.cut_by_silhouette(condensed, len(paths), guard=settings.guard, length=length)
    else:
        grouping = clustering.cut_at(condensed, len(paths), settings.threshold)
    ways = _members(demonstrations, grouping)
    tick = _ticker(_part(progress, 0.2, 0.8), models_to_train([len(way) for way in ways]))
    clusters = tuple(select(index + 1, way, settings, tick=tick) for index, way in enumerate(ways))
    return grouping, clusters, _fitted(clusters, demonstrations, settings, _part(progress, 0.8, 1.0))


def _as_paper(demonstrations: Mapping[str, Trajectory], settings: LearningSettings, progress: Progress) -> Result:
    assert settings.threshold is not None
    rng = np.random.default_rng(settings.seed)
    shortest = min(len(trajectory) for trajectory in demonstrations.values())
    equalised = [undersampled(trajectory.positions, shortest, rng) for trajectory in demonstrations.values()]
    condensed = clustering.distances(np.stack(equalised), _part(progress, 0.0, 0.2))
    grouping = clustering.cut_at(condensed, len(equalised), settings.threshold)
    ways = _members(demonstrations, grouping)
    if shortest < symbols.WINDOW:
        words = [np.empty((0, 3)) for _ in equalised]
    else:
        words = symbols.symbol_sequences([symbols.spectra(path) for path in equalised], settings.codebook, rng)
    sequences = dict(zip(demonstrations, words, strict=True))
    tick = _ticker(_part(progress, 0.3, 0.8), len(ways))
    clusters = tuple(
        select_as_paper(index + 1, {name: sequences[name] for name in way}, settings, rng, tick=tick)
        for index, way in enumerate(ways)
    )
    return grouping, clusters, _fitted(clusters, demonstrations, settings, _part(progress, 0.8, 1.0))


def _members(demonstrations: Mapping[str, Trajectory], grouping: clustering.Grouping) -> list[dict[str, Trajectory]]:
    listed = list(zip(demonstrations.items(), grouping.labels, strict=True))
    return [dict(item for item, label in listed if label == way) for way in range(1, grouping.labels.max() + 1)]


def _fitted(
    clusters: tuple[Cluster, ...],
    demonstrations: Mapping[str, Trajectory],
    settings: LearningSettings,
    progress: Progress,
) -> tuple[LearnedPath, ...]:
    fit = synthesise_as_paper if settings.mode == "paper" else synthesise
    paths = []
    for done, cluster in enumerate(clusters):
        progress(done / len(clusters), f"fitting the path of way {cluster.index}")
        selected = [demonstrations[score.demonstration] for score in cluster.scores if score.selected]
        paths.append(fit(cluster.index, selected, settings))
    return tuple(paths)


def _part(progress: Progress, begin: float, end: float) -> Progress:
    return lambda fraction, sentence: progress(begin + fraction * (end - begin), sentence)


def _ticker(progress: Progress, total: int) -> Callable[[], None]:
    done = 0

    def tick() -> None:
        nonlocal done
        done += 1
        progress(min(done / max(total, 1), 1.0), "looking for inconsistent demonstrations")

    return tick
