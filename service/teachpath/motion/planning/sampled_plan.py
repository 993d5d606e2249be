"""The motion of a plan at even instants."""

from __future__ import annotations

import numpy as np

from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.plan_notes import plan_notes
from teachpath.records import Plan, SampledMotion


def sample_plan(plan: Plan, rate: float, arm: Arm) -> SampledMotion:
    """Return the motion of a plan along its path at full speed, at `rate` instants a second [Hz].

    The last instant is the first at or behind the end, where the arm rests.

    Args:
        plan: certified and signed for `arm`.
        rate: instants a second [Hz].
        arm: that the certificate is for.
    """
    trajectory = plan_trajectory(plan)
    count = int(np.ceil(trajectory.duration * rate)) + 1
    times = np.arange(count) / rate
    positions, velocities, accelerations = trajectory.derivatives(times)[:, :, :-1].transpose(1, 0, 2)
    resting = (times == 0.0) | (times >= trajectory.duration)
    velocities[resting] = accelerations[resting] = 0.0  # in the table they are as small as the integration of time
    signature = plan.certificate.signature
    issued_ns = signature.issued_ns if signature else 0
    return SampledMotion(
        plan.id, issued_ns, plan_notes(plan, arm), arm.limits.names, rate, times, positions, velocities, accelerations
    )
