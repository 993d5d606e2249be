"""The course of a version between other ends: as kriged, as learned near its own ends, and as edited."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teachpath.learning.adaptation.kriged_shapes import KrigedShapes, Prediction
from teachpath.learning.resampling import arc_lengths
from teachpath.records import Array, Matrix

SAME_CHORD = (
    0.02  # of the length: a chord that differs by this little is that of the learned path, within a hand's scatter
)


@dataclass(frozen=True, eq=False)
class AdaptationModel:
    """What a course between other ends is computed from: the numbers of a `CourseModel`, for programs beside this one.

    With the chord c from start a to goal b, its horizontal length D and direction y, and at shares u of the arc length,
    the course is a + u c + D^0.8 sum_i w_i (R(y - yaw_i) s_i + s_i) / 2 + closeness * own + similarity * edits. The
    weights w, and a multiplier, are `inverse` times the covariances of (D, y) with the demonstrations, and 1.

    Attributes:
        turns: False for closed or vertical paths, whose shapes s_i are added as they are, without D and R.
        shapes: of each demonstration (n, 3), in the axes of the world.
        chords: of each demonstration (3,) [m], with its D and y.
        length: of a typical demonstration [m].
        places: at how many different starts or goals they were shown.
        inverse: of the kriging system.
        variance: (n,) per unit of scale and of kriging variance; None after one demonstration.
        learned: (n, 3) [m] the path as it was learned.
        own: (n, 3) [m] what it has beside the prediction for its ends.
        version: (n, 3) [m] the version that is adapted.
        edits: (n, 3) [m] what it has beside the adapted learned path.
    """

    turns: bool
    shapes: tuple[Matrix, ...]
    chords: Matrix
    length: float
    places: int
    inverse: Matrix
    variance: Array | None
    learned: Matrix
    own: Matrix
    version: Matrix
    edits: Matrix


@dataclass(frozen=True, eq=False)
class CourseModel:
    """Predicts the course of a version of a path between any start and goal.

    Between the ends of the version it gives the version itself. What the learned path has beside the prediction for its
    own ends counts only for nearly the same chord from start to goal; edits count as far as shapes are alike.

    Attributes:
        shapes: of all demonstrations that do the task in the same way.
        learned: (n, 3) [m] the path as it was learned, at equal arc lengths.
        version: (n, 3) [m] the version to adapt, likewise.
    """

    shapes: KrigedShapes
    learned: Array
    version: Array

    def predict(self, start: Array, goal: Array) -> Prediction:
        """Predict the course from a start to a goal (3,) [m]."""
        found = self._without_edits(start, goal)
        ends = (self.version[0], self.version[-1])
        path = found.path + self.shapes.similarity(ends, (start, goal)) * self.edits
        path[[0, -1]] = start, goal
        return replace(found, path=path)

    @property
    def own(self) -> Array:
        """What the learned path has beside the prediction for its ends: (n, 3) [m]."""
        return self.learned - self.shapes.predict(self.learned[0], self.learned[-1]).path

    @property
    def edits(self) -> Array:
        """What the version has beside the adapted learned path: (n, 3) [m]."""
        return self.version - self._without_edits(self.version[0], self.version[-1]).path

    def export(self, places: int) -> AdaptationModel:
        """Return the numbers that a prediction needs, learned at so many different starts or goals."""
        shapes = self.shapes
        return AdaptationModel(
            shapes.turns,
            tuple(shapes.in_world),
            np.asarray(shapes.chords, dtype=np.float64).reshape(-1, 3),
            shapes.length,
            places,
            np.asarray(shapes.inverse, dtype=np.float64).reshape(len(shapes.inverse), -1),
            shapes.variance,
            self.learned,
            self.own,
            self.version,
            self.edits,
        )

    def closeness(self, start: Array, goal: Array) -> float:
        """Return how near, 0 to 1, a chord is to that of the learned path; 1 when it is the same."""
        difference = float(np.linalg.norm(goal - start - (self.learned[-1] - self.learned[0])))
        return float(np.exp(-((difference / (SAME_CHORD * arc_lengths(self.learned)[-1])) ** 2) / 2))

    def _without_edits(self, start: Array, goal: Array) -> Prediction:
        found = self.shapes.predict(start, goal)
        return replace(found, path=found.path + self.closeness(start, goal) * self.own)
