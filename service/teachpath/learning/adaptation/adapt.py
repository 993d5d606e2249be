"""Adaptation of a learned path to an object and a goal that lie elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.learning.adaptation.adapted_course import CourseModel
from teachpath.learning.adaptation.adapted_orientation import adapted_orientation
from teachpath.learning.adaptation.displaced_curve import displaced
from teachpath.learning.adaptation.even_parameters import even_parameters
from teachpath.learning.adaptation.kriged_shapes import KrigedShapes, Prediction
from teachpath.learning.adaptation.same_way import labels_of_ways
from teachpath.learning.adaptation.target import Target
from teachpath.learning.clustering.ends import end_groups
from teachpath.learning.fitting.orientation_fit import rotation_angles
from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, extent, smoothed
from teachpath.learning.settings import LearningSettings
from teachpath.lengths import describe_length
from teachpath.nurbs import Curve, unit_quaternions
from teachpath.records import Array, LearnedPath, Trajectory

STATIONS = 100  # at equal arc length
SAME_PLACE = 1e-9  # m
MIN_LENGTH = 0.01  # m, of a path; planning follows no shorter one
SAME_TURN = 1e-7  # rad, what rounding leaves of an angle


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
        is_base: whether the version begins and ends there already, and stays as it is.
    """

    curve: Curve
    orientation: Curve | None
    spread: Array
    demonstrations: int
    places: int
    extrapolates: str
    note: str
    is_base: bool


def adapt(
    path: LearnedPath,
    learned: Curve,
    members: Sequence[Trajectory],
    others: Sequence[Trajectory],
    target: Target,
    settings: LearningSettings,
) -> AdaptedPath:
    """Adapt a version of a learned path to another start and goal.

    The path is predicted from the shapes of all demonstrations that do the task in the same way, wherever (see
    `kriged_shapes.py`), and its orientations from theirs. With its own ends the version stays as it is.

    Args:
        path: the version.
        learned: the path as it was learned, before any edit or adaptation.
        members: demonstrations that it was learned from.
        others: further demonstrations of the task, of the same way or of others.
        target: where the new path begins and ends.
        settings: of the run that learned the path.

    Raises:
        UnusableInput: start and goal are so near that no path is left between them, or an orientation is asked for and
            none was learned.
        LearningFailed: the orientations cannot be followed within `turn_bound`.
    """
    model, alike, places = course_model(path, learned, members, others, settings)
    u = even_parameters(path.curve, STATIONS)
    found = model.predict(target.start, target.goal)
    _check_length(found, target)
    bound = settings.bound_for(extent(found.path))
    curve, orientation, missed = path.curve, path.orientation, 0.0
    if not (is_base := _is_own(path, target)):
        displacements = found.path - model.version
        curve, missed = displaced(path.curve, u, displacements, bound, settings.most_control_points)
        closeness = model.closeness(target.start, target.goal)
        orientation = adapted_orientation(path, alike, closeness, target, settings)
    note = _note(found, len(alike), places)
    if missed > bound:
        note += f"; {len(curve.control_points)} control points follow it within {describe_length(missed, up=True)} only"
    return AdaptedPath(curve, orientation, 2 * found.deviation, len(alike), places, found.extrapolates, note, is_base)


def course_model(
    path: LearnedPath,
    learned: Curve,
    members: Sequence[Trajectory],
    others: Sequence[Trajectory],
    settings: LearningSettings,
) -> tuple[CourseModel, list[Trajectory], int]:
    """Return what predicts the course of a version, the demonstrations that it rests on, and at how many places.

    The arguments are those of `adapt`.
    """
    alike, courses = _same_way(learned, members, others, settings)
    version = path.curve(even_parameters(path.curve, STATIONS))
    model = CourseModel(KrigedShapes(courses), learned(even_parameters(learned, STATIONS)), version)
    places = end_groups(courses, min_separation=settings.min_separation, length=float(arc_lengths(version)[-1]))
    return model, alike, int(places.max())


def _is_own(path: LearnedPath, target: Target) -> bool:
    """Tell whether a version begins and ends as it is asked to already."""
    ends = path.curve(np.array([0.0, 1.0]))
    if not np.allclose(ends, [target.start, target.goal], rtol=0.0, atol=SAME_PLACE):
        return False
    asked = [target.start_orientation, target.goal_orientation]
    if path.orientation is None or all(wanted is None for wanted in asked):
        return all(wanted is None for wanted in asked)
    own = unit_quaternions(path.orientation, np.array([0.0, 1.0]))
    wanted = np.array([end if ask is None else ask for end, ask in zip(own, asked, strict=True)])
    return bool(rotation_angles(own, wanted).max() <= SAME_TURN)


def _same_way(
    learned: Curve, members: Sequence[Trajectory], others: Sequence[Trajectory], settings: LearningSettings
) -> tuple[list[Trajectory], Array]:
    """Return the members and the others that take the same way, and their courses (m, 100, 3) [m]."""
    everyone = [*members, *others]
    courses = np.array([at_equal_arc_length(smoothed(trajectory), STATIONS) for trajectory in everyone])
    ways = labels_of_ways(courses, learned(0.0), learned(1.0), min_separation=settings.min_separation)
    alike = ways == ways[0]
    alike[: len(members)] = True
    return [everyone[number] for number in np.flatnonzero(alike)], courses[alike]


def _check_length(found: Prediction, target: Target) -> None:
    length = float(arc_lengths(found.path)[-1])
    if length < MIN_LENGTH:
        apart = describe_length(float(np.linalg.norm(target.goal - target.start)))
        raise UnusableInput(
            f"start and goal are {apart} apart, and the path between them would be {describe_length(length)} long, the "
            f"shortest followed is {describe_length(MIN_LENGTH)}; take the goal farther away"
        )


def _note(found: Prediction, demonstrations: int, places: int) -> str:
    if places == 1:
        return "shown at one place only: the shape is kept, and how it changes with the place is not known"
    if found.extrapolates:
        return f"beyond what was shown: {found.extrapolates}"
    widest = 2 * float(found.deviation.max())
    return (
        f"by {demonstrations} demonstrations at {places} places; one between these ends would lie within "
        f"{describe_length(widest)} of it nineteen times of twenty"
    )
