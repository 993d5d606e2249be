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

from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing import kernels, ramp_following
from teachpath.motion.timing.joint_moves import straight_move
from teachpath.motion.timing.ramp_checks import MAX_RAMP_PERIODS, PHASES
from teachpath.motion.timing.ramp_finder import RampFinder
from teachpath.motion.timing.ramp_search import MIN_TIME_SAVED
from teachpath.motion.timing.timed_trajectory import TimedTrajectory

MIN_OVERRIDE: Final = 0.01  # a smaller override holds
MAX_REVERSE_RATE: Final = 0.96  # of the way back: a plan has its margins on the other side (see `limit_margins`)
STOP_SEARCH_INTERVAL: Final = 2  # periods from one search for a shorter stop to the next, while one is followed
STOP_LEADS: Final = (0.032, 0.064, 0.1, 0.13)  # [s] for which the present motion goes on where no stop is found


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
        states: (n, 3, joints) joints, velocity, acceleration a control period apart, the first ahead; empty at rest.
        tau: plan time at which it rests [s].
    """

    states: Array
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
        self._override = _share(override)
        self._held = False
        self._reversing = False
        self._waiting = False
        self._state = np.zeros(3)  # tau, its rate, the rate's derivative
        self._ramp = np.zeros((MAX_RAMP_PERIODS, 3))  # its states at the ends of the periods; the last one goes on
        self._ramp_periods, self._ramp_end, self._done = 1, 0.0, 1
        self._finder = RampFinder(trajectory, dt)
        self._stop_periods: int | None = None  # of the one from the present state, once that was searched for
        self._motion = np.zeros((3, trajectory.table.shape[2]))
        kernels.evaluate_motion(self._table, self._step, self._state, self._motion)
        self._sent = np.zeros(
            (PHASES, 3, trajectory.table.shape[2] - 1)
        )  # newest setpoint and differences (see `ramp_checks.advance`)
        self._sent[:, 0] = self._motion[0, :-1]

    @property
    def override(self) -> float:
        """Share of the full speed that is asked for, 0 to 1."""
        return self._override

    @property
    def held(self) -> bool:
        """Whether rest was asked for, by `hold` or an override of zero."""
        return self._held or self._override < MIN_OVERRIDE

    @property
    def goes_forward(self) -> bool:
        """Whether it moves towards its end, or is there."""
        return not self._reversing and (not self.progress.at_rest or self.progress.finished)

    @property
    def reversing(self) -> bool:
        """Whether `reverse` was called and not taken back."""
        return self._reversing

    @property
    def motion(self) -> Array:
        """The present nominal motion (3, joints + 1): joints and length, their velocity and acceleration."""
        return self._motion

    @property
    def sent(self) -> Array:
        """The newest setpoint and its differences (PHASES, 3, joints), as `ramp_checks.advance` keeps them."""
        return self._sent.copy()

    @property
    def progress(self) -> PathProgress:
        """How far the trajectory is done now."""
        tau, rate, slope = self._state
        standing = bool(rate == 0.0 and slope == 0.0)
        return PathProgress(float(self._motion[0, -1]), float(rate), standing, standing and bool(tau >= self._end))

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
        self._sent[:] = 0.0
        self._sent[:, 0] = self._motion[0, :-1]
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
        return self._ramp_end

    def step(self) -> PathProgress:
        """Advance by one control period; never raises."""
        target = self.target_rate
        left = max(self._ramp_periods - self._done, 0) * self._dt
        if self._ramp_end != target or left > 0.0:
            self._change_rate(target, left if self._ramp_end == target else np.inf)
        self._done += 1
        ramp = (self._ramp, self._ramp_periods, self._done, self._dt)
        if ramp_following.advance_along(self._table, self._step, *ramp, self._state, self._motion, self._sent):
            # The trajectory begins and ends at rest, whatever the rate.
            self._rest(float(self._state[0]))
        self._stop_periods = None
        return self.progress

    def way_to_rest(self) -> WayToRest:
        """Find the way to rest from here, judged against all limits together with the setpoints already sent.

        It is the present ramp where that leads to rest, otherwise the stop that `hold` would follow. Where no stop
        keeps the limits from here, the present ramp goes on for some periods; at worst it goes on to the end of the
        trajectory, where the motion rests.
        """
        if self.progress.at_rest:
            return WayToRest(np.empty((0, *self._sent.shape[1:])), self.tau)
        if self._ramp_end == 0.0:
            return self._sampled(self._ramp_periods - self._done, 0)
        if periods := self._present_stop():
            return self._sampled(0, periods)
        for lead in (round(seconds / self._dt) for seconds in STOP_LEADS):
            sent, state = self._sent.copy(), self._state.copy()
            self._follow(lead, sent, state, np.empty((lead, *self._motion.shape)))
            if state[1] == 0.0 or (periods := self._finder.find_stop(state, sent)):
                return self._sampled(lead, periods)
        return self._sampled(MAX_RAMP_PERIODS, 0)  # nothing but the end of the trajectory is one

    def _sampled(self, lead: int, periods: int) -> WayToRest:
        """Return the way to rest along the ramp for some periods, and then along the newest stop for some."""
        sent, state, motions = self._sent.copy(), self._state.copy(), np.empty((lead + periods, *self._motion.shape))
        count = self._follow(lead, sent, state, motions[:lead])
        if periods:
            stop = (self._finder.stop, periods, 0, self._dt)
            count += ramp_following.follow(self._table, self._step, *stop, sent, state, motions[lead:])
        return WayToRest(motions[:count, :, :-1], min(max(float(state[0]), 0.0), self._end))

    def _follow(self, lead: int, sent: Array, state: Array, motions: Array) -> int:
        ramp = (self._ramp, self._ramp_periods, self._done, self._dt)
        return ramp_following.follow(self._table, self._step, *ramp, sent, state, motions[:lead])

    def _present_stop(self) -> int:
        """Find a stop from the present state once; return its periods, or 0."""
        if self._stop_periods is None:
            self._stop_periods = self._finder.find_stop(self._state, self._sent)
        return self._stop_periods

    def _change_rate(self, target: float, within: float) -> None:
        state = self._state
        if (state[0] <= 0.0 and target >= 0.0) or (state[0] >= self._end and target <= 0.0):
            if self._finder.keeps_rate(target, float(state[0]), self._sent):
                self._follow_ramp()
        elif target == 0.0:
            if within < np.inf and self._done % STOP_SEARCH_INTERVAL:
                return
            periods = self._present_stop()
            if periods and periods * self._dt < within - MIN_TIME_SAVED:
                self._ramp[:periods] = self._finder.stop[:periods]
                self._ramp_periods, self._ramp_end, self._done = periods, 0.0, 0
        elif self._finder.find_ramp(target, state, self._sent, within):
            self._follow_ramp()

    def _follow_ramp(self) -> None:
        if periods := ramp_following.sample_ramp(self._finder.ramp, self._dt, self._ramp):
            self._ramp_periods, self._ramp_end, self._done = periods, float(self._finder.ramp[7]), 0

    def _rest(self, tau: float) -> None:
        self._state[:] = (tau, 0.0, 0.0)
        self._ramp[0] = self._state
        self._ramp_periods, self._ramp_end, self._done = 1, 0.0, 1


def warm_up(dt: float, arm: Arm) -> None:
    """Compile the kernels, or load them from disk, so that the first motion does not wait for them."""
    still, turn = np.zeros(arm.joint_count), 0.01 * (np.arange(arm.joint_count) == 0)
    governor = Governor(straight_move(still, turn, arm.limits.motion, arm=arm, margins=(0.5, 0.5, 0.5)), dt)
    for act in (governor.step, governor.way_to_rest, governor.hold, governor.step, governor.reverse, governor.step):
        act()


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0) if value == value else 0.0
