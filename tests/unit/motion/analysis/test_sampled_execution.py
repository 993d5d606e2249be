"""What an arm was sent, at even instants."""

import numpy as np
import pytest

from teachpath.errors import UnusableRecording
from teachpath.motion.analysis.sampled_execution import recorded_duration, sample_setpoints
from teachpath.records import Setpoint

PERIOD_NS = 4_000_000
JOINTS = tuple("abcdef")


def setpoints(count: int) -> list[Setpoint]:
    """A swing of all joints, each with another amplitude."""
    amplitudes = np.arange(1.0, 7.0) / 10
    times = PERIOD_NS / 1e9 * np.arange(count)
    return [
        Setpoint(k, 5_000 + k * PERIOD_NS, 0, amplitudes * np.sin(3 * t), amplitudes * 3 * np.cos(3 * t),
                 -amplitudes * 9 * np.sin(3 * t), False, "e")
        for k, t in enumerate(times)
    ]  # fmt: skip


def test_at_its_own_instants_every_setpoint_is_there() -> None:
    sent = setpoints(200)
    motion = sample_setpoints([*sent[:50], sent[49], *sent[50:]], 250.0, "e", (), JOINTS)  # one of them recorded twice
    np.testing.assert_allclose(motion.positions, [s.position for s in sent], rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion.velocities, [s.velocity for s in sent], rtol=0, atol=1e-9)
    np.testing.assert_allclose(motion.accelerations, [s.acceleration for s in sent], rtol=0, atol=1e-9)


def test_between_them_it_goes_as_the_arm_went() -> None:
    sent = setpoints(200)
    motion = sample_setpoints(sent, 1000.0, "e", (), JOINTS)
    assert motion.joint_names == JOINTS
    assert motion.times[-1] == pytest.approx(recorded_duration(sent), abs=1e-9)
    swing = np.arange(1.0, 7.0) / 10 * np.sin(3 * motion.times)[:, None]
    np.testing.assert_allclose(motion.positions, swing, rtol=0, atol=1e-9)


def test_what_never_moved_is_a_sentence() -> None:
    with pytest.raises(UnusableRecording, match="e has 3 recorded setpoints, needs 4"):
        sample_setpoints(setpoints(3), 100.0, "e", (), JOINTS)
    assert recorded_duration([]) == 0.0
