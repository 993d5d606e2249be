"""The motion with which a driver is checked: a gentle move of all joints, and the way to rest from every setpoint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath_client.driver.interpolation import Array
from teachpath_proto.motion_pb2 import Setpoint

PERIOD: Final = 0.004  # [s] between two setpoints
DURATION: Final = 1.2  # [s] of a move from rest to rest
BRAKING: Final = 0.3  # [s] that the way to rest takes
STANDSTILL: Final = 5  # setpoints at rest before and behind a move
COUNT: Final = round(DURATION / PERIOD) + 2 * STANDSTILL


@dataclass(frozen=True, eq=False)
class Move:
    """A move in a straight line of joint space, as a stream of setpoints of one execution.

    Attributes:
        execution: id of the execution.
        begin: (joints,) where it begins [rad].
        end: (joints,) where it ends [rad].
        first_cycle: number of its first setpoint.
        gripper_closed: whether the gripper is to be closed.
    """

    execution: str
    begin: Array
    end: Array
    first_cycle: int = 0
    gripper_closed: bool = False

    @property
    def top_speed(self) -> Array:
        """(joints,) largest speeds [rad/s]."""
        return np.asarray(1.875 * np.abs(self.end - self.begin) / DURATION)

    def setpoint(self, index: int, begin_ns: int) -> Setpoint:
        """Return the setpoint `index` of the move, of `COUNT`, when the first is due at `begin_ns`."""
        time = (index - STANDSTILL) * PERIOD
        moving = 0.0 < time < DURATION
        share, rate, change = _profile(time)
        travel = self.end - self.begin
        places, velocities, accelerations = self._packed_way_to_rest(time) if moving else (b"", b"", b"")
        return Setpoint(
            cycle=self.first_cycle + index,
            nominal_ns=begin_ns + round(1e9 * index * PERIOD),
            sent_ns=begin_ns + round(1e9 * index * PERIOD),
            position=self.begin + share * travel,
            velocity=rate * travel,
            acceleration=change * travel,
            gripper_closed=self.gripper_closed,
            execution=self.execution,
            way_to_rest=places,
            way_to_rest_velocity=velocities,
            way_to_rest_acceleration=accelerations,
        )

    def stopped_at(self, index: int) -> StoppedMove:
        """Return this move with a stop that begins behind setpoint `index`."""
        return StoppedMove(self.execution, self.begin, self.end, self.first_cycle, self.gripper_closed, index)

    def rest_of(self, cycle: int) -> Array:
        """Return where (joints,) the way to rest of setpoint `cycle` ends [rad]."""
        time = (cycle - self.first_cycle - STANDSTILL) * PERIOD
        if not 0.0 < time < DURATION:
            return self.begin if time <= 0.0 else self.end
        return np.asarray(self._way_to_rest(time)[-1, 0])

    def _way_to_rest(self, time: float) -> Array:
        """Return states (n, 3, joints) along the same line, on which the rate falls smoothly to zero."""
        x = np.arange(1, round(BRAKING / PERIOD) + 1) * PERIOD / BRAKING
        ahead = BRAKING * (x - (x**6 - 3 * x**5 + 2.5 * x**4))
        pace, slope = 1 - (10 * x**3 - 15 * x**4 + 6 * x**5), -30 * (x**2 - 2 * x**3 + x**4) / BRAKING
        share, rate, change = np.transpose([_profile(time + each) for each in ahead])
        states = np.stack([share, rate * pace, change * pace**2 + rate * slope], axis=1)
        return np.asarray(states[:, :, None] * (self.end - self.begin) + [self.begin, *np.zeros((2, len(self.begin)))])

    def _packed_way_to_rest(self, time: float) -> tuple[bytes, bytes, bytes]:
        places, velocities, accelerations = np.moveaxis(self._way_to_rest(time).astype("<f8"), 1, 0)
        return places.tobytes(), velocities.tobytes(), accelerations.tobytes()


@dataclass(frozen=True, eq=False)
class StoppedMove(Move):
    """A move that somebody stops: its setpoints come to rest on their line, and then stand still.

    Attributes:
        last: index of the last setpoint that knows nothing of the stop.
    """

    last: int = COUNT

    @property
    def rest(self) -> Array:
        """(joints,) where it rests [rad]."""
        return self.rest_of(self.first_cycle + self.last)

    def setpoint(self, index: int, begin_ns: int) -> Setpoint:
        """Return the setpoint `index`; behind the last one, a state of that one's way to rest with what is left."""
        setpoint = super().setpoint(min(index, self.last), begin_ns)
        if index <= self.last:
            return setpoint
        ways = (setpoint.way_to_rest, setpoint.way_to_rest_velocity, setpoint.way_to_rest_acceleration)
        places, velocities, accelerations = (np.frombuffer(way, "<f8").reshape(-1, len(self.end)) for way in ways)
        row, is_over = min(index - self.last, len(places)) - 1, index - self.last >= len(places)
        still = np.zeros(len(self.end))
        return Setpoint(
            cycle=self.first_cycle + index,
            nominal_ns=begin_ns + round(1e9 * index * PERIOD),
            sent_ns=begin_ns + round(1e9 * index * PERIOD),
            position=places[row],
            velocity=still if is_over else velocities[row],
            acceleration=still if is_over else accelerations[row],
            gripper_closed=self.gripper_closed,
            execution=self.execution,
            way_to_rest=places[row + 1 :].tobytes(),
            way_to_rest_velocity=velocities[row + 1 :].tobytes(),
            way_to_rest_acceleration=accelerations[row + 1 :].tobytes(),
        )


def _profile(time: float) -> tuple[float, float, float]:
    """Return the share of the move that is done at `time` [s], and its first and second derivative."""
    x = min(max(time / DURATION, 0.0), 1.0)
    share = 10 * x**3 - 15 * x**4 + 6 * x**5
    rate = (30 * x**2 - 60 * x**3 + 30 * x**4) / DURATION
    change = (60 * x - 180 * x**2 + 120 * x**3) / DURATION**2
    return share, rate, change
