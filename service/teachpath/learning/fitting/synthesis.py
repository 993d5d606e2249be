"""One learned path out of the selected demonstrations of a cluster."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teachpath.errors import LearningFailed
from teachpath.learning.clustering.distances import frechet
from teachpath.learning.fitting.nurbs_fit import DENSE, Approximation, approximate, distances_from, distances_to
from teachpath.learning.fitting.orientation_fit import mean_orientations, orient
from teachpath.learning.resampling import SMOOTHING, arc_lengths, at_equal_arc_length, smoothed
from teachpath.learning.settings import LearningSettings, Tick
from teachpath.records import Array, Fit, LearnedPath, Trajectory

CONSENSUS_POINTS = 200
FINE = 4  # times as many, where those are too few for the bound
NOISES = 4.5  # standard deviations that a bound on the largest of hundreds of errors has to allow noise
LEAST_LENGTH = 0.05  # of the mean path, as share of the longest that went into it
SMOOTH_COST = 3  # more control points that degree 5 may take than degree 3
PAPER_DEGREE = 3
POOLED_MOST = 12  # control points on a pooled list: more follow its zigzag and come no closer
RETREAT = 0.05  # share of the way that may lead back towards the start unmentioned


def consensus(paths: Sequence[Array], count: int = CONSENSUS_POINTS) -> Array:
    """Average paths at equal arc length: (count, 3) [m], from the mean start to the mean goal."""
    return np.asarray(np.mean([at_equal_arc_length(path, count) for path in paths], axis=0))


def synthesise(cluster: int, selected: Sequence[Trajectory], settings: LearningSettings, *, tick: Tick) -> LearnedPath:
    """Fit the consensus of the selected demonstrations within the error bound (mode default).

    A mean that is too wiggly for the bound, though not by noise, is followed as closely as `most_control_points` can,
    and the note says how closely.

    Args:
        cluster: its number.
        selected: demonstrations.
        settings: `error_bound`, `most_control_points` and `degree`.
        tick: called twice for each of them.

    Raises:
        LearningFailed: the bound is below what noise leaves in the mean, or the demonstrations cancel out.
    """
    paths = []
    for trajectory in selected:
        paths.append(smoothed(trajectory))
        tick()
    course = consensus(paths)
    length, usual = _length(course), max(_length(path) for path in paths)
    if length < LEAST_LENGTH * usual:
        raise LearningFailed(
            f"the mean of way {cluster} is {length * 1e3:.3g} mm long, its demonstrations up to {usual * 1e3:.3g} mm: "
            "they lead in opposite directions; lower learning.threshold"
        )
    bound, note = settings.error_bound, ""
    best = best_fit(course, settings)
    if best.largest > bound:
        noise = noise_left(selected)
        if bound < NOISES * noise:
            raise LearningFailed(
                f"way {cluster} cannot be followed within {bound * 1e3:.3g} mm: noise leaves some {noise * 1e3:.2g} mm "
                f"in the mean of its demonstrations, and a path within {bound * 1e3:.3g} mm would follow the noise; "
                f"raise learning.error_bound to {NOISES * noise * 1e3:.2g} mm, or show it more often"
            )
        course = consensus(paths, FINE * CONSENSUS_POINTS)
        best = best_fit(course, settings)
    # The fit measures at its own parameters, the nearest distances are what the operator gets.
    if best.largest > bound and (nearest := float(distances_to(best.curve, course).max())) > bound:
        note = (
            f"the demonstrations wiggle: their mean is followed within {nearest * 1e3:.3g} mm only, not "
            f"{bound * 1e3:.3g} mm, by {settings.most_control_points} control points; show it more smoothly, or raise "
            "learning.error_bound or learning.most_control_points"
        )
    return _path(cluster, best, course, selected, settings, note, tick)


def synthesise_as_paper(
    cluster: int, selected: Sequence[Trajectory], settings: LearningSettings, *, tick: Tick
) -> LearnedPath:
    """Pool the points of the selected, sort them by distance to the start and approximate (Aleotti & Caselli, III-C).

    The global approximation of The NURBS Book returns more control points than points when such a list zigzags
    more than the bound; the number of control points is limited here and the note says when the bound is not met.
    """
    start = np.mean([trajectory.positions[0] for trajectory in selected], axis=0)
    pooled = np.concatenate([trajectory.positions for trajectory in selected])
    order = np.argsort(np.linalg.norm(pooled - start, axis=1), kind="stable")
    points = np.concatenate([start[None], pooled[order]])
    most = min(POOLED_MOST, settings.most_control_points)
    degree = PAPER_DEGREE if settings.degree is None else settings.degree
    span = 8 * len(selected)
    fit = approximate(points, settings.error_bound, degree=degree, most=most, span=span)
    notes = []
    largest = float(distances_to(fit.curve, points).max())
    if largest > settings.error_bound:
        notes.append(f"the pooled points spread too far for the bound: up to {largest * 100:.1f} cm from the curve")
    share = max(_retreat(smoothed(trajectory)) for trajectory in selected)
    if share > RETREAT:
        notes.append(
            f"{share:.0%} of the motion leads back towards the start: sorting by distance to it scrambles the path, "
            "use mode default"
        )
    return _path(cluster, fit, points, selected, settings, "; ".join(notes), tick)


def noise_left(selected: Sequence[Trajectory]) -> float:
    """Return the noise [m] that smoothing and averaging leave in the mean, as read off the third differences."""
    squares = []
    for trajectory in selected:
        roughness = float(np.median(np.square(np.diff(trajectory.positions, 3, axis=0)).sum(axis=1)))
        width = max(SMOOTHING / float(np.median(np.diff(trajectory.times))), 1.0)
        # The squares of 1, -3, 3, -1 are 20 together.
        squares.append(roughness / 20 / width)
    return float(np.sqrt(np.mean(squares) / len(squares)))


def _length(path: Array) -> float:
    return float(arc_lengths(path)[-1])


def best_fit(course: Array, settings: LearningSettings) -> Approximation:
    """Return the fit of a mean path (n, 3) [m] that keeps the bound at the least cost, or comes nearest to it.

    Degree 5 is taken where it costs at most two control points more than degree 3: it bends less sharply, and where a
    path turns back the arm is faster along it (`make experiments`).
    """
    degrees = (3, 5) if settings.degree is None else (settings.degree,)
    bound, most = settings.error_bound, settings.most_control_points
    fits = [approximate(course, bound, degree=degree, most=most) for degree in degrees]
    kept = [fit for fit in fits if fit.largest <= bound]
    return min(kept, key=_cost) if kept else min(fits, key=lambda fit: fit.largest)


def _cost(fit: Approximation) -> int:
    return len(fit.curve.control_points) - (SMOOTH_COST if fit.curve.degree > 3 else 0)


def _retreat(path: Array) -> float:
    """Return the share of the length over which the distance to the start decreases by more than noise."""
    even = at_equal_arc_length(path, 50)
    return float(np.mean(np.diff(np.linalg.norm(even - even[0], axis=1)) < -0.25 * _length(even) / 49))


def _path(
    cluster: int,
    fit: Approximation,
    fitted: Array,
    selected: Sequence[Trajectory],
    settings: LearningSettings,
    note: str,
    tick: Tick,
) -> LearnedPath:
    distances = distances_from(fit.curve)
    apart = distances(fitted)
    course = consensus([smoothed(trajectory) for trajectory in selected])
    tube = 0.0
    for trajectory in selected:
        tube = max(tube, float(distances(trajectory.positions).max()))
        tick()
    mean, orientation, turn = mean_orientations(selected, len(course)), None, None
    s = arc_lengths(course)
    if mean is not None and s[-1] > 0:
        orientation, turn = orient(cluster, mean, s / s[-1], fit.curve.degree, settings)
    measures = Fit(
        settings.error_bound,
        float(apart.max()),
        float(np.sqrt(np.mean(np.square(apart)))),
        tube,
        frechet(at_equal_arc_length(fit.curve(np.linspace(0.0, 1.0, DENSE)), len(course)), course),
        turn,
    )
    return LearnedPath("", "", cluster, 1, fit.curve, measures, note, orientation)
