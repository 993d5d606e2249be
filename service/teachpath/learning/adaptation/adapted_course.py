"""The course of a version between other ends: as kriged, as learned near its own ends, and as edited."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teachpath.learning.adaptation.kriged_shapes import KrigedShapes, Prediction
from teachpath.learning.resampling import arc_lengths
from teachpath.records import Array

SAME_CHORD = (
    0.02  # of the length: a chord that differs by this little is that of the learned path, within a hand's scatter
)


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
        edits = self.version - self._without_edits(*ends).path
        path = found.path + self.shapes.similarity(ends, (start, goal)) * edits
        path[[0, -1]] = start, goal
        return replace(found, path=path)

    def closeness(self, start: Array, goal: Array) -> float:
        """Return how near, 0 to 1, a chord is to that of the learned path; 1 when it is the same."""
        difference = float(np.linalg.norm(goal - start - (self.learned[-1] - self.learned[0])))
        return float(np.exp(-((difference / (SAME_CHORD * arc_lengths(self.learned)[-1])) ** 2) / 2))

    def _without_edits(self, start: Array, goal: Array) -> Prediction:
        found = self.shapes.predict(start, goal)
        own = self.learned - self.shapes.predict(self.learned[0], self.learned[-1]).path
        return replace(found, path=found.path + self.closeness(start, goal) * own)
