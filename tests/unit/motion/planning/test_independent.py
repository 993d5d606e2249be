"""Plans of random paths, judged by an independent checker; `make bench` judges a hundred."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.motion.planning.plan import plan
from teachpath.records import Scene, Shape
from tests.plan_checker.checker import GRIP, LOWER_LIMITS, UPPER_LIMITS, Solids, frames, judge
from tests.plan_checker.exhaustive_search import configurations, search
from tests.plan_checker.random_cases import random_case, streamed
from tests.unit.motion.collision.solids import Surface
from tests.unit.motion.ways import learned

ACCEPTED_CASES = (3, 4)


@pytest.mark.parametrize("seed", ACCEPTED_CASES)
def test_an_accepted_plan_keeps_everything_when_it_is_streamed(seed: int) -> None:
    curve, scene = random_case(seed)
    made = plan(learned(curve), scene)
    found = judge(streamed(made), curve, scene, every=25)
    assert max(found.position, found.speed, found.acceleration, found.jerk) <= 1.0
    assert found.off_path <= 1e-4
    assert found.clearance >= made.certificate.clearance.value - 1e-3


def test_the_judge_of_refusals_knows_every_configuration_of_a_plan_and_what_blocks_it() -> None:
    curve, scene = random_case(ACCEPTED_CASES[0])
    made = plan(learned(curve), scene)
    for q in made.joints[:: len(made.joints) // 7]:
        pose = frames(q)[6]
        point = pose[:3, 3] + GRIP * pose[:3, 2]
        every = configurations(point, float(np.arctan2(pose[1, 0], pose[0, 0])))
        assert min(np.abs(other - q).max() for other in every) < 1e-6
    ball = Shape("ball in the way", "sphere", (0.03,), tuple(curve(np.zeros(1))[0]))
    assert not search(curve, replace(scene, obstacles=(ball,))).possible


def test_the_judge_puts_every_solid_where_the_simulated_arm_has_it() -> None:
    surface, bodies = Surface(), Solids(Scene("nothing"))
    for q in np.random.default_rng(1).uniform(LOWER_LIMITS, UPPER_LIMITS, (20, 6)):
        points, drawn = surface(q[None])[0], bodies.points(q)
        np.testing.assert_allclose(drawn.min(axis=0), points.min(axis=0), atol=2e-3)  # a round rim has finitely many
        np.testing.assert_allclose(drawn.max(axis=0), points.max(axis=0), atol=2e-3)


def test_the_checker_notices_what_is_wrong() -> None:
    curve, scene = random_case(ACCEPTED_CASES[0])
    sent = streamed(plan(learned(curve), scene))
    sent[len(sent) // 2 :, 0] += 2e-3
    found = judge(sent, curve, scene, every=999)
    assert found.jerk > 1.0
    assert found.off_path > 1e-4
