"""Advances plan time at a rate that the operator changes: override, hold, resume, reverse, within all limits.

The governor always executes a verified ramp: its setpoints, joined to those already sent, were checked one by one
against all limits, and it ends at a constant rate of at most 1, at which the plan is feasible. Another ramp replaces it
only after it was verified in the same way. So no command can break a limit or lead off the path, and nothing can fail
in mid-motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from ruckig import ControlInterface, InputParameter, Result, Ruckig, RuckigError, Trajectory

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing import kernels
from teachpath.motion.timing.joint_moves import straight_move
from teachpath.motion.timing.limit_margins import SYMMETRIC_MARGINS
from teachpath.motion.timing.ramp_search import find_ramp, shorten_ramp
from teachpath.motion.timing.timed_trajectory import TimedTrajectory

MIN_OVERRIDE: Final = 0.01  # a smaller override holds
MAX_RAMPS_PER_PERIOD: Final = 20  # ramps to another rate that are judged in one control period at most
MAX_SHORTER_RAMPS: Final = 20  # the same to the rate that the present ramp leads to
RUCKIG_MARGIN: Final = 1 + 1e-12  # factor on Ruckig's limits, so that rounding makes no ramp infeasible
DURATION_TOLERANCE: Final = 1e-6  # [s] between the closed form of a ramp and Ruckig's
MAX_REVERSE_RATE: Final = 0.96  # of the way back: a plan has its margins on the other side (see `limit_margins`)
MAX_STOP_RAMPS: Final = 12  # ramps to rest judged behind a setpoint at most
MAX_STOP_TIME: Final = 2.0  # s, of a ramp to rest; with none so short the present motion goes on for a while
STOP_JERK_SHARE: Final = 0.93  # of the jerk limit that a way to rest may use at its positions
STOP_LEADS: Final = (0, 1, 2, 4, 8, 16, 32, 64)  # periods for which it goes on
MAX_STOP_PERIODS: Final = 5000  # of a way to rest, where nothing but the end of the trajectory is one


@dataclass(frozen=True, slots=True)
class PathProgress:
    """How far the trajectory is done: length `s` [m], `rate` of plan time, whether at rest, and whether at its end."""

    s: float
    rate: float
    at_rest: bool
    finished: bool


@dataclass(frozen=True, eq=False)
class WayToRest:
    """How the arm comes to rest from the newest setpoint without another one.

    Attributes:
        positions: (n, 6) one control period apart, the first one period ahead [rad]; empty at rest.
        tau: plan time at which it rests [s].
    """

    positions: Array
    tau: float


class Governor:
    """Runs one timed trajectory from its beginning, where it is at rest.

    Args:
        dt: control period [s].
        override: share of the full speed, 0 to 1.
    """

    def __init__(self, trajectory: TimedTrajectory, dt: float, *, override: float = 1.0) -> None:
        self._table = trajectory.table
        self._step = trajectory.step
        self._end = trajectory.duration
        self._dt = dt
        limits = trajectory.limits
        self._limits = np.stack([limits.speed * dt, limits.acceleration * dt**2, limits.jerk * dt**3])
        # A player reads a way to rest between its positions too, where the jerk is a little larger than at them.
        self._stop_limits = self._limits * np.array([[1.0], [1.0], [STOP_JERK_SHARE]])
        # A planned motion keeps this share of the tool's limit in reserve, for rates that overshoot the full speed.
        self._max_rate = 1.0 / SYMMETRIC_MARGINS[0] if np.isfinite(limits.tool_speed) else np.inf
        self._override = _share(override)
        self._held = False
        self._reversing = False
        self._waiting = False
        self._state = np.zeros(3)  # tau, its rate, the rate's derivative
        self._ramp = np.zeros(8)
        self._trial = np.zeros(8)
        self._elapsed = 0.0
        self._motion = np.zeros((3, 7))
        kernels.evaluate_motion(self._table, self._step, self._state, self._motion)
        self._sent = np.repeat(self._motion[:1, :6], 3, axis=0)  # newest last
        self._ruckig, self._inputs, self._answer = Ruckig(1), _inputs(), Trajectory(1)

    @property
    def override(self) -> float:
        """Share of the full speed that is asked for, 0 to 1."""
        return self._override

    @property
    def held(self) -> bool:
        """Whether rest was asked for, by `hold` or an override of zero."""
        return self._held or self._override < MIN_OVERRIDE

    @property
    def reversing(self) -> bool:
        """Whether `reverse` was called and not taken back."""
        return self._reversing

    @property
    def motion(self) -> Array:
        """The present nominal motion (3, 7): joints and length, their velocity and acceleration."""
        return self._motion

    @property
    def progress(self) -> PathProgress:
        """How far the trajectory is done now."""
        tau, rate, slope = self._state
        standing = bool(rate == 0.0 and slope == 0.0)
        return PathProgress(float(self._motion[0, 6]), float(rate), standing, standing and bool(tau >= self._end))

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed from now on, clipped to 0 to 1; a share under `MIN_OVERRIDE` holds."""
        self._override = _share(share)

    def hold(self) -> None:
        """Come to rest as soon as the limits allow."""
        self._held = True

    def set_waiting(self, waiting: bool) -> None:
        """Come to rest as `hold` does, or go on; `held` stays as it is."""
        self._waiting = waiting

    def resume(self) -> None:
        """Go on to the end."""
        self._held = self._reversing = False

    def reverse(self) -> None:
        """Go back along the path to its beginning, at `MAX_REVERSE_RATE` at most."""
        self._held, self._reversing = False, True

    def rest_at(self, tau: float) -> None:
        """Set the plan time to `tau` [s], held; only for an arm that rests there already."""
        self._rest(min(max(tau, 0.0), self._end))
        kernels.evaluate_motion(self._table, self._step, self._state, self._motion)
        self._sent[:] = self._motion[0, :6]
        self._held, self._reversing = True, False

    def restart_at(self, tau: float, *, held: bool) -> None:
        """Go on from plan time `tau` [s], in the direction as before, or stay held; the arm rests there already."""
        reversing = self._reversing
        self.rest_at(tau)
        self._held, self._reversing = held, reversing and not held

    @property
    def tau(self) -> float:
        """The present plan time [s]."""
        return float(self._state[0])

    @property
    def state(self) -> Array:
        """Plan time [s], its rate and the rate's derivative [1/s] (3,), at present."""
        return self._state.copy()

    @property
    def target_rate(self) -> float:
        """The rate that is asked for, negative on the way back."""
        if self.held or self._waiting:
            return 0.0
        return -min(self._override, MAX_REVERSE_RATE) if self._reversing else self._override

    @property
    def ramp_end_rate(self) -> float:
        """The rate at which the present ramp ends: `target_rate`, as soon as a ramp to that is verified."""
        return float(self._ramp[7])

    def step(self) -> PathProgress:
        """Advance by one control period; never raises."""
        target = self.target_rate
        left = self._ramp[3] + self._ramp[4] + self._ramp[5] - self._elapsed
        if self._ramp[7] != target or left > 0.0:
            self._change_rate(target, left if self._ramp[7] == target else np.inf)
        self._elapsed += self._dt
        state = self._state
        state[:] = kernels.evaluate_ramp(self._ramp, self._elapsed)
        if (state[0] >= self._end and state[1] >= 0.0) or (state[0] <= 0.0 and state[1] <= 0.0):
            # The trajectory begins and ends at rest, whatever the rate.
            self._rest(0.0 if state[0] <= 0.0 else self._end)
        kernels.evaluate_motion(self._table, self._step, state, self._motion)
        self._sent[:2] = self._sent[1:]
        self._sent[2] = self._motion[0, :6]
        return self.progress

    def way_to_rest(self) -> WayToRest:
        """Find the way to rest from here, judged against all limits together with the setpoints already sent.

        Where no ramp to rest keeps them from here, the present ramp goes on for some periods; at worst it goes on to
        the end of the trajectory, where the motion rests.
        """
        if self.progress.at_rest:
            return WayToRest(np.empty((0, 6)), self.tau)
        trial = np.zeros(8)
        for lead in STOP_LEADS:
            sent, state = self._sent.copy(), self._state.copy()
            ended = kernels.lead_along(self._table, self._step, self._ramp, self._elapsed, self._dt, lead, sent, state)
            if ended:
                return self._sampled(lead, np.zeros(8))
            search = (self._stop_limits, self._dt, MAX_STOP_TIME, MAX_STOP_RAMPS, self._max_rate, trial)
            if find_ramp(self._table, self._step, state, 0.0, sent, *search) >= 0.0:
                return self._sampled(lead, trial)
        return self._sampled(int(self._end / self._dt / MIN_OVERRIDE), np.zeros(8))

    def _sampled(self, lead: int, ramp: Array) -> WayToRest:
        count = min(lead + int(np.ceil(ramp[3:6].sum() / self._dt)), MAX_STOP_PERIODS)
        out = np.empty((count, 6))
        count = kernels.sample_stop(self._table, self._step, self._ramp, self._elapsed, lead, ramp, self._dt, out)
        tau = (
            kernels.evaluate_ramp(ramp, (count - lead) * self._dt)[0]
            if count > lead
            else (kernels.evaluate_ramp(self._ramp, self._elapsed + count * self._dt)[0])
        )
        return WayToRest(out[:count], min(max(float(tau), 0.0), self._end))

    def _change_rate(self, target: float, within: float) -> None:
        trial, state = self._trial, self._state
        if (state[0] <= 0.0 and target >= 0.0) or (state[0] >= self._end and target <= 0.0):
            trial[:] = (state[0], target, 0.0, 0.0, 0.0, 0.0, 0.0, target)
            kept = kernels.check_ramp(self._table, self._step, trial, self._sent, self._limits, self._dt)
            if kept[0] == kernels.KEPT:
                self._accept_trial()
            return
        given = (self._table, self._step, state, target, self._sent, self._limits, self._dt)
        peak = -1.0
        if within == np.inf:
            peak = find_ramp(*given, within, MAX_RAMPS_PER_PERIOD, self._max_rate, trial)
            if peak < 0.0:
                return
            within = float(trial[3:6].sum())
        shorter = shorten_ramp(*given, within, MAX_SHORTER_RAMPS, self._max_rate, trial)
        peak = shorter if shorter >= 0.0 else peak
        if peak >= 0.0 and self._ruckig_agrees(peak):
            self._accept_trial()

    def _accept_trial(self) -> None:
        self._ramp[:] = self._trial
        self._elapsed = 0.0

    def _rest(self, tau: float) -> None:
        self._state[:] = (tau, 0.0, 0.0)
        self._ramp[:] = 0.0
        self._ramp[0] = tau
        self._elapsed = 0.0

    def _ruckig_agrees(self, peak: float) -> bool:
        """Tell whether Ruckig finds the ramp that is on trial."""
        trial, inputs = self._trial, self._inputs
        inputs.current_position, inputs.current_velocity = [float(trial[0])], [float(trial[1])]
        inputs.current_acceleration, inputs.target_velocity = [float(trial[2])], [float(trial[7])]
        # The limit on the side of the present acceleration includes that acceleration: with a lower one Ruckig would
        # brake first, and with the same limit on the other side it would go beyond the peak.
        along, against = peak * RUCKIG_MARGIN, max(peak, abs(float(trial[2]))) * RUCKIG_MARGIN
        upward, downward = (along, against) if trial[6] > 0.0 else (against, along)
        inputs.max_acceleration, inputs.min_acceleration = [upward], [-downward]
        inputs.max_jerk = [abs(float(trial[6]))]
        try:
            result = self._ruckig.calculate(inputs, self._answer)
        except RuckigError:
            return False
        closed_form = float(trial[3] + trial[4] + trial[5])
        return bool(result == Result.Working and abs(self._answer.duration - closed_form) <= DURATION_TOLERANCE)


def warm_up(dt: float, arm: Arm) -> None:
    """Compile the kernels, or load them from disk, so that the first motion does not wait for them."""
    turn = np.array([0.01, 0.0, 0.0, 0.0, 0.0, 0.0])
    governor = Governor(straight_move(np.zeros(6), turn, arm.limits.motion, arm=arm, margins=(0.5, 0.5, 0.5)), dt)
    for act in (governor.step, governor.way_to_rest, governor.hold, governor.step, governor.reverse, governor.step):
        act()


def _inputs() -> InputParameter:
    inputs = InputParameter(1)
    inputs.control_interface = ControlInterface.Velocity
    inputs.target_acceleration = [0.0]
    return inputs


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0) if value == value else 0.0
