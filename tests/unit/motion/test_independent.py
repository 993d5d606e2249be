"""Plans of random paths, judged by an independent checker; `make bench` judges a hundred."""

import pytest

from teachpath.motion.plan import plan
from tests.bench.checker import judge
from tests.bench.random_plans import random_case, streamed
from tests.unit.motion.ways import learned

ACCEPTED = (3, 4)


@pytest.mark.parametrize("seed", ACCEPTED)
def test_an_accepted_plan_keeps_everything_when_it_is_streamed(seed: int) -> None:
    curve, scene = random_case(seed)
    made = plan(learned(curve), scene)
    found = judge(streamed(made), curve, scene, every=25)
    assert max(found.position, found.speed, found.acceleration, found.jerk) <= 1.0
    assert found.off_path <= 1e-4
    assert found.clearance >= made.certificate.clearance.value - 1e-3


def test_the_checker_notices_what_is_wrong() -> None:
    curve, scene = random_case(ACCEPTED[0])
    sent = streamed(plan(learned(curve), scene))
    sent[len(sent) // 2 :, 0] += 2e-3
    found = judge(sent, curve, scene, every=999)
    assert found.jerk > 1.0
    assert found.off_path > 1e-4
