"""Motions of constant jerk in every period: what a player asks between setpoints is what was checked."""

import numpy as np
import pytest

from teachpath.motion.arm.model import Arm
from teachpath.motion.timing.constant_jerk import ConstantJerkMotion
from teachpath_client.driver.interpolation import Quintic, WayToRest

ARM = Arm.of_variant()
DT = 0.004
ROUNDING = 1.0 + 1e-6


class Sent:
    """A setpoint as a player reads it."""

    def __init__(self, motion: ConstantJerkMotion, row: int) -> None:
        self.position, self.velocity, self.acceleration = motion.states[row]
        self.nominal_ns = row * round(DT * 1e9)
        self.way_to_rest = motion.states[row + 1 :]


def wild(seed: int) -> ConstantJerkMotion:
    """Return a motion near a reference whose acceleration changes as it likes, from a state in full motion."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 120))
    reference = rng.normal(0.0, 5.0, (count + 1, 6))
    reference[-1] = 0.0
    return ConstantJerkMotion.near(rng.normal(0.0, 1.0, (3, 6)), reference, rng.normal(0.0, 1.0, 6), DT)


@pytest.mark.parametrize("seed", range(20))
def test_every_player_reads_the_same_motion_from_any_setpoint_on(seed: int) -> None:
    motion = wild(seed)
    scale = np.abs(motion.states[:, 0]).max()
    begin = int(np.random.default_rng(seed).integers(0, len(motion)))
    way = WayToRest(Sent(motion, begin), DT)
    for row in range(begin, len(motion)):
        piece = Quintic(Sent(motion, row), Sent(motion, row + 1))
        for t in DT * np.random.default_rng(row).random(3):
            p, v, a = motion.states[row]
            j = motion.jerks[row]
            here = p + v * t + a * t**2 / 2 + j * t**3 / 6
            np.testing.assert_allclose(piece(t)[0], here, rtol=0, atol=1e-12 * scale)
            np.testing.assert_allclose(way((row - begin) * DT + t)[0], here, rtol=0, atol=1e-12 * scale)


@pytest.mark.parametrize("seed", range(20))
def test_no_moment_passes_what_is_said_of_speed_acceleration_jerk_turns_and_range(seed: int) -> None:
    motion = wild(seed)
    limits = ARM.limits.motion
    t = np.linspace(0.0, DT, 41)[:, None, None]
    (p, v, a), j = np.moveaxis(motion.states[:-1], 1, 0), motion.jerks
    speeds, accelerations = v + a * t + j * t**2 / 2, a + j * t
    places = p + v * t + a * t**2 / 2 + j * t**3 / 6
    uses = [np.abs(each).max(axis=(0, 1)) for each in (speeds, accelerations)] + [np.abs(j).max(axis=0)]
    seen = np.max(
        [use / limit for use, limit in zip(uses, (limits.speed, limits.acceleration, limits.jerk), strict=True)], 0
    )
    assert np.all(seen <= motion.limit_uses(limits) * ROUNDING)
    np.testing.assert_allclose(seen, motion.limit_uses(limits), rtol=1e-3)
    assert np.all(np.abs(np.diff(places, axis=0)).sum(axis=0) <= motion.turns() * ROUNDING + 1e-12)
    assert np.all(places.max(axis=(0, 1)) <= motion.hull().max(axis=0) + 1e-9)
    assert np.all(places.min(axis=(0, 1)) >= motion.hull().min(axis=0) - 1e-9)


def test_a_motion_that_has_constant_jerks_already_stays_as_it_is() -> None:
    jerks = np.repeat([1.0, -1.0, -1.0, 1.0], 10)[:, None] * np.arange(1.0, 7.0)
    accelerations = np.concatenate([np.zeros((1, 6)), np.cumsum(jerks, axis=0) * DT])
    goal = 2.0 * np.arange(1.0, 7.0) * (10 * DT) ** 3  # with jerk J in four phases T it goes 2 J T^3
    motion = ConstantJerkMotion.near(np.zeros((3, 6)), accelerations, goal, DT)
    np.testing.assert_allclose(motion.jerks, jerks, atol=1e-6)
