"""From demonstrations to learned paths: clustering, selection of the consistent ones, NURBS fitting."""

from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings

__all__ = ["LearningSettings", "learn"]
