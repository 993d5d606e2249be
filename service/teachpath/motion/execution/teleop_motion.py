"""Motions to rest of a live hand: from a state of the joints to a configuration, within all limits (Ruckig)."""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np
from ruckig import InputParameter, Result, Ruckig, RuckigError, Trajectory

from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import difference_speeds

State = tuple[Array, Array, Array]  # position, velocity and acceleration (6,)
Motion: TypeAlias = Trajectory

MAX_SAMPLE_STEP: Final = 0.03  # [rad] between two configurations that are checked
MAX_TRIALS: Final = 6  # of a motion, each with slower joints than the one before, until the tool keeps its limit
TOOL_SPEED_SHARE: Final = 0.99  # of the tool's limit that a motion may use
SLOWDOWN_SAFETY: Final = 0.97  # factor on the joints' speeds of the next trial
MIN_JOINT_SPEED: Final = 1e-3  # [rad/s] of a trial


class MotionToRest:
    """Computes the fastest motions to rest.

    Args:
        limits: of joints and tool.
        arm: that moves.
        period: between two setpoints [s].
    """

    def __init__(self, limits: MotionLimits, arm: Arm, period: float) -> None:
        self._limits = limits
        self._arm = arm
        self._period = period
        self._ruckig = Ruckig(6)

    def __call__(self, state: State, goal: Array) -> Motion | None:
        """Return a motion from a state to rest at `goal` (6,); None where none was found that keeps the limits."""
        inputs = InputParameter(6)
        inputs.current_position, inputs.current_velocity, inputs.current_acceleration = (v.tolist() for v in state)
        inputs.target_position = goal.tolist()
        inputs.max_velocity = self._limits.speed.tolist()
        inputs.max_acceleration = self._limits.acceleration.tolist()
        inputs.max_jerk = self._limits.jerk.tolist()
        for _ in range(MAX_TRIALS):
            run = Motion(6)
            try:
                result = self._ruckig.calculate(inputs, run)
            except RuckigError:
                return None
            if result != Result.Working or run.duration <= 0.0:
                return None
            slower = self._slower_joints(state, run)
            if slower is None:
                return run
            inputs.max_velocity = slower.tolist()
        return None

    def _slower_joints(self, state: State, run: Motion) -> Array | None:
        """Return the joints' speeds (6,) for the next trial; None where setpoints of `run` keep the tool's limit."""
        limit = TOOL_SPEED_SHARE * self._limits.tool_speed
        if np.isinf(limit):
            return None
        count = int(np.ceil(run.duration / self._period))
        setpoints = np.array([state[0], *(state_at(run, (k + 1) * self._period)[0] for k in range(count))])
        max_speed = float(difference_speeds(setpoints, 1.0 / self._period, self._arm).max())
        if max_speed <= limit:
            return None
        used = np.abs(np.diff(setpoints, axis=0)).max(axis=0) / self._period
        return np.asarray(np.maximum(used * (SLOWDOWN_SAFETY * limit / max_speed), MIN_JOINT_SPEED))


def state_at(run: Motion, t: float) -> State:
    """Return position, velocity and acceleration (6,) of a motion at time `t` [s], or at its end."""
    position, velocity, acceleration = run.at_time(min(t, run.duration))[:3]
    return np.array(position), np.array(velocity), np.array(acceleration)


def sampled(run: Motion) -> Array:
    """Return configurations (n, 6) of a motion, no two neighbours farther apart than `MAX_SAMPLE_STEP`."""
    times = np.linspace(0.0, run.duration, 33)[1:]
    fine = np.array([run.at_time(float(t))[0] for t in times])
    kept, last = [], fine[0]
    for k, q in enumerate(fine):
        if k == len(fine) - 1 or np.abs(fine[k + 1] - last).max() > MAX_SAMPLE_STEP:
            kept.append(q)
            last = q
    return np.array(kept)
