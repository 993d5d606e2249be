"""Summary of the clusters and inputs of a run: ambiguities, representatives, tubes, fingerprints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from hashlib import sha256

import numpy as np

from teachpath.learning.clustering.dendrogram import Labels, labels_for_count
from teachpath.learning.clustering.partition import Partition
from teachpath.learning.resampling import at_equal_arc_length, smoothed
from teachpath.learning.settings import StepCallback
from teachpath.nurbs import Curve
from teachpath.records import Array, Trajectory

TUBE_POINTS = 50
CURVE_SAMPLES = 1000  # points of the polyline that stands for a curve


def ambiguities(grouping: Partition) -> list[str]:
    """Describe for every cluster what the next best cut would change; empty where it would change nothing."""
    labels = grouping.labels
    count = int(labels.max())
    if grouping.alternative is None:
        return [""] * count
    other = labels_for_count(grouping.linkage, grouping.alternative)
    sentences = []
    for label in range(1, count + 1):
        parts, sizes = np.unique(other[labels == label], return_counts=True)
        within = np.unique(labels[np.isin(other, parts)])
        if len(parts) > 1:
            sizes_told = " and ".join(str(size) for size in sizes)
            sentences.append(f"ambiguous: could as well be {len(parts)} ways, of {sizes_told} demonstrations")
        elif len(within) > 1:
            partners = " and ".join(str(partner) for partner in within if partner != label)
            sentences.append(f"ambiguous: could as well be one way together with {partners}")
        else:
            sentences.append("")
    return sentences


def representatives(courses: Array, labels: Labels) -> Labels:
    """Return for every cluster 1, 2, ... the member nearest to the mean of the members.

    Args:
        courses: (m, n, 3) [m], see `learn.comparable_paths`.
        labels: (m,).
    """
    found = []
    for label in range(1, int(labels.max()) + 1):
        members = np.flatnonzero(labels == label)
        own = courses[members]
        apart = np.linalg.norm(own - own.mean(axis=0), axis=2).mean(axis=1)
        # Of members that differ by rounding only, as the two of a pair do, the first one is taken.
        found.append(members[np.argmax(apart <= apart.min() * (1 + 1e-9))])
    return np.array(found)


def tube_radius(curve: Curve, selected: Sequence[Trajectory], *, on_step: StepCallback) -> Array:
    """Measure how far the selected demonstrations lie beside the path, perpendicular to it.

    Args:
        curve: the learned path.
        selected: demonstrations that the path was learned from.
        on_step: called once for each demonstration.

    Returns:
        (50,) [m] largest distance at equal arc lengths.
    """
    course = at_equal_arc_length(curve(np.linspace(0.0, 1.0, CURVE_SAMPLES)), TUBE_POINTS)
    along = np.gradient(course, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    radius = np.zeros(TUBE_POINTS)
    for trajectory in selected:
        apart = at_equal_arc_length(smoothed(trajectory), TUBE_POINTS) - course
        across = apart - (apart * along).sum(axis=1, keepdims=True) * along
        radius = np.maximum(radius, np.linalg.norm(across, axis=1))
        on_step()
    return radius


def fingerprint(trajectory: Trajectory) -> str:
    """Return the SHA-256 of a trajectory's times, positions and orientations as little-endian doubles."""
    digest = sha256()
    for part in (trajectory.times, trajectory.positions, trajectory.orientations):
        if part is not None:
            digest.update(np.ascontiguousarray(part, dtype="<f8").tobytes())
    return digest.hexdigest()


def copies(fingerprints: Mapping[str, str]) -> list[str]:
    """Name the demonstrations that are copies of one another, by their fingerprints: one sentence for each set."""
    same: dict[str, list[str]] = {}
    for name, digest in fingerprints.items():
        same.setdefault(digest, []).append(name)
    return [
        f"demonstrations {', '.join(names[:-1])} and {names[-1]} are copies; their agreement says nothing"
        for names in same.values()
        if len(names) > 1
    ]
