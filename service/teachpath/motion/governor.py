"""Drives the length s along a path, live: any override, hold and resume, within the limits and never off the path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ruckig import Trajectory

from teachpath.motion.timing import Limits, State, extremes, rest_to_rest, to_position, to_speed

# How far Ruckig's answer may leave [here, end], as a share of the whole length: rounding, not motion.
SLACK: Final = 1e-7
SLOWEST: Final = 0.01  # an override below this holds


@dataclass(frozen=True, slots=True)
class Progress:
    """The state of s: length, speed, acceleration; `standing` at rest, `finished` at rest at the end."""

    s: float
    speed: float
    acceleration: float
    standing: bool
    finished: bool


class Governor:
    """Ruckig's one-dimensional problem, solved again whenever the operator's wish changes.

    A new answer is followed only after it has been checked: finite, not endless, within [here, end] and within the
    limits. Otherwise the answer being followed, which was checked and ends at rest, stays; the wish is tried again
    in the next period. So the state is always on a verified way to rest on the path.
    """

    def __init__(self, end: float, limits: Limits, *, override: float = 1.0, start: float = 0.0) -> None:
        self._end, self._limits = end, limits
        self._override = _share(override)
        self._held = False
        self._way: tuple[Trajectory, ...] = ()  # followed one behind the other, to rest
        self._elapsed = 0.0
        self._state: State = (start, 0.0, 0.0)
        self._wish_open = True

    @property
    def override(self) -> float:
        """The share of the full speed now asked for, 0 to 1."""
        return self._override

    @property
    def held(self) -> bool:
        """Whether rest was asked for, by `hold` or an override of zero."""
        return self._held or self._override < SLOWEST

    @property
    def progress(self) -> Progress:
        """The present state."""
        s, speed, acceleration = self._state
        standing = not self._way
        return Progress(s, speed, acceleration, standing, standing and s >= self._end - SLACK * self._end)

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed from now on, clipped to 0 to 1; zero holds."""
        self._override = _share(share)
        self._wish_open = True

    def hold(self) -> None:
        """Come to rest as soon as the limits allow."""
        self._held = True
        self._wish_open = True

    def resume(self) -> None:
        """Go on to the end."""
        self._held = False
        self._wish_open = True

    def step(self, dt: float) -> Progress:
        """Advance by one control period of `dt` [s]; never raises."""
        if self._wish_open:
            self._wish_open = not self._solve()
        self._elapsed += dt
        while self._way and self._elapsed >= self._way[0].duration:
            self._elapsed -= self._way[0].duration
            last, self._way = self._way[0], self._way[1:]
            self._state = (min(last.at_time(last.duration)[0][0], self._end), 0.0, 0.0)
        if self._way:
            (s,), (speed,), (acceleration,) = self._way[0].at_time(self._elapsed)
            self._state = (min(s, self._end), speed, acceleration)
        return self.progress

    def _solve(self) -> bool:
        if not self._way and (self.held or self.progress.finished):
            return True
        way = self._rest() if self.held else self._onward()
        if way is None:
            return False
        self._way, self._elapsed = way, 0.0
        return True

    def _rest(self) -> tuple[Trajectory, ...] | None:
        brake = to_speed(self._state, self._limits, 0.0)
        return (brake,) if brake is not None and self._verified(brake) else None

    def _onward(self) -> tuple[Trajectory, ...] | None:
        target = self._override * self._limits.velocity
        s, speed, acceleration = self._state
        way: tuple[Trajectory, ...] = ()
        # Ruckig brakes a state that is too fast for its limit at full deceleration and comes out of that below zero
        # speed, so slowing down is a problem of its own, in front.
        if speed + max(acceleration, 0.0) ** 2 / (2 * self._limits.jerk) > target * (1 + 1e-9):
            slower = to_speed(self._state, self._limits, target)
            if slower is None or not self._verified(slower):
                return None
            way = (slower,)
            s, speed, acceleration = slower.at_time(slower.duration)[0][0], target, 0.0
        last = to_position((s, speed, acceleration), self._end, self._limits, target)
        if last is None or not self._verified(last):
            return None
        if abs(last.at_time(last.duration)[0][0] - self._end) > SLACK * self._end:
            return None
        return (*way, last)

    def _verified(self, answer: Trajectory) -> bool:
        box = self._limits
        slowest = Limits(max(self._override, SLOWEST) * box.velocity, box.acceleration, box.jerk)
        endless = 2 * rest_to_rest(self._end, slowest) + 2 * (
            box.velocity / box.acceleration + box.acceleration / box.jerk
        )
        least, fastest, hardest = extremes(answer)
        slack = SLACK * self._end
        return (
            answer.duration <= endless
            and answer.position_extrema[0].max <= self._end + slack
            and least >= -SLACK * box.velocity
            and fastest <= box.velocity * (1 + 1e-6)
            and hardest <= box.acceleration * (1 + 1e-6)
        )


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0) if value == value else 0.0
