import numpy as np

from teachpath.recording.phases import TransportSpan
from teachpath.recording.posture import joint_count, shown_joints
from teachpath.records import Sample, SampleColumns
from tests.unit.recording.hands import demonstration

CUT = TransportSpan(20, 70)  # of `demonstration`


def led(samples: list[Sample]) -> list[Sample]:
    """Let each joint follow the hand's x, which rises evenly while the object is carried."""
    return [s._replace(joints=tuple(k * s.position[0] for k in range(1, 7))) for s in samples]


def test_joints_are_at_even_shares_of_the_way_however_fast_it_was_gone() -> None:
    samples = led(demonstration())
    slow = [s._replace(sequence=2 * s.sequence) for s in samples[:40]]  # and it rests in the middle
    rest = [slow[-1]._replace(sequence=80 + k) for k in range(1, 30)]
    after = [s._replace(sequence=s.sequence + 100) for s in samples[40:]]
    joints = shown_joints([*slow, *rest, *after], TransportSpan(20, 70 + len(rest)))
    x = np.linspace(0.5, 0.9, len(joints))
    np.testing.assert_allclose(joints, x[:, None] * np.arange(1, 7), atol=1e-9)


def test_samples_that_are_not_learned_from_show_no_joints() -> None:
    samples = led(demonstration())
    jumped = samples[40]._replace(position=(5.0, 5.0, 5.0), joints=(9.0,) * 6)
    spoiled = [*samples[:40], jumped, *samples[41:]]
    joints = shown_joints(spoiled, CUT, [jumped.sequence])
    np.testing.assert_allclose(joints, shown_joints(samples, CUT), atol=1e-9)


def test_an_arm_shows_a_task_only_where_all_its_samples_have_its_joints() -> None:
    hand, arm = demonstration(), led(demonstration())
    counts = [joint_count(SampleColumns.of(each)) for each in (hand, arm, [*arm[:30], *hand[30:]])]
    assert counts == [0, 6, 0]
