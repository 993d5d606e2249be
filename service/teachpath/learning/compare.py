"""Differences between two learning runs, in sentences: inputs, settings, versions, clusters, selection, paths."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from teachpath.learning.matching import frechet_distance
from teachpath.learning.resampling import at_equal_arc_length
from teachpath.lengths import describe_length, describe_lengths
from teachpath.records import Array, Cluster, Fit, Learned, LearnedPath

PATH_POINTS = 200  # at which two paths are compared
CURVE_SAMPLES = 1000
SAME_PATH_TOLERANCE = 1e-6  # m, between paths that differ by rounding only
MAX_NAMES = 6  # of demonstrations in a sentence; more are only counted


def compare(a: Learned, b: Learned) -> tuple[str, ...]:
    """Describe what differs between two runs, causes before effects; empty when nothing differs.

    Clusters are matched by the demonstrations they share. Two runs with the same inputs, settings and versions agree to
    the last bit, so a change without such a cause is reported as unexplained.
    """
    causes = (
        *_inputs(a, b),
        *_changes("setting", a.settings, b.settings),
        *_changes("version of", a.versions, b.versions),
    )
    pairs = _matched(a, b)
    effects = (*_clusters(a, b, pairs), *_selections(pairs, a, b), *_paths(pairs, a, b))
    if effects and not causes and a.inputs and b.inputs:
        return (*effects, "inputs, settings and versions are the same: the difference is unexplained")
    return (*causes, *effects)


ClusterPairs = list[tuple[Cluster, Cluster]]


def _inputs(a: Learned, b: Learned) -> Iterator[str]:
    before, after = set(a.demonstrations), set(b.demonstrations)
    if gone := [name for name in a.demonstrations if name not in after]:
        yield f"{_named(gone)} no longer learned from"
    if new := [name for name in b.demonstrations if name not in before]:
        yield f"{_named(new)} new"
    if a.inputs and b.inputs:
        changed = [name for name in a.demonstrations if name in after and a.inputs.get(name) != b.inputs.get(name)]
        if changed:
            yield f"{_named(changed)} changed, in samples, object or calibration"
    elif before == after:
        yield "one of the runs kept no fingerprints of its demonstrations: whether they changed cannot be told"
    if before == after and a.demonstrations != b.demonstrations:
        yield "the demonstrations are listed in another order"


def _changes(what: str, a: Mapping[str, object], b: Mapping[str, object]) -> Iterator[str]:
    for name in sorted(set(a) | set(b)):
        if a.get(name) != b.get(name):
            yield f"{what} {name}: {_shown(a.get(name))} became {_shown(b.get(name))}"


def _matched(a: Learned, b: Learned) -> ClusterPairs:
    """Pair the clusters of both runs, those that share most demonstrations first."""
    candidates = [(one, other) for one in a.clusters for other in b.clusters]
    candidates.sort(key=lambda pair: -len(set(pair[0].members) & set(pair[1].members)))
    pairs: ClusterPairs = []
    for one, other in candidates:
        free = all(one is not taken and other is not given for taken, given in pairs)
        if free and set(one.members) & set(other.members):
            pairs.append((one, other))
    return sorted(pairs, key=lambda pair: pair[0].index)


def _clusters(a: Learned, b: Learned, pairs: ClusterPairs) -> Iterator[str]:
    if len(a.clusters) != len(b.clusters):
        heights = " and ".join(describe_lengths(a.threshold, b.threshold))
        yield f"{len(a.clusters)} clusters became {len(b.clusters)}, cut at {heights}"
    both = set(a.demonstrations) & set(b.demonstrations)
    for one, other in pairs:
        if one.index != other.index:
            yield f"cluster {one.index} is now number {other.index}"
        left = sorted((set(one.members) - set(other.members)) & both)
        if left:
            yield f"cluster {one.index}: {_named(left)} now in another cluster"
    for learned, index, told in ((a, 0, "is gone"), (b, 1, "is new")):
        known = {pair[index].index for pair in pairs}
        for cluster in learned.clusters:
            if cluster.index not in known:
                yield f"cluster {cluster.index} of {len(cluster.members)} demonstrations {told}"


def _selections(pairs: ClusterPairs, a: Learned, b: Learned) -> Iterator[str]:
    both = set(a.demonstrations) & set(b.demonstrations)
    for one, other in pairs:
        before, after = ({s.demonstration for s in cluster.scores if s.selected} for cluster in (one, other))
        if dropped := sorted((before - after) & both & set(other.members)):
            yield f"cluster {one.index}: {_named(dropped)} no longer selected"
        if added := sorted((after - before) & both & set(one.members)):
            yield f"cluster {one.index}: {_named(added)} now selected"


def _paths(pairs: ClusterPairs, a: Learned, b: Learned) -> Iterator[str]:
    for one, other in pairs:
        before, after = _path(a, one), _path(b, other)
        if before is None or after is None:
            continue
        moved = frechet_distance(_course(before), _course(after))
        counts = [len(path.curve.control_points) for path in (before, after)]
        shapes = [(path.curve.degree, count) for path, count in zip((before, after), counts, strict=True)]
        if moved <= SAME_PATH_TOLERANCE and shapes[0] == shapes[1]:
            continue
        bends = "" if shapes[0] == shapes[1] else f", degree and control points {shapes[0]} became {shapes[1]}"
        fits = _fits(before.fit, after.fit)
        yield f"cluster {one.index}: the path moved by up to {describe_length(moved)}{bends}{fits}"


def _fits(before: Fit | None, after: Fit | None) -> str:
    if before is None or after is None or abs(before.tube - after.tube) <= SAME_PATH_TOLERANCE:
        return ""
    old, new = describe_lengths(before.tube, after.tube)
    return f", tube {old} became {new}"


def _course(path: LearnedPath) -> Array:
    return at_equal_arc_length(path.curve(np.linspace(0.0, 1.0, CURVE_SAMPLES)), PATH_POINTS)


def _path(learned: Learned, cluster: Cluster) -> LearnedPath | None:
    return next((path for path in learned.paths if path.cluster == cluster.index), None)


def _named(names: list[str]) -> str:
    verb = "is" if len(names) == 1 else "are"
    if len(names) > MAX_NAMES:
        return f"{len(names)} demonstrations are"
    return f"{'demonstration' if len(names) == 1 else 'demonstrations'} {', '.join(names)} {verb}"


def _shown(value: object) -> str:
    return "nothing" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
