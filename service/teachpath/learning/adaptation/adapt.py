"""Adaptation of a learned path to an object and a goal that lie elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableInput
from teachpath.learning.adaptation.displaced_curve import displaced
from teachpath.learning.adaptation.kriged_shapes import KrigedShapes, Prediction
from teachpath.learning.clustering.average_linkage import average_linkage
from teachpath.learning.clustering.distances import pairwise_distances
from teachpath.learning.clustering.ends import end_groups
from teachpath.learning.clustering.partition import cut_by_separation
from teachpath.learning.fitting.orientation_fit import fit_orientations
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, sign_aligned, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import Curve, unit_quaternions
from teachpath.records import Array, LearnedPath, Trajectory

STATIONS = 100  # at equal arc length
CURVE_SAMPLES = 2000


@dataclass(frozen=True, eq=False)
class Target:
    """Where the object lies and where it is to go, in the world.

    Attributes:
        start: (3,) [m].
        goal: (3,) [m].
        start_orientation: (4,) unit quaternion w, x, y, z; None = as learned.
        goal_orientation: likewise.
    """

    start: Array
    goal: Array
    start_orientation: Array | None = None
    goal_orientation: Array | None = None


@dataclass(frozen=True, eq=False)
class AdaptedPath:
    """A path that was adapted to other ends.

    Attributes:
        spread: (100,) [m] two standard deviations of a demonstration between these ends from the path, at equal arc
            lengths.
        demonstrations: how many the shape was learned from.
        places: at how many different starts or goals these were shown.
        extrapolates: what is beyond the shown range, in words; empty within it.
        note: how sure the adaptation is, in words.
    """

    curve: Curve
    orientation: Curve | None
    spread: Array
    demonstrations: int
    places: int
    extrapolates: str
    note: str


def adapt(
    path: LearnedPath,
    members: Sequence[Trajectory],
    others: Sequence[Trajectory],
    target: Target,
    settings: LearningSettings,
) -> AdaptedPath:
    """Adapt a version of a learned path to another start and goal.

    The path is predicted from the shapes of all demonstrations that do the task in the same way, wherever (see
    `kriged_shapes.py`). What the version has beside such a prediction for its own ends is kept as far as the new ends
    are like them: with its own ends the version stays as it is.

    Args:
        path: the version.
        members: demonstrations that it was learned from.
        others: further demonstrations of the task, of the same way or of others.
        target: where the new path begins and ends.
        settings: of the run that learned the path.

    Raises:
        UnusableInput: an orientation is asked for and none was learned.
        LearningFailed: the orientations cannot be followed within `turn_bound`.
    """
    u = _even_parameters(path.curve)
    base = path.curve(u)
    ends, wanted = (base[0], base[-1]), (target.start, target.goal)
    shown = _same_way(base, _courses(members), _courses(others), settings)
    shapes = KrigedShapes(shown)
    found = shapes.predict(*wanted)
    own = base - shapes.predict(*ends).path
    adapted = found.path + shapes.similarity(ends, wanted) * own
    curve, missed = displaced(path.curve, u, adapted - base, settings.error_bound, settings.most_control_points)
    orientation = _adapted_orientation(path, u, target, settings)
    places = int(end_groups(shown, min_separation=settings.min_separation, length=_length(base)).max())
    note = _note(found, len(shown), places)
    if missed > settings.error_bound:
        note += f"; {len(curve.control_points)} control points follow it within {missed * 1e3:.3g} mm only"
    return AdaptedPath(curve, orientation, 2 * found.deviation, len(shown), places, found.extrapolates, note)


def _courses(trajectories: Sequence[Trajectory]) -> Array:
    courses = [at_equal_arc_length(smoothed(trajectory), STATIONS) for trajectory in trajectories]
    return np.array(courses).reshape(-1, STATIONS, 3)


def _same_way(base: Array, members: Array, others: Array, settings: LearningSettings) -> Array:
    """Return the members, and the others that take the same way as the path once they are brought to its ends."""
    if not len(others):
        return members
    everyone = np.concatenate([members, others])
    brought = np.array([KrigedShapes(course[None]).predict(base[0], base[-1]).path for course in everyone])
    tree = average_linkage(pairwise_distances(brought, "arc"), len(brought))
    labels = cut_by_separation(tree, min_separation=settings.min_separation, length=_length(base)).labels
    alike = labels == labels[0]
    alike[: len(members)] = True
    return np.asarray(everyone[alike])


def _adapted_orientation(path: LearnedPath, u: Array, target: Target, settings: LearningSettings) -> Curve | None:
    """Turn the learned orientations so that they begin and end as wanted; the turns are blended along the path."""
    asked = (target.start_orientation, target.goal_orientation)
    if all(wanted is None for wanted in asked):
        return path.orientation
    if path.orientation is None:
        raise UnusableInput("this path has learned no orientations; leave them out of start and goal")
    learned = unit_quaternions(path.orientation, u)
    turns = [_turn(end, wanted) for end, wanted in zip(learned[[0, -1]], asked, strict=True)]
    share = np.linspace(0.0, 1.0, len(u))[:, None]
    blended = Rotation.from_rotvec((1 - share) * turns[0] + share * turns[1])
    turned = blended * Rotation.from_quat(learned, scalar_first=True)
    quaternions = sign_aligned(np.asarray(turned.as_quat(scalar_first=True)))
    return fit_orientations(path.cluster, quaternions, u, path.orientation.degree, settings)[0]


def _turn(end: Array, wanted: Array | None) -> Array:
    """Return the rotation vector (3,) [rad] in the world from an orientation to the wanted one."""
    if wanted is None:
        return np.zeros(3)
    turn = Rotation.from_quat(wanted, scalar_first=True) * Rotation.from_quat(end, scalar_first=True).inv()
    return np.asarray(turn.as_rotvec())


def _even_parameters(curve: Curve) -> Array:
    """Return the parameters (100,) of points at equal arc length."""
    fine = np.linspace(0.0, 1.0, CURVE_SAMPLES)
    s = arc_lengths(curve(fine))
    return np.asarray(np.interp(np.linspace(0.0, s[-1], STATIONS), s, fine))


def _length(course: Array) -> float:
    return float(arc_lengths(course)[-1])


def _note(found: Prediction, demonstrations: int, places: int) -> str:
    if places == 1:
        return "shown at one place only: the shape is kept, and how it changes with the place is not known"
    if found.extrapolates:
        return f"beyond what was shown: {found.extrapolates}"
    widest = 2 * float(found.deviation.max())
    return (
        f"by {demonstrations} demonstrations at {places} places; one between these ends would lie within "
        f"{widest * 100:.1f} cm of it nineteen times of twenty"
    )
