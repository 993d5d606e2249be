"""What a planning job reads: the joints of the most consistent demonstration that an arm showed."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.motion.arm.model import Arm
from teachpath.offline.planning_job import find_posture
from teachpath.records import Cluster, Demonstration, LearnedPath, Score
from tests.contract.rows import a_job, learned
from tests.unit.offline.takes import bare, record

ARM = Arm.of_variant()


def shown(store: Store, *, by_arm: bool, turn: float = 0.0) -> Demonstration:
    """Record a take whose joint 1 rises from `turn` to `turn` + 0.4 rad on the way, by an arm or by a hand."""
    samples = [
        s._replace(joints=(turn + s.position[0] - samples_start, *(0.1,) * 5) if by_arm else ())
        for samples_start in [bare()[20].position[0]]
        for s in bare()
    ]
    return record(store, samples)


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(StoreSettings(str(tmp_path)))


def path_of(store: Store, *scores: Score) -> LearnedPath:
    """Store a run with one cluster of these scores, and return its path."""
    members = tuple(score.demonstration for score in scores)
    cluster = Cluster(1, members, scores)
    store.add_job(a_job("learn-1", task="lift"))
    store.finish_learning("learn-1", replace(learned(), demonstrations=members, clusters=(cluster,)))
    run = store.newest_run("lift")
    assert run is not None
    return run.learned.paths[0]


def test_the_most_consistent_selected_demonstration_by_an_arm_counts(store: Store) -> None:
    rows = [shown(store, by_arm=k > 0, turn=0.5 * k) for k in range(4)]
    ranks = zip(rows, (1, 3, 2, 4), (True, True, True, False), strict=True)
    path = path_of(store, *(Score(row.id, 0.0, rank, selected) for row, rank, selected in ranks))
    posture = find_posture(store, "lift", path, ARM)
    assert posture is not None
    found = posture.read()
    assert found.demonstration == rows[2].id
    assert found.joints.shape[1] == 6
    # the noise of a few millimetres lengthens the way where it does not lead forward
    np.testing.assert_allclose(found.joints[:, 0], np.linspace(1.0, 1.4, len(found.joints)), atol=0.05)


def test_what_a_hand_or_an_arm_with_other_joints_showed_has_no_posture(store: Store) -> None:
    path = path_of(store, Score(shown(store, by_arm=False).id, 0.0, 1, selected=True))
    assert find_posture(store, "lift", path, ARM) is None


def test_a_path_that_was_not_learned_has_no_posture(store: Store) -> None:
    row = shown(store, by_arm=True)
    path = path_of(store, Score(row.id, 0.0, 1, selected=True))
    assert find_posture(store, "lift", replace(path, run=""), ARM) is None
