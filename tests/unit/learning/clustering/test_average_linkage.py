"""The compiled average linkage against scipy's, and that it can be cancelled."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.cluster.hierarchy import cophenet, is_valid_linkage, linkage
from scipy.spatial.distance import pdist

from teachpath.errors import Cancelled
from teachpath.learning.clustering.average_linkage import MAX_SCIPY_DEMONSTRATIONS, average_linkage


@pytest.mark.parametrize("count", [MAX_SCIPY_DEMONSTRATIONS + 1, 517])
def test_many_are_merged_as_scipy_merges_them(count: int) -> None:
    condensed = pdist(np.random.default_rng(count).normal(size=(count, 3))).astype(np.float32)
    ours, theirs = average_linkage(condensed, count), linkage(condensed.astype(np.float64), "average")
    assert is_valid_linkage(ours)
    np.testing.assert_allclose(ours[:, 2], theirs[:, 2], rtol=1e-5)
    np.testing.assert_allclose(cophenet(ours), cophenet(theirs), rtol=1e-5)
    np.testing.assert_array_equal(ours[:, 3], theirs[:, 3])


def test_the_distances_stay_as_they_are() -> None:
    condensed = pdist(np.random.default_rng(1).normal(size=(MAX_SCIPY_DEMONSTRATIONS + 1, 2))).astype(np.float32)
    before = condensed.copy()
    average_linkage(condensed, MAX_SCIPY_DEMONSTRATIONS + 1)
    np.testing.assert_array_equal(condensed, before)


def test_demonstrations_that_are_all_alike_are_merged_at_nought() -> None:
    count = MAX_SCIPY_DEMONSTRATIONS + 1
    merges = average_linkage(np.zeros(count * (count - 1) // 2, dtype=np.float32), count)
    assert is_valid_linkage(merges)
    assert not merges[:, 2].any()


def test_merging_can_be_cancelled_half_way() -> None:
    def cancel(fraction: float, _sentence: str) -> None:
        if fraction > 0.5:
            raise Cancelled("enough")

    condensed = pdist(np.random.default_rng(2).normal(size=(400, 2)))
    with pytest.raises(Cancelled):
        average_linkage(condensed, 400, cancel)
