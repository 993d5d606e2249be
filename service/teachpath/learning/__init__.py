"""From demonstrations to learned paths: clustering, selection of the consistent ones, NURBS fitting."""

from teachpath.learning.compare import compare
from teachpath.learning.cuts import dendrogram, recut
from teachpath.learning.learn import learn
from teachpath.learning.relearn import relearn
from teachpath.learning.settings import LearningSettings

__all__ = ["LearningSettings", "compare", "dendrogram", "learn", "recut", "relearn"]
