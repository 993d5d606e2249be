"""Checks a driver against the contract that setpoints and joint states have, one rule after the other.

The check takes the executor's place: it moves the arm by a fifth of a radian in every joint, there and back, and lets
its setpoints come late, doubled, in bursts or not at all. What the arm reports is judged by the move it was sent.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final, Protocol

import numpy as np

from teachpath_client.driver.check_motion import COUNT, PERIOD, Move
from teachpath_client.driver.interpolation import Array
from teachpath_client.driver.messages import JOINT_COUNTS, needed_joints
from teachpath_client.verdict import Verdict
from teachpath_proto.motion_pb2 import JointState

TRAVEL: Final = 0.2  # [rad] of every joint
SETTLING_TIME: Final = 1.0  # [s] behind a move, in which every driver should have played it to its end
SPEED_EXCESS: Final = 1.2  # share of the top speed that a measurement may show
SPEED_NOISE: Final = 0.03  # [rad/s] of a measured speed at rest
MIN_STATES: Final = 20  # joint states in a second, at rest
OPENING_NOISE: Final = 0.002  # [m] of a measured distance between fingers
MAX_OPENING: Final = 0.5  # [m] between fingers; more are millimetres or a share
MAX_LATENESS: Final = 0.015  # [s] of the check itself, by which it may send a setpoint late
MAX_ATTEMPTS: Final = 20  # at one rule, on a machine that is busy
JUMP: Final = 0.4  # [rad] elsewhere, where an execution may not begin

Arrivals = Callable[[int], list[float]]  # of a setpoint: its copies come so late [s]


class Bench(Protocol):
    """Time, and both directions of the bus; real, or a twin with a time of its own."""

    @property
    def states(self) -> list[JointState]:
        """All joint states that came, in order."""

    def now_ns(self) -> int:
        """Return the time since the Unix epoch [ns]."""

    def wait_until(self, time_ns: int) -> None:
        """Wait until that time [ns]."""

    def publish(self, payload: bytes) -> None:
        """Publish a setpoint."""


@dataclass
class DriverCheck:
    """Runs the rules on one driver.

    Args:
        bench: how the driver is reached.
        tolerance: by which a joint may be off its setpoint while it follows [rad].
    """

    bench: Bench
    tolerance: float = 0.02
    _home: Array = field(init=False)
    _away: bool = field(init=False, default=False)
    _lateness: float = field(init=False, default=0.0)  # of the check itself, in this attempt [s]

    def run(self) -> Iterator[Verdict]:
        """Yield the verdict of every rule, as soon as it is known; the arm rests between two."""
        fault = self._speaks()
        yield Verdict("says where the arm is, at least 20 times a second, enabled and without a fault", fault)
        if fault:
            return
        self._home = self._position()
        for rule, find_fault in self._rules().items():
            yield Verdict(rule, self._attempted(find_fault))

    def _rules(self) -> dict[str, Callable[[], str]]:
        return {
            "follows a move, no faster than it was sent": lambda: self._follows(on_time),
            "comes to rest on the way when setpoints end, says so, and goes on from there": self._starves,
            "comes to rest where it is stopped on the way, and goes on from there": self._stops,
            "follows an executor that begins anew, with numbers from zero, where the arm rests": self._restarts,
            "is made no faster by a burst of overdue setpoints": self._takes_no_burst,
            "plays setpoints once that come twice and out of order": lambda: self._follows(doubled),
            "goes on over single setpoints that are lost": lambda: self._follows(with_losses),
            "leaves out what is no setpoint": lambda: self._follows(on_time, rubbish=True),
            "does not begin an execution that begins elsewhere": self._begins_nowhere_else,
            "says whether the gripper is closed, and if it can, how far open": self._reports_gripper,
        }

    def _attempted(self, find_fault: Callable[[], str]) -> str:
        """Judge by an attempt in which the check itself was in time."""
        for _ in range(MAX_ATTEMPTS):
            self._lateness = 0.0
            fault = find_fault()
            if not fault or self._lateness <= MAX_LATENESS:
                return fault
        return f"this machine is too busy: setpoints were sent {self._lateness:.3f} s late; check on a quiet one"

    def _speaks(self) -> str:
        before = len(self.bench.states)
        self._wait(1.0)
        came = self.bench.states[before:]
        if len(came) < MIN_STATES:
            return f"{len(came)} joint states came in a second; {MIN_STATES} are needed"
        for state in came:
            arrays, count = (state.position, state.velocity, state.torque), len(came[0].position)
            if count not in JOINT_COUNTS or not all(len(v) == count and np.isfinite(v).all() for v in arrays):
                return f"a joint state has no {needed_joints(count)} finite numbers: {', '.join(map(str, arrays))}"
        last = came[-1]
        if last.fault or last.protective_stop or not last.enabled:
            return f"enabled {last.enabled}, protective stop {last.protective_stop}, fault {last.fault or 'none'}"
        return ""

    def _follows(self, arrivals: Arrivals, *, rubbish: bool = False) -> str:
        move = self._next_move()
        came = self._play(move, arrivals, rubbish=rubbish)
        return self._too_fast(move, came) or self._off_line(move, came) or self._not_at(move.end)

    def _starves(self) -> str:
        move = self._next_move()
        middle = COUNT // 2
        came = self._play(move, lambda index: [0.0] if index < middle else [])
        fault = self._too_fast(move, came) or self._off_line(move, came) or self._not_resting(move, middle)
        if fault:
            return fault
        onward = Move(move.execution, move.rest_of(came[-1].cycle), move.end, move.first_cycle + COUNT)
        came = self._play(onward, on_time)
        return self._too_fast(onward, came) or self._not_at(onward.end)

    def _stops(self) -> str:
        move = self._next_move().stopped_at(COUNT // 2)
        came = self._play(move, on_time)
        fault = self._too_fast(move, came) or self._off_line(move, came) or self._not_at(move.rest)
        onward = Move(move.execution, move.rest, move.end, move.first_cycle + COUNT)
        came = self._play(onward, on_time)
        return fault or self._too_fast(onward, came) or self._off_line(onward, came) or self._not_at(onward.end)

    def _restarts(self) -> str:
        move = self._next_move()
        middle = COUNT // 2
        came = self._play(move, lambda index: [0.0] if index < middle else [])
        fault = self._off_line(move, came) or self._not_resting(move, middle)
        anew = Move(_new_id(), self._position() if fault else move.rest_of(came[-1].cycle), move.end)
        came = self._play(anew, on_time)
        return fault or self._too_fast(anew, came) or self._off_line(anew, came) or self._not_at(anew.end)

    def _takes_no_burst(self) -> str:
        move = self._next_move()
        middle, late = COUNT // 2, 0.5
        came = self._play(move, lambda index: [0.0 if index < middle else max(late - (index - middle) * PERIOD, 0.0)])
        fault = self._too_fast(move, came) or self._off_line(move, came)
        rest = move.rest_of(came[-1].cycle) if came[-1].stopped else move.end
        self._play(Move(move.execution, rest, move.end, move.first_cycle + 2 * COUNT), on_time)  # to where rules begin
        return fault or self._not_at(move.end)

    def _begins_nowhere_else(self) -> str:
        begin, before = self._position(), len(self.bench.states)
        elsewhere = begin + np.where(begin > 0, -JUMP, JUMP)
        self._play(Move(_new_id(), elsewhere, begin), on_time)
        moved = max(float(np.abs(np.array(s.position) - begin).max()) for s in self.bench.states[before:])
        return "" if moved <= self.tolerance else f"it moved by {moved:.3f} rad; it should have stayed where it was"

    def _reports_gripper(self) -> str:
        openings: list[float | None] = []
        for closed in (True, False):
            move = self._next_move(gripper_closed=closed)
            newest = self._play(move, on_time)[-1]
            if newest.gripper_closed != closed:
                return f"it should be {'closed' if closed else 'open'}, and is reported as the contrary"
            openings.append(newest.gripper_opening if newest.HasField("gripper_opening") else None)
        return _opening_fault(*openings)

    def _next_move(self, *, gripper_closed: bool = False) -> Move:
        """Return a move away from where the arm was first, or back."""
        self._away = not self._away
        end = self._home + np.where(self._home > 0, -TRAVEL, TRAVEL) if self._away else self._home
        return Move(_new_id(), self._position(), end, gripper_closed=gripper_closed)

    def _play(self, move: Move, arrivals: Arrivals, *, rubbish: bool = False) -> list[JointState]:
        """Send the setpoints of a move as they arrive, wait until it must be over, and return what the arm said."""
        before, begin_ns = len(self.bench.states), self.bench.now_ns()
        coming = sorted((index * PERIOD + late, index) for index in range(COUNT) for late in arrivals(index))
        for time, index in coming:
            self.bench.wait_until(begin_ns + round(1e9 * time))
            self._lateness = max(self._lateness, (self.bench.now_ns() - begin_ns) / 1e9 - time)
            self.bench.publish(move.setpoint(index, begin_ns).SerializeToString())
            if rubbish and (index % 10 == 0 or index == COUNT - 1):
                broken = move.setpoint(index + 1, begin_ns)
                broken.position[2] = float("nan")
                self.bench.publish(broken.SerializeToString())
                self.bench.publish(b"\xff\xff rubbish")
        self._wait(SETTLING_TIME)
        return self.bench.states[before:]

    def _wait(self, seconds: float) -> None:
        self.bench.wait_until(self.bench.now_ns() + round(1e9 * seconds))

    def _position(self) -> Array:
        """Return where the arm is, as far as it says so in numbers."""
        said = (np.array(state.position) for state in reversed(self.bench.states))
        return next(position for position in said if np.isfinite(position).all())

    def _too_fast(self, move: Move, came: list[JointState]) -> str:
        limit = SPEED_EXCESS * move.top_speed + SPEED_NOISE
        stamps = np.array([state.stamp_ns for state in came]) / 1e9
        positions = np.array([state.position for state in came])
        spans = np.maximum(stamps[3:] - stamps[:-3], 1e-3)  # over three states: the stamps of a busy machine are uneven
        speeds = np.abs(positions[3:] - positions[:-3]) / spans[:, None]
        over = speeds - limit
        joint = int(over.max(axis=0).argmax())
        if not over[:, joint].max() > 0:
            return ""
        return f"joint {joint + 1} ran at {speeds[:, joint].max():.2f} rad/s; it was sent {move.top_speed[joint]:.2f}"

    def _off_line(self, move: Move, came: list[JointState]) -> str:
        travel = move.end - move.begin
        ahead = np.array([state.position for state in came]) - move.begin
        share = np.clip(ahead @ travel / max(float(travel @ travel), 1e-12), 0.0, 1.0)
        off = float(np.abs(ahead - share[:, None] * travel).max())
        return "" if off <= self.tolerance else f"a joint was {off:.3f} rad off its way, over {self.tolerance:g}"

    def _not_resting(self, move: Move, last: int) -> str:
        newest = self.bench.states[-1]
        if not (newest.holding and newest.stopped):
            return f"holding {newest.holding}, stopped {newest.stopped}: it should say that it rests at a way's end"
        if newest.execution != move.execution or not 0 <= newest.cycle - move.first_cycle < last:
            return f"it rests on the way of setpoint {newest.cycle} of {newest.execution!r}, which was not sent"
        return self._not_at(move.rest_of(newest.cycle))

    def _not_at(self, goal: Array) -> str:
        newest = self.bench.states[-1]
        off = float(np.abs(np.array(newest.position) - goal).max())
        speed = float(np.abs(newest.velocity).max())
        if not off <= self.tolerance:  # nor is it where it should be, if it is no number
            return f"it rests {off:.3f} rad from where it should, over {self.tolerance:g}"
        return f"it still moves at {speed:.2f} rad/s" if speed > SPEED_NOISE else ""


def _opening_fault(closed: float | None, opened: float | None) -> str:
    """Judge the distances between the fingers of an empty gripper [m]; None where it does not measure them."""
    if closed is None and opened is None:
        return ""
    if closed is None or opened is None:
        return "it says how far its fingers are apart at times only; it should do so always, or never"
    if closed + OPENING_NOISE >= 0.0 and closed < opened <= MAX_OPENING:
        return ""
    return (
        f"closed on nothing it measures {closed:g} m between its fingers, open {opened:g} m; it should be 0 m where "
        f"they touch, more when they are open, and at most {MAX_OPENING:g} m"
    )


def on_time(_: int) -> list[float]:
    """Every setpoint comes once, as it is sent."""
    return [0.0]


def doubled(index: int) -> list[float]:
    """Setpoints come twice, and pairs of them in reverse order."""
    return [PERIOD * 1.5 if index % 2 else 0.0, PERIOD * 2]


def with_losses(index: int) -> list[float]:
    """One setpoint in twenty never comes."""
    return [] if index % 20 == 13 else [0.0]


def _new_id() -> str:
    return f"check-{uuid.uuid4().hex[:8]}"
