"""What every learned result has to be, whatever it was learned from; and the settings that tests go through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teachpath.learning.settings import LearningSettings
from teachpath.records import Learned

PAPER_CLUSTERS = [{"1", "6", "8", "10", "12"}, {"2", "5", "11"}, {"3", "4", "7", "9"}]
PAPER = LearningSettings(mode="paper", threshold=0.08, repeats=0)
REPAIRED_SETTINGS = replace(PAPER, mode="repaired")
IN_EVERY_MODE = pytest.mark.parametrize(
    "settings", [LearningSettings(), PAPER, REPAIRED_SETTINGS], ids=["default", "paper", "repaired"]
)


def assert_usable(learned: Learned) -> None:
    """Nothing that leaves the room is NaN or infinite, and every record fits the others."""
    count = len(learned.demonstrations)
    assert learned.linkage.shape == (count - 1, 4)
    assert np.all(np.isfinite(learned.linkage))
    assert np.isfinite(learned.threshold)
    assert sorted(name for cluster in learned.clusters for name in cluster.members) == sorted(learned.demonstrations)
    assert [path.cluster for path in learned.paths] == [cluster.index for cluster in learned.clusters]
    for cluster in learned.clusters:
        assert tuple(score.demonstration for score in cluster.scores) == cluster.members
        assert [score.rank for score in cluster.scores] == list(range(1, len(cluster.members) + 1))
        assert np.all(np.isfinite([score.log_likelihood for score in cluster.scores]))
        assert np.all(np.isfinite(cluster.convergence))
        assert any(score.selected for score in cluster.scores)
        assert cluster.representative in cluster.members
        assert cluster.spread is not None
        assert np.all(np.isfinite(cluster.spread))
        for score in cluster.scores:
            assert all(np.isfinite(v) for v in (score.margin, score.z, score.stability) if v is not None)
    assert set(learned.inputs) == set(learned.demonstrations)
    for path in learned.paths:
        assert path.fit.frechet is not None
        measures = (
            path.fit.bound,
            path.fit.largest,
            path.fit.rms,
            path.fit.tube,
            path.fit.frechet,
            path.curve.length(),
        )
        assert np.all(np.isfinite(measures))
        assert len(path.curve.control_points) <= 60
