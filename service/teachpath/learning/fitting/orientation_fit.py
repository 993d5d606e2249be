"""Orientation along a learned path: a curve of quaternions over the parameter of the position curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from teachpath.errors import LearningFailed
from teachpath.learning.fitting.nurbs_fit import approximate
from teachpath.learning.resampling import arc_lengths, sign_aligned, smoothed, smoothed_orientations
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import Curve, unit_quaternions
from teachpath.records import Array, Trajectory

POINT_COUNTS = (200, 800, 3200)  # of a mean course of orientations


def mean_orientations(selected: Sequence[Trajectory], count: int) -> Array | None:
    """Average orientations at equal arc length.

    The mean is the principal axis of the sum of the quaternions' outer products, which does not depend on their signs
    (Markley et al. 2007). A rotation on the spot has no arc length; only its start and end remain, as a step.

    Args:
        selected: the trajectories.
        count: number of points.

    Returns:
        (count, 4) unit quaternions, neighbours on one half of the sphere, first w positive; None when a trajectory
        has no orientations.
    """
    courses = []
    for trajectory in selected:
        if trajectory.orientations is None:
            return None
        courses.append(_at_equal_arc_length(trajectory, trajectory.orientations, count))
    stacked = np.stack(courses)  # (m, count, 4)
    axes = np.linalg.eigh(np.einsum("mki,mkj->kij", stacked, stacked))[1]
    mean = axes[..., -1]
    return sign_aligned(mean if mean[0, 0] >= 0 else -mean)


def fit_orientations(
    cluster: int, sampled: Callable[[int], tuple[Array, Array]], degree: int, settings: LearningSettings
) -> tuple[Curve, float]:
    """Fit a curve of quaternions within `turn_bound`.

    A hand turns where it rests, at grasp and release, and there a short piece of the path turns far: where 200 points
    are too few for the bound, 800 are taken.

    Args:
        cluster: number of the cluster, for the error message.
        sampled: returns, for a number of points n, unit quaternions (n, 4), neighbours on one half of the sphere, and
            their parameters (n,) on the position curve.
        degree: of the curve.
        settings: `turn_bound` and `most_control_points`.

    Returns:
        the curve and its largest angle from the quaternions [rad].

    Raises:
        LearningFailed: the bound cannot be kept.
    """
    # A point within sin(a / 2) of a unit quaternion is within the angle a of it after normalisation.
    bound, most = float(np.sin(settings.turn_bound / 2)), settings.most_control_points
    for count in POINT_COUNTS:
        quaternions, at = sampled(count)
        curve = approximate(quaternions, bound, degree=degree, most=most, at=at).curve
        largest = float(rotation_angles(unit_quaternions(curve, at), quaternions).max())
        if largest <= settings.turn_bound:
            return curve, largest
    raise LearningFailed(
        f"the orientations of way {cluster} cannot be followed within {np.degrees(settings.turn_bound):.3g}°: "
        f"{len(curve.control_points)} control points reach {np.degrees(largest):.3g}°; raise learning.turn_bound or "
        f"learning.most_control_points ({most}), or turn the object while it moves"
    )


def rotation_angles(one: Array, other: Array) -> Array:
    """Return the rotation angles between unit quaternions, independent of their signs: (n,) [rad]."""
    signs = np.where((one * other).sum(axis=1) < 0, -1.0, 1.0)[:, None]
    return np.asarray(4 * np.arcsin(np.clip(np.linalg.norm(one - signs * other, axis=1) / 2, 0.0, 1.0)))


def _at_equal_arc_length(trajectory: Trajectory, orientations: Array, count: int) -> Array:
    smooth = smoothed_orientations(trajectory.times, orientations)
    s = arc_lengths(smoothed(trajectory))
    forward = np.concatenate([[True], np.diff(s) > 0])
    stations = np.linspace(0.0, s[-1], count)
    course = np.column_stack([np.interp(stations, s[forward], smooth[forward, k]) for k in range(4)])
    course[[0, -1]] = smooth[[0, -1]]
    return np.asarray(course / np.linalg.norm(course, axis=1, keepdims=True))
