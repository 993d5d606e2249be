"""The motion of a plan at even instants: the plan's own, from rest to rest."""

import numpy as np
import pytest

from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.sampled_plan import sample_plan
from teachpath.records import Plan

ARM = Arm.of_variant()


@pytest.mark.parametrize("rate", [1.0, 31.0, 250.0, 1000.0])
def test_the_samples_are_the_plan_s_own_motion_until_the_arm_rests(middle: Plan, rate: float) -> None:
    motion = sample_plan(middle, rate, ARM)
    trajectory = plan_trajectory(middle)
    np.testing.assert_array_equal(motion.positions, trajectory(motion.times)[:, :6])
    assert motion.times[-1] >= trajectory.duration > motion.times[-2]
    np.testing.assert_array_equal(motion.positions[-1], trajectory(np.array([trajectory.duration]))[0, :6])
    for moving in (motion.velocities, motion.accelerations):
        assert not moving[[0, -1]].any()


def test_speeds_and_accelerations_are_derivatives_and_keep_the_plan_s_limits(middle: Plan) -> None:
    rate = 2000.0
    motion = sample_plan(middle, rate, ARM)
    for values, slopes, limit in (
        (motion.positions, motion.velocities, middle.limits[0]),
        (motion.velocities, motion.accelerations, middle.limits[1]),
    ):
        difference = (values[2:] - values[:-2]) * rate / 2
        np.testing.assert_allclose(slopes[1:-1], difference, rtol=0, atol=1e-3 * limit.max())
        assert np.all(np.abs(slopes) <= limit * (1 + 1e-6))


def test_the_notes_say_what_was_proved_and_what_was_not(middle: Plan) -> None:
    notes = " ".join(sample_plan(middle, 10.0, ARM).notes)
    certificate = middle.certificate
    for said in (
        middle.id,
        certificate.digest[:16],
        ARM.name,
        "alone",
        "unless it is revoked",
        "Not covered: another arm",
    ):
        assert said in notes
    assert f"speed {certificate.velocity_use.value:.1%}" in notes
