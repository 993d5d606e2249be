"""Plays setpoints as a driver should: a fixed delay behind their nominal times, without a jump when some are missing.

Setpoints carry position, velocity and acceleration at even times of the motion's own clock. Between the two setpoints
around the played instant the target follows the polynomial of fifth degree that meets all three at both, however many
setpoints are missing in between. The played instant advances with real time. When few setpoints are left it advances
more slowly, and with none left the target comes to rest in the direction it had. So a late setpoint slows the arm down
on its path and never makes it jump. A player that is behind, because its machine is busy, catches up at the next
standstill.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.records import Array, Setpoint

MAX_RATE_SLOPE: Final = 5.0  # [1/s] of the playing rate: at full speed within the joints' limits of acceleration
LOW_BUFFER_SHARE: Final = 0.35  # of the delay: with setpoints for less time than this, the playing slows down
OFFSET_DECAY_TIME: Final = 0.12  # [s] in which the target returns to the setpoints after a time without any
MAX_WAITING: Final = 2000  # setpoints; when more wait, the sender's clock is wrong
MAX_CLOCK_ERROR: Final = 1.0  # [s] between the sender's clock and ours; nominal times farther off are not believed


@dataclass(frozen=True, eq=False)
class TargetMotion:
    """The motion that the arm is to make now: (6,) in rad, rad/s, rad/s^2."""

    position: Array
    velocity: Array
    acceleration: Array


class SetpointPlayer:
    """Turns the stream of setpoints into the target motion of one arm.

    Args:
        position: (6,) where the arm rests [rad].
        delay: between a setpoint's nominal time and its playing [s].
        silence: without anything left to play, after which `holding` is true [s].

    Attributes:
        target: the motion that the arm is to make now.
        missed: setpoints of the execution that never came.
        late: setpoints of the execution that came after their time to be played.
    """

    def __init__(self, position: Array, *, delay: float, silence: float) -> None:
        still = np.zeros(6)
        self._delay = delay
        self._silence = silence
        self._waiting: deque[Setpoint] = deque()
        self._last: Setpoint | None = None  # the newest that was reached
        self._begin_ns = 0  # nominal time of the first setpoint
        self._played = 0.0  # [s] from there to the played instant
        self._rate = 1.0  # at which the played instant advances
        self._zero_ns = 0  # real time at which a player that is never late would have begun
        # Offset of the target's position and velocity from the setpoints, and the time since it began to decay [s].
        self._offset: tuple[Array, Array, float] = (still, still, OFFSET_DECAY_TIME)
        self.target = TargetMotion(np.array(position), still, still)
        self.missed = self.late = 0
        self._newest_cycle = -1
        self._quintic: _Quintic | None = None  # between the two setpoints around the played instant
        self._period = 0.004  # [s] between the two newest setpoints
        self._starved = 0.0  # [s] for which nothing has been left to play
        self._slope = 0.0  # [1/s] of the playing rate
        self._unbuffered = True  # whether the target was not taken from setpoints, but is a rest or an extrapolation

    @property
    def last_reached(self) -> Setpoint | None:
        """The newest setpoint whose time has been played."""
        return self._last

    @property
    def execution(self) -> str:
        """Id of the execution of the newest setpoint; empty when none has come."""
        newest = self._waiting[-1] if self._waiting else self._last
        return newest.execution if newest is not None else ""

    @property
    def holding(self) -> bool:
        """Whether nothing has been left to play for a while: the arm comes to rest, or rests."""
        return self._starved > self._silence

    @property
    def at_rest(self) -> bool:
        """Whether no setpoint waits to be played and the target stands still."""
        return not (self._waiting or self.target.velocity.any() or self.target.acceleration.any())

    @property
    def overdue(self) -> int:
        """How many setpoints should have come since the player is holding."""
        return int(self._starved / self._period) if self.holding else 0

    def add(self, setpoint: Setpoint, now: int) -> None:
        """Take a setpoint that came at `now` [ns]; one that is older than the newest is left out."""
        newest = self._waiting[-1] if self._waiting else self._last
        if newest is None or newest.execution != setpoint.execution:
            self._start_execution(setpoint, now)
        elif setpoint.cycle <= self._newest_cycle or setpoint.nominal_ns <= newest.nominal_ns:
            return
        else:
            ahead = setpoint.cycle - self._newest_cycle
            self.missed += ahead - 1
            self._period = (setpoint.nominal_ns - newest.nominal_ns) / 1e9 / ahead
        self._newest_cycle = setpoint.cycle
        if self._time_of(setpoint) < self._played:
            self.late += 1
        if len(self._waiting) < MAX_WAITING:
            self._waiting.append(setpoint)

    def advance(self, dt: float, now: int) -> Setpoint | None:
        """Advance by `dt` [s] of real time to `now` [ns]; return the newest setpoint that was reached, if any."""
        if self._last is None and not self._waiting:
            return None
        self._update_rate(dt)
        self._played += self._rate * dt
        reached = None
        while self._waiting and self._time_of(self._waiting[0]) <= self._played:
            self._last = reached = self._waiting.popleft()
        reached = self._skip_standstill(now) or reached
        self._starved = self._starved + dt if self._buffered_time() < 0.0 else 0.0
        if self._last is not None:
            self._update_target(dt, continuing=self._unbuffered and (reached is not None or bool(self._waiting)))
        return reached

    def _start_execution(self, setpoint: Setpoint, now: int) -> None:
        """Begin another execution, in whose first setpoint the arm rests."""
        self._waiting.clear()
        self._last, self._begin_ns = None, setpoint.nominal_ns
        waited = (now - setpoint.nominal_ns) / 1e9
        self._played = (waited if 0.0 <= waited <= MAX_CLOCK_ERROR else 0.0) - self._delay
        self._zero_ns = now - round((self._played + self._delay) * 1e9)
        self._rate, self.missed, self.late = 1.0, 0, 0
        self._unbuffered = True

    def _time_of(self, setpoint: Setpoint) -> float:
        return (setpoint.nominal_ns - self._begin_ns) / 1e9

    def _buffered_time(self) -> float:
        newest = self._waiting[-1] if self._waiting else self._last
        return self._time_of(newest) - self._played if newest is not None else 0.0

    def _skip_standstill(self, now: int) -> Setpoint | None:
        """Skip setpoints of a standstill that were due: catching up there changes the motion in nothing but time."""
        reached, due = None, (now - self._zero_ns) / 1e9 - self._delay
        while (
            len(self._waiting) > 1
            and self._time_of(self._waiting[0]) <= due
            and _is_same_standstill(self._last, self._waiting)
        ):
            self._last = reached = self._waiting.popleft()
            self._played = self._time_of(reached)
        return reached

    def _update_rate(self, dt: float) -> None:
        """Let the playing rate follow the time for which setpoints are left, within its largest slope."""
        newest = self._waiting[-1] if self._waiting else self._last
        resting = newest is not None and _is_standstill(newest)
        rate = 1.0 if resting else min(max(self._buffered_time() / (LOW_BUFFER_SHARE * self._delay), 0.0), 1.0)
        change = min(max(rate - self._rate, -MAX_RATE_SLOPE * dt), MAX_RATE_SLOPE * dt)
        self._rate += change
        self._slope = change / dt

    def _update_target(self, dt: float, *, continuing: bool) -> None:
        assert self._last is not None
        before, rate, last = self.target, self._rate, self._last
        if self._waiting:
            quintic, coming = self._quintic, self._waiting[0]
            if quintic is None or quintic.first is not last or quintic.second is not coming:
                quintic = self._quintic = _Quintic(last, coming)
            p, v, a = quintic(self._played - self._time_of(last))
        else:
            p, v, a = last.position + (self._played - self._time_of(last)) * last.velocity, last.velocity, np.zeros(6)
        v, a = rate * v, rate**2 * a + self._slope * v
        self._unbuffered = not self._waiting
        if continuing:  # the target goes on from where it is, and the offset decays
            self._offset = (before.position + before.velocity * dt - p, before.velocity - v, 0.0)
        error, drift, since = self._offset
        if since < OFFSET_DECAY_TIME:
            p, v, a = (value + part for value, part in zip((p, v, a), _decaying(error, drift, since), strict=True))
            self._offset = (error, drift, since + dt)
        self.target = TargetMotion(p, v, a)


class _Quintic:
    """The quintic Hermite polynomial between two setpoints."""

    def __init__(self, first: Setpoint, second: Setpoint) -> None:
        self.first = first
        self.second = second
        self._span = span = (second.nominal_ns - first.nominal_ns) / 1e9
        p0, v0, a0 = first.position, first.velocity * span, first.acceleration * span**2
        p1, v1, a1 = second.position, second.velocity * span, second.acceleration * span**2
        d, e, f = p1 - p0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
        rows = [p0, v0, a0 / 2, 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2]
        self._powers = np.array(rows)  # (6, joints), of the share of the span

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration `t` [s] after the first setpoint."""
        x, h = min(t / self._span, 1.0), self._span
        shares = (
            (1.0, x, x**2, x**3, x**4, x**5),
            (0.0, 1.0 / h, 2 * x / h, 3 * x**2 / h, 4 * x**3 / h, 5 * x**4 / h),
            (0.0, 0.0, 2.0 / h**2, 6 * x / h**2, 12 * x**2 / h**2, 20 * x**3 / h**2),
        )
        p, v, a = np.array(shares) @ self._powers
        return p, v, a


def _is_standstill(setpoint: Setpoint) -> bool:
    return not (setpoint.velocity.any() or setpoint.acceleration.any())


def _is_same_standstill(last: Setpoint | None, waiting: deque[Setpoint]) -> bool:
    """Tell whether the next two setpoints belong to the standstill of the one that was reached last."""
    return last is not None and all(
        _is_standstill(each)
        and np.array_equal(each.position, last.position)
        and each.gripper_closed == last.gripper_closed
        for each in (last, waiting[0], waiting[1])
    )


def _decaying(error: Array, drift: Array, since: float) -> tuple[Array, Array, Array]:
    """Return what is left of an offset that began to decay `since` [s] ago: a quintic over `OFFSET_DECAY_TIME`."""
    h = OFFSET_DECAY_TIME
    x, e, g = since / h, error, drift * h
    c3, c4, c5 = -10 * e - 6 * g, 15 * e + 8 * g, -6 * e - 3 * g
    p = e + x * (g + x * x * (c3 + x * (c4 + x * c5)))
    v = g + x * x * (3 * c3 + x * (4 * c4 + x * 5 * c5))
    a = x * (6 * c3 + x * (12 * c4 + x * 20 * c5))
    return p, v / h, a / h**2
