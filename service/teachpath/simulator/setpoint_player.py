"""Plays setpoints as a driver should: a fixed delay behind, through gaps and starvation, without a jump.

Setpoints carry position, velocity and acceleration at even times of the motion's own clock. Between the two that are
next to the played instant runs the polynomial of fifth degree that meets all three at both, however many are missing
in between. The played instant runs with real time; when the store of setpoints gets low it runs slower, smoothly, and
with nothing left it comes to rest, going on in the direction it had. So a late setpoint slows the arm down on its path
instead of throwing it about. A player that is behind, because its machine is busy, catches up at the next standstill.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.records import Array, Setpoint

MAX_RATE_SLOPE: Final = 5.0  # 1/s, change of the playing rate: at full speed within the joints' limits of acceleration
LOW_BUFFER_SHARE: Final = 0.35  # share of the delay, with less than which in store the playing slows down
OFFSET_DECAY_TIME: Final = 0.12  # s, over which the way that was gone without setpoints is handed back to the stream
MAX_WAITING: Final = 2000  # setpoints that wait at most; with more the sender's clock is wrong
MAX_CLOCK_ERROR: Final = 1.0  # s, of a clock that is so far off that its times cannot be meant


@dataclass(frozen=True, eq=False)
class TargetMotion:
    """The motion that is wanted now: (6,) in rad, rad/s, rad/s^2."""

    position: Array
    velocity: Array
    acceleration: Array


class SetpointPlayer:
    """The motion of one arm over its own time.

    Args:
        position: (6,) where the arm rests [rad].
        delay: between a setpoint's nominal time and its playing [s].
        silence: beyond the newest setpoint after which `holding` is said [s].
    """

    def __init__(self, position: Array, *, delay: float, silence: float) -> None:
        still = np.zeros(6)
        self._delay, self._silence = delay, silence
        self._waiting: deque[Setpoint] = deque()
        self._last: Setpoint | None = None  # the newest that was reached
        self._begin_ns, self._played, self._rate = 0, 0.0, 1.0  # first nominal time [ns], instant behind it [s]
        self._zero_ns = 0  # [ns] of real time, from when on the player would have played if it never was late
        self._offset: tuple[Array, Array, float] = (
            still,
            still,
            OFFSET_DECAY_TIME,
        )  # what is handed back, and for how long
        self.target = TargetMotion(np.array(position), still, still)
        self.missed = self.late = 0
        self._newest_cycle = -1
        self._quintic: _Quintic | None = None  # between the two setpoints that are next to the played instant
        self._period = 0.004  # s, between two setpoints, as seen
        self._starved = 0.0  # s, for which nothing has been left to play
        self._slope = 0.0  # 1/s, of the playing rate
        self._unbuffered = True  # whether the wanted motion was no stream, but a rest or what was gone without one

    @property
    def last_reached(self) -> Setpoint | None:
        """The newest setpoint that was reached."""
        return self._last

    @property
    def execution(self) -> str:
        """The execution that is played, or waits to be; empty when there was none."""
        newest = self._waiting[-1] if self._waiting else self._last
        return newest.execution if newest is not None else ""

    @property
    def holding(self) -> bool:
        """Whether nothing has been left to play for a while: the arm comes to rest, or rests."""
        return self._starved > self._silence

    @property
    def at_rest(self) -> bool:
        """Whether nothing waits to be played and the wanted motion stands still."""
        return not (self._waiting or self.target.velocity.any() or self.target.acceleration.any())

    @property
    def overdue(self) -> int:
        """How many setpoints should have come while it is holding."""
        return int(self._starved / self._period) if self.holding else 0

    def add(self, setpoint: Setpoint, now: int) -> None:
        """Take a setpoint that came at `now` [ns]; one that is older than those before changes nothing."""
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
        """Go on by `dt` [s] of real time to `now` [ns]; returns the newest setpoint that was reached, if any."""
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
            self._update_target(dt, handing=self._unbuffered and (reached is not None or bool(self._waiting)))
        return reached

    def _start_execution(self, setpoint: Setpoint, now: int) -> None:
        """Begin another execution: the arm rests, and so does its first setpoint."""
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
        """Skip what waits of a standstill and was due: who is late there has lost nothing but time."""
        reached, due = None, (now - self._zero_ns) / 1e9 - self._delay
        while (
            len(self._waiting) > 1 and self._time_of(self._waiting[0]) <= due and _same_rest(self._last, self._waiting)
        ):
            self._last = reached = self._waiting.popleft()
            self._played = self._time_of(reached)
        return reached

    def _update_rate(self, dt: float) -> None:
        """Let the playing rate follow the store: 1 with half a delay or more, 0 with nothing left."""
        newest = self._waiting[-1] if self._waiting else self._last
        resting = newest is not None and _is_standstill(newest)
        rate = 1.0 if resting else min(max(self._buffered_time() / (LOW_BUFFER_SHARE * self._delay), 0.0), 1.0)
        change = min(max(rate - self._rate, -MAX_RATE_SLOPE * dt), MAX_RATE_SLOPE * dt)
        self._rate += change
        self._slope = change / dt

    def _update_target(self, dt: float, *, handing: bool) -> None:
        assert self._last is not None
        before, rate, last = self.target, self._rate, self._last
        if self._waiting:
            if self._quintic is None or self._quintic.one is not last or self._quintic.two is not self._waiting[0]:
                self._quintic = _Quintic(last, self._waiting[0])
            p, v, a = self._quintic(self._played - self._time_of(last))
        else:
            p, v, a = last.position + (self._played - self._time_of(last)) * last.velocity, last.velocity, np.zeros(6)
        v, a = rate * v, rate**2 * a + self._slope * v
        self._unbuffered = not self._waiting
        if handing:
            self._offset = (before.position + before.velocity * dt - p, before.velocity - v, 0.0)
        error, drift, since = self._offset
        if since < OFFSET_DECAY_TIME:
            p, v, a = (value + part for value, part in zip((p, v, a), _decaying(error, drift, since), strict=True))
            self._offset = (error, drift, since + dt)
        self.target = TargetMotion(p, v, a)


class _Quintic:
    """The quintic Hermite polynomial between two setpoints."""

    def __init__(self, one: Setpoint, two: Setpoint) -> None:
        self.one, self.two = one, two
        self._span = span = (two.nominal_ns - one.nominal_ns) / 1e9
        p0, v0, a0 = one.position, one.velocity * span, one.acceleration * span**2
        p1, v1, a1 = two.position, two.velocity * span, two.acceleration * span**2
        d, e, f = p1 - p0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
        rows = [p0, v0, a0 / 2, 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2]
        self._powers = np.array(rows)  # (6, joints), of the share of the span

    def __call__(self, t: float) -> tuple[Array, Array, Array]:
        """Evaluate position, velocity and acceleration `t` [s] behind the first."""
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


def _same_rest(last: Setpoint | None, waiting: deque[Setpoint]) -> bool:
    """Tell whether the two that come next belong to the standstill that was reached."""
    return last is not None and all(
        _is_standstill(each)
        and np.array_equal(each.position, last.position)
        and each.gripper_closed == last.gripper_closed
        for each in (last, waiting[0], waiting[1])
    )


def _decaying(error: Array, drift: Array, since: float) -> tuple[Array, Array, Array]:
    """Let an offset of position and velocity die away to rest, as a quintic over `HANDED`."""
    h = OFFSET_DECAY_TIME
    x, e, g = since / h, error, drift * h
    c3, c4, c5 = -10 * e - 6 * g, 15 * e + 8 * g, -6 * e - 3 * g
    p = e + x * (g + x * x * (c3 + x * (c4 + x * c5)))
    v = g + x * x * (3 * c3 + x * (4 * c4 + x * 5 * c5))
    a = x * (6 * c3 + x * (12 * c4 + x * 20 * c5))
    return p, v / h, a / h**2
