"""Finds ramps of the rate of plan time, and stops, whose setpoints keep all limits; for the governor of one trajectory.

A ramp to rest is the shortest stop that `find_stop` finds, any other one has three phases; where no stop is found, it
has three phases, too.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.timing import ramp_checks, ramp_following
from teachpath.motion.timing.limit_margins import SYMMETRIC_MARGINS
from teachpath.motion.timing.ramp_search import find_ramp, shorten_ramp
from teachpath.motion.timing.ruckig_check import RuckigCheck
from teachpath.motion.timing.stop_search import find_stop
from teachpath.motion.timing.timed_trajectory import TimedTrajectory

MAX_RAMPS_PER_PERIOD: Final = 20  # ramps to another rate that are judged in one control period at most
MAX_RAMPS_AMID_RAMP: Final = 8  # the same where the next period begins from another rate anyway
MAX_SHORTER_RAMPS: Final = 4  # the same to the rate that the present ramp leads to
MAX_STOPS: Final = 3  # stops from one place that are judged in one period at most
MAX_STOP_PERIODS: Final = 500  # of a stop; with none so short the present motion goes on for a while
LONG_STOP: Final = 0.24  # [s] of a stop above which a shorter one is looked for from places on it
PLACES: Final = (0.1, 0.13, 0.065, 0.19, 0.23)  # [s] of them after its beginning, in the order in which they are tried
MIN_LONGER: Final = 1.7  # times as long as the way to such a place, that it must be


class RampFinder:
    """Searches on one trajectory.

    Args:
        dt: control period [s].

    Attributes:
        ramp: (8,) the newest ramp that was found (see `kernels.evaluate_ramp`).
        stop: (m, 3) states of the newest stop that was found: plan time, its rate and the rate's derivative at the ends
            of the periods.
    """

    def __init__(self, trajectory: TimedTrajectory, dt: float) -> None:
        limits = trajectory.limits
        scaled = np.stack([limits.speed * dt, limits.acceleration * dt**2, limits.jerk * dt**3])
        self._table, self._step, self._limits, self._dt = trajectory.table, trajectory.step, scaled, dt
        # A planned motion keeps this share of the tool's limit in reserve, for rates that overshoot the full speed.
        self._max_rate = 1.0 / SYMMETRIC_MARGINS[0] if np.isfinite(limits.tool_speed) else np.inf
        self.ramp: Array = np.zeros(8)
        self.stop: Array = np.zeros((MAX_STOP_PERIODS, 3))
        self._uses = np.zeros(MAX_STOP_PERIODS)
        self._places = [round(place / dt) for place in PLACES]  # [control periods]
        self._ruckig = RuckigCheck()

    def keeps_rate(self, rate: float, tau: float, sent: Array) -> bool:
        """Write the motion at a constant rate from plan time `tau` [s] to `ramp`; tell whether it keeps all limits."""
        self.ramp[:] = (tau, rate, 0.0, 0.0, 0.0, 0.0, 0.0, rate)
        kept = ramp_checks.check_ramp(self._table, self._step, self.ramp, sent, self._limits, self._dt)
        return kept[0] == ramp_checks.LIMITS_KEPT

    def find_ramp(self, target: float, state: Array, sent: Array, within: float) -> bool:
        """Write a ramp of three phases that takes less than `within` [s] to `ramp`; return whether there is one.

        Args:
            target: rate to which it leads.
            state: (3,) plan time [s], its rate and the rate's derivative where it begins.
            sent: (PHASES, 3, joints) setpoint and differences there (see `ramp_checks.advance`).
        """
        given = (self._table, self._step, state, target, sent, self._limits, self._dt)
        peak = -1.0
        if within == np.inf:
            longest = MAX_STOP_PERIODS * self._dt if target == 0.0 else within
            tries = MAX_RAMPS_AMID_RAMP if state[2] else MAX_RAMPS_PER_PERIOD
            peak = find_ramp(*given, longest, tries, self._max_rate, self.ramp)
            if peak < 0.0:
                return False
            within = float(self.ramp[3:6].sum())
        shorter = shorten_ramp(*given, within, MAX_SHORTER_RAMPS, self._max_rate, self.ramp)
        peak = shorter if shorter >= 0.0 else peak
        return peak >= 0.0 and self._ruckig.agrees(self.ramp, peak)

    def find_stop(self, state: Array, sent: Array) -> int:
        """Write a stop from a state to `stop`; return its periods, or 0 where none is found.

        Where the joints can hardly brake at first, the search from there ends in a stop that brakes gently to its end.
        From a place on it, where the joints can brake harder, there is often a much shorter one.
        """
        periods = self._find_stop(state, sent)
        for lead in self._places:
            if periods > max(MIN_LONGER * lead, LONG_STOP / self._dt):
                periods = self._shorten(lead, periods, state, sent)
        return periods

    def _shorten(self, lead: int, periods: int, state: Array, sent: Array) -> int:
        """Search for a shorter stop that begins as the one in `stop` does for `lead` periods; return its periods."""
        known, later, differences = self.stop[:periods].copy(), state.copy(), sent.copy()
        begin = (known, periods, 0, self._dt, differences, later, np.empty((lead, 3, differences.shape[2] + 1)))
        ramp_following.follow(self._table, self._step, *begin)
        rest = self._find_stop(later, differences)
        if 0 < rest < periods - lead:
            self.stop[lead : lead + rest] = self.stop[:rest].copy()
            self.stop[:lead] = known[:lead]
            return lead + rest
        self.stop[:periods] = known
        return periods

    def _find_stop(self, state: Array, sent: Array) -> int:
        given = (self._table, self._step, state, sent, self._limits, self._dt)
        if periods := find_stop(*given, self._max_rate, MAX_STOPS, self.stop):
            return int(periods)
        if not self.find_ramp(0.0, state, sent, np.inf):
            return 0
        periods = ramp_following.sample_ramp(self.ramp, self._dt, self.stop)
        # A player reads the states as a spline, which differs from the phases where these begin within a period.
        joined = (state, self.stop, periods, sent, self._limits, self._dt, self._uses)
        return periods if periods and ramp_checks.check_states(self._table, self._step, *joined) else 0
