"""Orientations along an adapted path: the mean of all demonstrations of the way, mended at both ends."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableInput
from teachpath.learning.adaptation.even_parameters import even_parameters
from teachpath.learning.adaptation.target import Target
from teachpath.learning.fitting.orientation_fit import fit_orientations, mean_orientations
from teachpath.learning.resampling import sign_aligned
from teachpath.learning.settings import LearningSettings
from teachpath.nurbs import Curve, unit_quaternions
from teachpath.records import Array, LearnedPath, Trajectory


def adapted_orientation(
    path: LearnedPath,
    shown: Sequence[Trajectory],
    closeness: float,
    target: Target,
    settings: LearningSettings,
) -> Curve | None:
    """Return the orientations between the ones that are asked for at the ends; as learned where none is asked for.

    The mean is taken in the world, because a hand does not turn with the direction in which it carries.

    Args:
        path: the version that is adapted.
        shown: demonstrations of its way; those without orientations are left out.
        closeness: how near the new ends are to those of the learned path, 0 to 1, and so how much its own orientations
            count instead of the mean.
        target: the ends.
        settings: `turn_bound` and `most_control_points`.

    Raises:
        UnusableInput: an orientation is asked for and none was learned.
        LearningFailed: the orientations cannot be followed within `turn_bound`.
    """
    asked = (target.start_orientation, target.goal_orientation)
    if all(wanted is None for wanted in asked):
        return path.orientation
    if path.orientation is None:
        raise UnusableInput("this path has learned no orientations; leave them out of start and goal")
    oriented = [trajectory for trajectory in shown if trajectory.orientations is not None]
    sampled = partial(_mended, path.curve, path.orientation, oriented, closeness, asked)
    return fit_orientations(path.cluster, sampled, path.orientation.degree, settings)[0]


def _mended(
    curve: Curve,
    orientation: Curve,
    shown: Sequence[Trajectory],
    closeness: float,
    asked: tuple[Array | None, Array | None],
    count: int,
) -> tuple[Array, Array]:
    """Return orientations (count, 4) at equal arc lengths that end as asked for, and their parameters (count,)."""
    u = even_parameters(curve, count)
    own = unit_quaternions(orientation, u)
    mean = mean_orientations(shown, count)
    assert mean is not None
    between = _rotations(mean)
    between = Rotation.from_rotvec(closeness * (_rotations(own) * between.inv()).as_rotvec()) * between
    wanted = [end if ask is None else ask for end, ask in zip(own[[0, -1]], asked, strict=True)]
    mends = (_rotations(np.array(wanted)) * between[[0, -1]].inv()).as_rotvec()
    share = np.linspace(0.0, 1.0, len(u))[:, None]
    turned = Rotation.from_rotvec((1 - share) * mends[0] + share * mends[1]) * between
    return sign_aligned(np.asarray(turned.as_quat(scalar_first=True))), u


def _rotations(quaternions: Array) -> Rotation:
    return Rotation.from_quat(quaternions, scalar_first=True)
