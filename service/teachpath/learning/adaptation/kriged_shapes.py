"""Prediction of a path between a start and a goal that were not shown, from demonstrations between others.

The shape of a demonstration is what it has beside the straight line from its start to its goal, per power of its
horizontal distance. Shapes between such ends are predicted by ordinary kriging over direction and distance; the
prediction is the mean of one with shapes turned with the direction and one with shapes kept in the world.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teachpath.lengths import describe_length
from teachpath.records import Array

DISTANCE_POWER = 0.8  # of the horizontal distance, by which the height and width of a shape grow
DISTANCE_SCALE = 0.7  # of the logarithm of a ratio of distances, for the covariance
NUGGET = 1.0  # variance of the hand itself, relative to that between directions and distances
MIN_DISTANCE_SHARE = 0.25  # of the length of the path; with nearer ends it is closed or vertical and is not turned
MIN_DISTANCE = 1e-6  # m, for its logarithm
MAX_DISTANCE_RATIO = 1.5  # to the shown distances, beyond which a prediction extrapolates
MAX_RISE_SHARE = 0.25  # of the largest shown distance, by which a goal may lie higher or lower than shown, likewise
MAX_TURN = np.radians(60)  # from the nearest shown direction, likewise
SINGLE_SPREAD = 0.12  # standard deviation after one demonstration, as share of the distance


@dataclass(frozen=True, eq=False)
class Prediction:
    """A predicted path.

    Attributes:
        path: (n, 3) [m] at equal shares of the arc length, from the start to the goal exactly.
        deviation: (n,) [m] standard deviation of a demonstration between these ends from it.
        extrapolates: what is beyond the shown range, in words; empty within it.
    """

    path: Array
    deviation: Array
    extrapolates: str


class KrigedShapes:
    """The shapes of m demonstrations, and their covariance.

    Args:
        paths: (m, n, 3) [m] at equal shares of the arc length.

    Attributes:
        chords: (m, 3) [m] from the starts to the goals.
        length: of a typical path [m].
        turns: whether shapes turn and grow with the chord from start to goal; not on closed or vertical paths.
        distances: (m,) [m] horizontal length of the chords.
        yaws: (m,) [rad] direction of the chords.
        in_world: (m, n, 3) shapes, in the axes of the world.
        inverse: (m + 1, m + 1) of the kriging system.
        variance: (n,) per unit of scale and of kriging variance, from leaving each shape out in turn; None for one.
    """

    def __init__(self, paths: Array) -> None:
        starts, chords = paths[:, 0], paths[:, -1] - paths[:, 0]
        self._starts = starts
        self.chords: Array = chords
        self._share = np.linspace(0.0, 1.0, paths.shape[1])
        self.distances: Array = np.linalg.norm(chords[:, :2], axis=1)
        self.yaws: Array = np.arctan2(chords[:, 1], chords[:, 0])
        lengths = np.linalg.norm(np.diff(paths, axis=1), axis=2).sum(axis=1)
        self.length: float = float(np.median(lengths))
        self.turns: bool = bool(np.all(self.distances > MIN_DISTANCE_SHARE * lengths))
        residuals = paths - starts[:, None] - self._share[:, None] * chords[:, None]
        scaled = residuals / self._scale(self.distances)[:, None, None]
        self.in_world: Array = scaled
        self._turned = np.einsum("mji,mnj->mni", _rotations(self.yaws), scaled)
        m = len(paths)
        system = np.ones((m + 1, m + 1))
        system[:m, :m] = self._covariances(self.yaws[:, None], self.distances[:, None]) + NUGGET * np.eye(m)
        system[m, m] = 0.0
        self.inverse: Array = np.asarray(np.linalg.inv(system), np.float64)
        self.variance: Array | None = self._left_out_variance()

    def predict(self, start: Array, goal: Array) -> Prediction:
        """Predict the path from a start to a goal (3,) [m]."""
        chord = goal - start
        distance, yaw = _chord(chord)
        known = np.append(self._covariances(yaw, distance), 1.0)
        solved = self.inverse @ known
        weights = solved[:-1]
        shape = self._world_shapes(yaw) if self.turns else self.in_world
        scale = float(self._scale(np.array(distance)))
        path = start + self._share[:, None] * chord + scale * np.tensordot(weights, shape, 1)
        path[-1] = goal
        if self.variance is None:
            deviation = SINGLE_SPREAD * float(np.linalg.norm(chord)) * np.sin(np.pi * self._share)
        else:
            unexplained = max(1.0 + NUGGET - float(known @ solved), 0.0)
            deviation = scale * np.sqrt(unexplained * self.variance)
        return Prediction(path, deviation, self._beyond(chord))

    def moved(self, number: int, positions: Array, share: Array, other: int) -> Array:
        """Bring a demonstration to the ends of another one; its shape turns and grows with the chord.

        Args:
            number: of the demonstration.
            positions: (n, 3) [m] of it.
            share: (n,) of its arc length at these.
            other: number of the demonstration whose ends it is brought to.
        """
        along = share[:, None]
        residuals = positions - self._starts[number] - along * self.chords[number]
        if self.turns:
            turn = _rotations(np.array([self.yaws[other] - self.yaws[number]]))[0]
            residuals = residuals @ turn.T * (self.distances[other] / self.distances[number]) ** DISTANCE_POWER
        return np.asarray(self._starts[other] + along * self.chords[other] + residuals)

    def _world_shapes(self, yaw: float) -> Array:
        """Return the mean of turned and unturned shapes for a direction (m, n, 3)."""
        return np.asarray((self._turned @ _rotations(np.array([yaw]))[0].T + self.in_world) / 2)

    def _scale(self, distance: Array) -> Array:
        return distance**DISTANCE_POWER if self.turns else np.ones_like(distance)

    def similarity(self, one: tuple[Array, Array], other: tuple[Array, Array]) -> float:
        """Return the correlation, 0 to 1, of the shapes between two pairs of ends; 1 when their chords are equal."""
        if not self.turns:
            return 1.0
        (distance, yaw), (distance_2, yaw_2) = _chord(one[1] - one[0]), _chord(other[1] - other[0])
        return float(_covariances(np.array(yaw), np.array(distance), np.array(yaw_2), np.array(distance_2)))

    def _covariances(self, yaw: Array | float, distance: Array | float) -> Array:
        """Return the covariance of ends in this direction and distance with those of the demonstrations."""
        if not self.turns:
            return np.ones(np.broadcast(yaw, self.yaws).shape)
        return _covariances(np.asarray(yaw), np.asarray(distance), self.yaws, self.distances)

    def _left_out_variance(self) -> Array | None:
        """Return the variance (n,) per unit of scale and of kriging variance, from leaving each shape out in turn."""
        m = len(self.distances)
        if m < 2:
            return None
        own = np.diag(self.inverse)[:m]
        errors = np.tensordot(self.inverse[:m, :m], self.in_world, 1) / own[:, None, None]
        if self.turns:
            turned = np.tensordot(self.inverse[:m, :m], self._turned, 1) / own[:, None, None]
            errors = (errors + np.einsum("mij,mnj->mni", _rotations(self.yaws), turned)) / 2
        freedom = 3 * (m - 1)  # the variance of Student's distribution, because few errors tell the variance badly
        return np.asarray((np.square(errors).sum(axis=2) * own[:, None]).mean(axis=0) * freedom / (freedom - 2))

    def _beyond(self, chord: Array) -> str:
        if not self.turns:
            apart = float(np.linalg.norm(self.chords - chord, axis=1).min())
            if apart <= MIN_DISTANCE_SHARE * self.length:
                return ""
            return f"from start to goal it is {describe_length(apart)} otherwise than shown"
        distance, yaw = _chord(chord)
        nearest, farthest = float(self.distances.min()), float(self.distances.max())
        if not nearest / MAX_DISTANCE_RATIO <= distance <= farthest * MAX_DISTANCE_RATIO:
            shown = _span(nearest, farthest)
            return f"start and goal are {describe_length(distance)} apart on the level, shown were {shown}"
        rises, allowed = self.chords[:, 2], MAX_RISE_SHARE * farthest
        if not rises.min() - allowed <= chord[2] <= rises.max() + allowed:
            least, most = _rise(float(rises.min())), _rise(float(rises.max()))
            shown = least if least == most else f"{least} to {most}"
            return f"the goal is {_rise(float(chord[2]))} than the start, shown were {shown}"
        turns = np.abs((yaw - self.yaws + np.pi) % (2 * np.pi) - np.pi)
        if turns.min() > MAX_TURN:
            return f"the direction is {np.degrees(turns.min()):.0f}° from the nearest one that was shown"
        return ""


def _chord(chord: Array) -> tuple[float, float]:
    """Return the horizontal distance [m] from a start to a goal and the direction [rad]."""
    x, y, _ = chord
    return float(np.hypot(x, y)), float(np.arctan2(y, x))


def _covariances(yaw: Array, distance: Array, yaw_2: Array, distance_2: Array) -> Array:
    turn = 2 * np.sin((yaw - yaw_2) / 2)
    ratio = np.log(np.maximum(distance, MIN_DISTANCE) / np.maximum(distance_2, MIN_DISTANCE)) / DISTANCE_SCALE
    return np.asarray(np.exp(-(turn**2) / 2 - ratio**2 / 2))


def _span(least: float, most: float) -> str:
    one, other = describe_length(least), describe_length(most)
    return one if one == other else f"{one} to {other}"


def _rise(height: float) -> str:
    return f"{describe_length(abs(height))} {'higher' if height >= 0 else 'lower'}"


def _rotations(yaws: Array) -> Array:
    """Return rotations about the vertical (m, 3, 3)."""
    cos, sin, zero = np.cos(yaws), np.sin(yaws), np.zeros_like(yaws)
    rows = [[cos, -sin, zero], [sin, cos, zero], [zero, zero, zero + 1]]
    return np.moveaxis(np.array(rows), 2, 0)
