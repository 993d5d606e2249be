"""A motion whose numbers are all different, for the tests of formats."""

import numpy as np

from teachpath.records import SampledMotion

JOINTS = tuple(f"joint {number}" for number in range(1, 7))


def a_motion(count: int = 30, rate: float = 70.0) -> SampledMotion:
    positions, velocities, accelerations = np.random.default_rng(5).normal(size=(3, count, 6))
    notes = ("Plan p.", "Not covered: another arm, 1 kg besides.")
    return SampledMotion("p", 1_700_000_000_123_456_789, notes, JOINTS, rate, np.arange(count) / rate,
                         positions, velocities, accelerations)  # fmt: skip
