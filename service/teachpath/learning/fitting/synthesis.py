"""One learned path out of the selected demonstrations of a cluster."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from teachpath.errors import LearningFailed
from teachpath.learning.fitting.nurbs_fit import (
    CURVE_SAMPLES,
    Approximation,
    CurveDistance,
    approximate,
    distances_to_curve,
)
from teachpath.learning.fitting.orientation_fit import fit_orientations, mean_orientations
from teachpath.learning.matching import frechet_distance
from teachpath.learning.resampling import SMOOTHING_WINDOW, arc_lengths, at_equal_arc_length, extent, smoothed
from teachpath.learning.settings import LearningSettings, StepCallback
from teachpath.lengths import describe_length, describe_lengths
from teachpath.nurbs import Curve
from teachpath.records import Array, Fit, LearnedPath, Trajectory

MEAN_PATH_POINTS = 200
REFINEMENT_FACTOR = 4  # on the number of points, where they are too few for the bound
MIN_BOUND_TO_NOISE = 4.5  # a bound below so many standard deviations of the noise would follow the noise
MIN_LENGTH_SHARE = 0.05  # of the mean path, of the longest demonstration
QUINTIC_ALLOWANCE = 3  # control points that degree 5 may need more than degree 3, less one
PAPER_DEGREE = 3
MEASURED_TOGETHER = 32  # demonstrations whose distances are measured at once; alone, calls would take most of the time
MAX_RETREAT_SHARE = 0.05  # of the path that may lead back towards the start without a note


def mean_path(paths: Sequence[Array], count: int = MEAN_PATH_POINTS) -> Array:
    """Average paths at equal arc length: (count, 3) [m], from the mean start to the mean goal."""
    return np.asarray(np.mean([at_equal_arc_length(path, count) for path in paths], axis=0))


def fit_mean_path(
    cluster: int, selected: Sequence[Trajectory], settings: LearningSettings, *, on_step: StepCallback
) -> LearnedPath:
    """Fit the consensus of the selected demonstrations within the error bound (mode default).

    When the mean path wiggles too much for the bound, and not because of noise, the fit uses all `most_control_points`
    and the note tells the distance reached.

    Args:
        cluster: its number.
        selected: demonstrations.
        settings: `error_bound`, `relative_bound`, `most_control_points` and `degree`.
        on_step: called twice for each demonstration.

    Raises:
        LearningFailed: the bound is below what noise leaves in the mean, or the demonstrations cancel out.
    """
    paths = []
    for trajectory in selected:
        paths.append(smoothed(trajectory))
        on_step()
    course = mean_path(paths)
    length, usual = _length(course), max(_length(path) for path in paths)
    if length < MIN_LENGTH_SHARE * usual:
        raise LearningFailed(
            f"the mean of way {cluster} is {describe_length(length)} long, its demonstrations up to "
            f"{describe_length(usual)}: they lead in opposite directions; lower learning.threshold"
        )
    size = extent(course)
    bound, note = settings.bound_for(size), ""
    fitted, best = course, best_fit(course, settings, bound)
    if best.largest > bound:
        least = MIN_BOUND_TO_NOISE * residual_noise(selected)
        if bound < min(least, settings.error_bound):
            bound = min(least, settings.error_bound)
            note = (
                f"followed within {_in_both(bound, size)}, not {100 * settings.relative_bound:.3g}%, because of the "
                "noise in its demonstrations"
            )
            best = best_fit(fitted, settings, bound)
        if best.largest > bound:
            _check_noise(cluster, bound, least)
            fitted = mean_path(paths, REFINEMENT_FACTOR * MEAN_PATH_POINTS)
            best = best_fit(fitted, settings, bound)
    # The fit measures at its own parameters; the nearest distances are what matters to the operator.
    if best.largest > bound and (nearest := float(distances_to_curve(best.curve, fitted).max())) > bound:
        reached, asked = describe_lengths(nearest, bound)
        note = (
            f"the demonstrations wiggle: their mean is followed within {reached} only, not {asked} "
            f"({100 * bound / size:.2g}% of its size), by {settings.most_control_points} control points; show it more "
            "smoothly, or raise learning.error_bound, learning.relative_bound or learning.most_control_points"
        )
    return _path(cluster, best.curve, fitted, course, selected, settings, bound, note, on_step)


def _in_both(bound: float, size: float) -> str:
    """Say a bound [m] as a length and as a share of the size [m] of the path."""
    return f"{describe_length(bound)} ({100 * bound / size:.2g}% of its size)"


def _check_noise(cluster: int, bound: float, least: float) -> None:
    """Refuse a bound [m] below the least that does not follow the noise."""
    if bound < least:
        raise LearningFailed(
            f"way {cluster} cannot be followed within {describe_length(bound)}: noise leaves some "
            f"{describe_length(least / MIN_BOUND_TO_NOISE)} in the mean of its demonstrations, and a path within "
            f"{describe_length(bound)} would follow the noise; raise learning.error_bound to "
            f"{describe_length(least, up=True)}, or show it more often"
        )


def fit_pooled_points(
    cluster: int, selected: Sequence[Trajectory], settings: LearningSettings, *, on_step: StepCallback
) -> LearnedPath:
    """Pool the points of the selected, sort them by distance to the start and approximate (Aleotti & Caselli, III-C).

    The publication's order is that of Euclidean distances, not of arc lengths, so that the points of two demonstrations
    alternate. The approximation is that of its library, from the polygon of the points as they are ordered. Where such
    a list zigzags by more than the bound, it takes more control points than there are points; the bound is widened
    until `most_control_points` are enough, and the note says so.
    """
    from teachpath.learning.fitting.global_approximation import approximate_from_polygon  # here, as it loads numba

    start = np.mean([trajectory.positions[0] for trajectory in selected], axis=0)
    pooled = np.concatenate([trajectory.positions for trajectory in selected])
    order = np.argsort(np.linalg.norm(pooled - start, axis=1), kind="stable")
    points = np.concatenate([start[None], pooled[order]])
    degree = PAPER_DEGREE if settings.degree is None else settings.degree
    fit = approximate_from_polygon(points, settings.error_bound, degree=degree, most=settings.most_control_points)
    notes = []
    if fit.bound > settings.error_bound:
        kept, asked = describe_length(fit.bound, up=True), describe_length(settings.error_bound)
        notes.append(
            f"sorted by distance to the start, the points zigzag: {settings.most_control_points} control points or "
            f"fewer follow them within {kept}, not {asked}"
        )
    share = max(_retreat(smoothed(trajectory)) for trajectory in selected)
    if share > MAX_RETREAT_SHARE:
        notes.append(
            f"{share:.0%} of the motion leads back towards the start: sorting by distance to it scrambles the path, "
            "use mode default"
        )
    course = mean_path([smoothed(trajectory) for trajectory in selected])
    return _path(cluster, fit.curve, points, course, selected, settings, fit.bound, "; ".join(notes), on_step)


def residual_noise(selected: Sequence[Trajectory]) -> float:
    """Estimate the noise [m] that smoothing and averaging leave in the mean path, from third differences.

    Only what is across the motion counts: an uneven clock leaves differences along it, and moves no path.
    """
    squares = []
    for trajectory in selected:
        along = trajectory.positions[3:] - trajectory.positions[:-3]
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
        third = np.diff(trajectory.positions, 3, axis=0)
        across = third - (third * along).sum(axis=1, keepdims=True) * along
        roughness = 1.5 * float(np.median(np.square(across).sum(axis=1)))  # two axes of three
        width = max(SMOOTHING_WINDOW / float(np.median(np.diff(trajectory.times))), 1.0)
        # The squares of the coefficients 1, -3, 3, -1 of a third difference sum to 20.
        squares.append(roughness / 20 / width)
    return float(np.sqrt(np.mean(squares) / len(squares)))


def _turns(selected: Sequence[Trajectory], count: int) -> tuple[Array, Array]:
    """Return the mean orientations (count, 4) at equal arc lengths, and their parameters on the path (count,)."""
    s = arc_lengths(mean_path([smoothed(trajectory) for trajectory in selected], count))
    mean = mean_orientations(selected, count)
    assert mean is not None
    return mean, s / s[-1]


def _length(path: Array) -> float:
    return float(arc_lengths(path)[-1])


def best_fit(course: Array, settings: LearningSettings, bound: float) -> Approximation:
    """Fit a mean path (n, 3) [m] with the fewest control points within the bound, or else as closely as possible.

    Degree 5 is preferred when it needs at most two control points more than degree 3: its curvature changes less
    sharply, and where a path turns back the arm follows it faster (`make experiments`).
    """
    degrees = (3, 5) if settings.degree is None else (settings.degree,)
    most = settings.most_control_points
    fits = [approximate(course, bound, degree=degree, most=most) for degree in degrees]
    kept = [fit for fit in fits if fit.largest <= bound]
    return min(kept, key=_cost) if kept else min(fits, key=lambda fit: fit.largest)


def _cost(fit: Approximation) -> int:
    return len(fit.curve.control_points) - (QUINTIC_ALLOWANCE if fit.curve.degree > 3 else 0)


def _retreat(path: Array) -> float:
    """Return the share of the path on which the distance to the start decreases by more than noise."""
    even = at_equal_arc_length(path, 50)
    return float(np.mean(np.diff(np.linalg.norm(even - even[0], axis=1)) < -0.25 * _length(even) / 49))


def _path(
    cluster: int,
    curve: Curve,
    fitted: Array,
    course: Array,
    selected: Sequence[Trajectory],
    settings: LearningSettings,
    bound: float,
    note: str,
    on_step: StepCallback,
) -> LearnedPath:
    distances = CurveDistance(curve)
    apart = distances(fitted)
    tube = 0.0
    for begin in range(0, len(selected), MEASURED_TOGETHER):
        together = selected[begin : begin + MEASURED_TOGETHER]
        tube = max(tube, float(distances(np.concatenate([each.positions for each in together])).max()))
        for _ in together:
            on_step()
    orientation, turn = None, None
    if all(trajectory.orientations is not None for trajectory in selected) and _length(course) > 0:
        orientation, turn = fit_orientations(cluster, partial(_turns, selected), curve.degree, settings)
    measures = Fit(
        bound,
        float(apart.max()),
        float(np.sqrt(np.mean(np.square(apart)))),
        tube,
        frechet_distance(at_equal_arc_length(curve(np.linspace(0.0, 1.0, CURVE_SAMPLES)), len(course)), course),
        turn,
    )
    return LearnedPath("", "", cluster, 1, curve, measures, note, orientation)
