"""Torques at any moment of a motion keep within the bounds that are computed from its setpoints."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.motion.arm.dynamics import Dynamics
from teachpath.motion.arm.model import Arm, Payload
from teachpath.motion.timing.constant_jerk import ConstantJerkMotion
from teachpath.records import Shape

ARM = Arm.of_variant()
DT = 0.004
BLOCK = Shape("block", "box", (0.08, 0.08, 0.08), (0.0, 0.0, 0.0))


def swing(rng: np.random.Generator) -> ConstantJerkMotion:
    """Return a random motion from rest to rest, about as fast as a live hand leads."""
    begin = rng.uniform(ARM.limits.lower, ARM.limits.upper)
    end, periods = begin + rng.uniform(-0.15, 0.15, 6), int(rng.integers(60, 125))
    phase = 2 * np.pi * np.arange(periods + 1) / periods
    return ConstantJerkMotion.near(
        np.array([begin, *np.zeros((2, 6))]), np.sin(phase)[:, None] * (end - begin), end, DT
    )


def within(motion: ConstantJerkMotion, share: float) -> np.ndarray:
    """Return positions, velocities and accelerations (3, n, 6) at a share of every period."""
    p, v, a = np.moveaxis(motion.states[:-1], 1, 0)
    t, j = share * motion.period, motion.jerks
    return np.array([p + v * t + a * t**2 / 2 + j * t**3 / 6, v + a * t + j * t**2 / 2, a + j * t])


@pytest.mark.parametrize("payload", [0.0, 2.0, 5.0])
@pytest.mark.parametrize("carried", [None, BLOCK])
def test_no_torque_between_setpoints_exceeds_its_bound_and_the_bound_is_near(
    payload: float, carried: Shape | None
) -> None:
    arm = replace(ARM, payload=Payload(payload, (0.02, 0.03, 0.1)))
    dynamics, rng, excess = Dynamics(arm, carried), np.random.default_rng(7), []
    for _ in range(12):
        motion = swing(rng)
        torques = np.array([np.abs(dynamics.torques(*within(motion, share))) for share in (0.0, 0.3, 0.6, 0.9)])
        for stride in (7, 1):
            bounds = dynamics.motion_bounds(motion.states, motion.turns(), motion.period, stride)
            assert np.all(torques <= np.repeat(bounds, stride, axis=0)[: len(motion)] + 1e-9)
        excess.append((bounds.max(axis=0) - torques.max(axis=(0, 1))) / arm.limits.torque)
    assert np.median(excess, axis=0).max() < 0.35
