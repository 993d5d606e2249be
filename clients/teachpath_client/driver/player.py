"""The player of a driver: what an arm should do now, from the setpoints that have come.

Every setpoint carries the way to rest from there: the motion, one control period apart, that the executor has checked
against all limits. The player plays setpoints a fixed delay behind their nominal time. When the next one is not there
in time, it follows the way to rest of the last one, says so, and takes nothing up until setpoints begin where the arm
rests. So a setpoint that is late, lost or doubled, a burst of them, or an executor that dies, stops the arm on its path
and never makes it jump or run faster than the plan.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, Protocol

import numpy as np

from teachpath_client.driver.interpolation import BLEND_TIME, Array, Quintic, WayToRest, blended
from teachpath_client.driver.least_jerk import LeastJerk
from teachpath_client.driver.output import OutputSwitch, output_of

MAX_QUEUE: Final = 2000  # setpoints that wait at most; with more the sender's clock is wrong
MAX_CLOCK_ERROR: Final = 1.0  # s, of a clock that is so far off that its times cannot be meant
AT_PLACE: Final = 1e-6  # rad, within which two rests are at one place
RESTART_DISTANCE: Final = 2e-3  # rad, from the arm's rest, up to which setpoints begin where it rests
BLEND_DISTANCE: Final = 0.02  # rad, up to which another execution may begin off the commanded position
MAX_GAP: Final = 3  # periods between two setpoints over which the player goes on; a longer gap is a stream that stopped


class SetpointLike(Protocol):
    """What the player reads of a setpoint; `Setpoint` of the wire, decoded to arrays, has all of it."""

    @property
    def cycle(self) -> int:
        """Number of its control period in the execution."""

    @property
    def nominal_ns(self) -> int:
        """When it is due on the clock of the motion [ns]."""

    @property
    def position(self) -> Array:
        """(joints,) [rad]."""

    @property
    def velocity(self) -> Array:
        """(joints,) [rad/s]."""

    @property
    def acceleration(self) -> Array:
        """(joints,) [rad/s^2]."""

    @property
    def gripper_closed(self) -> bool:
        """Whether the gripper is to be closed."""

    @property
    def execution(self) -> str:
        """Id of its execution."""

    @property
    def way_to_rest(self) -> Array:
        """(n, 3, joints) position, velocity, acceleration a period apart, the first behind it, to rest; else empty."""


class PlayerState(StrEnum):
    """What the player does."""

    IDLE = "idle"  # there was no setpoint yet
    PLAYING = "playing"
    STOPPING = "stopping"  # follows the way to rest
    STOPPED = "stopped"  # rests at its end, until setpoints begin there


@dataclass(frozen=True, eq=False)
class TargetMotion:
    """What the arm should do now: (joints,) in rad, rad/s, rad/s^2."""

    position: Array
    velocity: Array
    acceleration: Array


class SetpointPlayer:
    """Plays the setpoints of one arm.

    Args:
        position: (joints,) where the arm rests [rad].
        delay: between a setpoint's nominal time and its playing [s].
        period: between two setpoints, until two have come [s].
    """

    def __init__(self, position: Array | Sequence[float], *, delay: float = 0.03, period: float = 0.004) -> None:
        still = np.zeros(len(position))
        self.state: PlayerState = PlayerState.IDLE
        self.target: TargetMotion = TargetMotion(np.array(position, dtype=np.float64), still, still)
        self.missed: int = 0  # setpoints that never came since the execution began
        self.late: int = 0  # setpoints that came after they should have been played
        self.stops: int = 0  # ways to rest that were followed since the execution began
        self.last_reached: SetpointLike | None = None  # the newest setpoint that was played
        self._delay, self._period = delay, period
        self._queue: deque[SetpointLike] = deque()
        self._output = OutputSwitch()
        self._newest = -1  # cycle of the newest setpoint that was taken
        self._begin_ns = 0  # nominal time from which `_played` counts
        self._played = 0.0  # s
        self._zero_ns = 0  # real time at which `_played` would be 0 without any lateness
        self._piece: Quintic | LeastJerk | None = None
        self._way: WayToRest | None = None
        self._blend: tuple[Array, float] = (still, BLEND_TIME)  # what is left to take up, and since when [s]

    @property
    def execution(self) -> str:
        """The execution that is played, or waits to be; empty when there was none."""
        newest = self._queue[-1] if self._queue else self.last_reached
        return newest.execution if newest is not None else ""

    @property
    def output(self) -> str:
        """Name of the output that is on: that of the setpoint played last; empty while none is played."""
        return self._output.name if self.state is PlayerState.PLAYING else ""

    @property
    def at_rest(self) -> bool:
        """Whether nothing waits to be played and the arm is to stand still."""
        return not (self._queue or self.target.velocity.any() or self.target.acceleration.any())

    def add(self, setpoint: SetpointLike, now_ns: int) -> bool:
        """Take a setpoint that came at `now_ns`; returns whether it is to be played.

        One that is older than those before, or for another number of joints, changes nothing; one that does not begin
        where the arm rests is late.
        """
        if len(setpoint.position) != len(self.target.position):
            return False
        if self.execution != setpoint.execution:
            return self._begin(setpoint, now_ns)
        if setpoint.cycle <= self._newest:
            return False
        if self.state in (PlayerState.STOPPING, PlayerState.STOPPED):
            return self._begin_again(setpoint, now_ns)
        newest = self._queue[-1] if self._queue else self.last_reached
        if newest is None or setpoint.nominal_ns <= newest.nominal_ns:
            return False
        if not self._queue and _is_still(newest) and _is_still(setpoint) and not _same_place(newest, setpoint):
            return self._begin_elsewhere(setpoint, now_ns)
        ahead = setpoint.cycle - self._newest
        if self._time_of(setpoint) <= self._played:
            self.late += 1
        if len(self._queue) >= MAX_QUEUE:
            return False
        self.missed += ahead - 1
        if not _is_still(setpoint):  # the clock of the motion may leap at a standstill
            self._period = (setpoint.nominal_ns - newest.nominal_ns) / 1e9 / ahead
        self._newest = setpoint.cycle
        self._queue.append(setpoint)
        return True

    def advance(self, dt: float, now_ns: int) -> SetpointLike | None:
        """Go on by `dt` [s] of real time to `now_ns`; returns the newest setpoint that was reached, if any."""
        if self.state is PlayerState.IDLE:
            return None
        self._played += dt
        reached = None
        if self.state is PlayerState.PLAYING:
            while self._queue and self._time_of(self._queue[0]) <= self._played and self._follows(self._queue[0]):
                self.last_reached = reached = self._queue.popleft()
            reached = self._skip_standstill(now_ns) or reached
            if not self._queue or not self._follows(self._queue[0]):
                self._stop_if_due()
            self._wait_at_rest()
        self._output.update(self.last_reached, dt, is_fed=bool(self._queue or reached))
        self._aim(dt)
        return reached

    def _begin(self, setpoint: SetpointLike, now_ns: int) -> bool:
        """Begin another execution; the arm rests, and so does its first setpoint, where the arm is."""
        if self.target.velocity.any() or not _is_still(setpoint) or not self._begin_elsewhere(setpoint, now_ns):
            return False
        self.missed = self.late = self.stops = 0
        return True

    def _begin_again(self, setpoint: SetpointLike, now_ns: int) -> bool:
        """Take the execution up again where the arm rests; whatever else comes is late."""
        off = float(np.abs(self.target.position - setpoint.position).max())
        if self.state is not PlayerState.STOPPED or not _is_still(setpoint) or off > RESTART_DISTANCE:
            self._newest = setpoint.cycle
            self.late += 1
            return False
        return self._begin_elsewhere(setpoint, now_ns)

    def _begin_elsewhere(self, setpoint: SetpointLike, now_ns: int) -> bool:
        """Go on within an execution from another place of rest, if it is near: somebody has pushed the arm."""
        off = self.target.position - setpoint.position
        if np.abs(off).max() > BLEND_DISTANCE:
            return False
        self._blend = (off, 0.0)
        self._restart(setpoint, now_ns)
        return True

    def rest_at(self, position: Array | Sequence[float]) -> None:
        """Rest at a measured configuration (joints,) [rad]: somebody has moved the arm while nothing was played.

        Raises:
            ValueError: the player is in motion.
        """
        if not self.at_rest:
            raise ValueError("the player is in motion; it rests where it comes to rest")
        still = np.zeros(len(position))
        self.target = TargetMotion(np.array(position, dtype=np.float64), still, still)
        self.last_reached, self._way, self.state = None, None, PlayerState.IDLE

    def _restart(self, setpoint: SetpointLike, now_ns: int) -> None:
        self._queue.clear()
        self._queue.append(setpoint)
        self._begin_ns, self._newest = setpoint.nominal_ns, setpoint.cycle
        waited = (now_ns - setpoint.nominal_ns) / 1e9
        self._played = (waited if 0.0 <= waited <= MAX_CLOCK_ERROR else 0.0) - self._delay
        self._zero_ns = now_ns - round((self._played + self._delay) * 1e9)
        self.last_reached, self._way, self._piece = None, None, None
        self.state = PlayerState.PLAYING

    def _time_of(self, setpoint: SetpointLike) -> float:
        return (setpoint.nominal_ns - self._begin_ns) / 1e9

    def _follows(self, setpoint: SetpointLike) -> bool:
        """Tell whether the arm may go on to this setpoint from the one that was reached."""
        last = self.last_reached
        near = last is None or setpoint.cycle - last.cycle <= MAX_GAP
        return near or (last is not None and _is_still(last) and _is_still(setpoint))

    def _skip_standstill(self, now_ns: int) -> SetpointLike | None:
        """Skip what waits of a standstill and was due: a player whose machine was busy has lost only time there."""
        reached, due = None, (now_ns - self._zero_ns) / 1e9 - self._delay
        while self._queue and self._time_of(self._queue[0]) <= due and self._next_is_the_same_rest():
            self.last_reached = reached = self._queue.popleft()
            self._played = self._time_of(reached)
        return reached

    def _next_is_the_same_rest(self) -> bool:
        last, following = self.last_reached, self._queue[0]
        return (
            last is not None
            and _is_still(last)
            and _is_still(following)
            and np.array_equal(last.position, following.position)
            and last.gripper_closed == following.gripper_closed
            and output_of(last) == output_of(following)
        )

    def _wait_at_rest(self) -> None:
        """Let no time of the stream pass while the arm rests and nothing waits: what comes late begins from here."""
        last = self.last_reached
        if last is not None and not self._queue and _is_still(last):
            self._played = min(self._played, self._time_of(last))

    def _stop_if_due(self) -> None:
        """Follow the way to rest of the last setpoint, since the next one is not there."""
        last = self.last_reached
        if last is None or (_is_still(last) and not self._queue) or self._time_of(last) > self._played:
            return
        self.stops += 1
        self.late += len(self._queue)
        self._queue.clear()
        self._way = WayToRest(last, self._period)
        self.state = PlayerState.STOPPING

    def _aim(self, dt: float) -> None:
        last = self.last_reached
        if last is None:
            return
        still = np.zeros(len(last.position))
        if self._way is not None:
            since = self._played - self._time_of(last)
            p, v, a = self._way(since)
            if since >= self._way.duration:
                self.state = PlayerState.STOPPED
        elif self._queue:
            if self._piece is None or self._piece.one is not last or self._piece.two is not self._queue[0]:
                gap = self._queue[0].cycle - last.cycle > 1
                self._piece = LeastJerk(last, self._queue[0]) if gap else Quintic(last, self._queue[0])
            p, v, a = self._piece(self._played - self._time_of(last))
        else:
            p, v, a = last.position, still, still
        off, since = self._blend
        if since < BLEND_TIME:
            p, v, a = (value + part for value, part in zip((p, v, a), blended(off, since), strict=True))
            self._blend = (off, since + dt)
        self.target = TargetMotion(p, v, a)


def _same_place(one: SetpointLike, two: SetpointLike) -> bool:
    return bool(np.abs(one.position - two.position).max() <= AT_PLACE)


def _is_still(setpoint: SetpointLike) -> bool:
    return not (setpoint.velocity.any() or setpoint.acceleration.any())
