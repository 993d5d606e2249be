"""Monitors the arm: its newest joint state, how long it has been silent, and whether it takes up setpoints."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.errors import Conflict, Unreachable, UnusableInput
from teachpath.io import wire
from teachpath.records import Array, JointState

log: logging.Logger = logging.getLogger(__name__)

REFUSAL_INTERVAL_NS: Final = 1_000_000_000  # [ns] between two words in the log about states that cannot be used
MAX_LISTENED_NS: Final = 50_000_000  # [ns] of silence that one look counts at most: who oversleeps hears nothing

# [ns] of listening after which a driver that is announced no more has ended, if this session still has a line: where
# that is cut, all that was announced goes some milliseconds before the line itself is known to be gone.
LOSS_TIME_NS: Final = 100_000_000


@dataclass(frozen=True, slots=True)
class Absence:
    """Why nothing is heard of an arm, as the beginning of a sentence, and whether its execution ends by that."""

    reason: str
    is_final: bool


class JointStateMonitor:
    """Keeps the newest joint state of one arm.

    An arm is silent for as long as the control loop has listened in vain: a loop that oversleeps, and with it the
    threads that receive, knows nothing of the arm meanwhile.

    Args:
        robot: name of the arm.
        joints: number of the arm's joints.
        silence: without a joint state after which the arm counts as gone [s].
        clock: returns monotonic nanoseconds.

    Attributes:
        has_lost_driver: whether an announced driver of the arm left the bus since this was last set to False.
        listened_ns: for how long the control loop has listened in all, at its newest look [ns].
    """

    def __init__(self, robot: str, joints: int, silence: float, clock: Callable[[], int]) -> None:
        self.robot: str = robot
        self._joints = joints
        self._silence = silence
        self._clock = clock
        self._payloads: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._latest: tuple[int, int, JointState] | None = None  # when it came, `listened_ns` then, and the state
        self._looked_ns = clock()
        self._refused_ns = -REFUSAL_INTERVAL_NS  # when a joint state was last said to be refused
        self._lost_ns = -1  # when its driver left: what came before is no state of the next one
        self._lost_listened_ns = 0  # `listened_ns` when that was noticed first
        self.has_lost_driver: bool = False
        self.listened_ns: int = 0

    def on_liveliness(self, _: str, alive: bool) -> None:
        """Take note of a driver that comes or goes."""
        if alive:
            return
        if not self.has_lost_driver:
            self._lost_listened_ns = self.listened_ns
        self._lost_ns, self.has_lost_driver = self._clock(), True

    def receive(self, _: str, payload: bytes) -> None:
        """Take a message from the bus; `poll` decodes it, on the caller's thread."""
        self._payloads.append((self._clock(), payload))

    def look(self, now: int) -> None:
        """Look for a message at `now` [ns]; called in each cycle of the control loop."""
        self.listened_ns += min(now - self._looked_ns, MAX_LISTENED_NS)
        self._looked_ns = now
        self.poll()

    def poll(self) -> None:
        """Decode the newest message, if one has come since the last call."""
        try:
            came_ns, payload = self._payloads.pop()
            state = wire.decode_state(payload)
            if len(state.position) != self._joints:
                raise UnusableInput(_other_arm(len(state.position), self._joints))
            self._latest = (came_ns, self.listened_ns, state)
        except IndexError:
            return
        except UnusableInput as error:
            if came_ns - self._refused_ns > REFUSAL_INTERVAL_NS:
                log.warning("left out: %s", error)
                self._refused_ns = came_ns

    def latest(self, now: int) -> tuple[float, JointState] | None:
        """Return how long nothing was heard of the present driver at `now` [s], and its newest joint state, if any."""
        newest = self._latest
        if newest is None or newest[0] <= self._lost_ns:
            return None
        came_ns, listened_ns, state = newest
        return min(now - came_ns, self.listened_ns - listened_ns) / 1e9, state

    def absence(self, now: int, timeout: float, is_joined: Callable[[], bool]) -> Absence:
        """Say why nothing is heard of the arm at `now` [ns].

        Args:
            timeout: for which it may be silent [s].
            is_joined: tells whether this session has a line to the bus.
        """
        if not self.has_lost_driver:
            latest = self.latest(now)
            silence = latest[0] if latest else 0.0
            is_final = silence > timeout
            length = f"{silence:.{1 if is_final else 2}f} s"
            return Absence(f"no joint state for {length}: is the arm's driver running?", is_final)
        if self.listened_ns - self._lost_listened_ns < LOSS_TIME_NS:
            return Absence(f"nothing is heard of the driver of {self.robot} any more: is it running?", False)
        if is_joined():
            return Absence(f"the driver of {self.robot} has ended:", True)
        return Absence("the executor's own line to the bus is cut, and nothing is heard of the arm:", True)

    def current(self) -> JointState:
        """Return the arm's present joint state.

        Raises:
            Conflict: the arm can follow no setpoint; why, and the way out.
            Unreachable: the arm is silent.
        """
        self.poll()
        newest, now = self._latest, self._clock()
        if newest is None or newest[0] <= self._lost_ns or now - newest[0] > self._silence * 1e9:
            raise Unreachable(f"no joint state from {self.robot}; is the simulator or the arm's driver running?")
        state = newest[2]
        if state.inability:
            raise Conflict(state.inability)
        return state

    def resting_q(self, max_speed: float) -> Array:
        """Return the configuration (joints,) in which the arm rests [rad].

        Args:
            max_speed: of a joint that counts as resting [rad/s].

        Raises:
            Conflict: the arm still moves, or can follow no setpoint.
            Unreachable: the arm is silent.
        """
        arm = self.current()
        speed = float(np.abs(arm.velocity).max())
        if speed > max_speed:
            raise Conflict(f"the arm still moves at {speed:.2f} rad/s; wait until it rests")
        return arm.position


def _other_arm(joints: int, needed: int) -> str:
    return f"a joint state has {joints} joints, and this station's arm {needed}: is it the driver of another arm?"


class SetpointStallDetector:
    """Notices an arm that publishes its state and yet takes up no setpoints any more."""

    def __init__(self) -> None:
        self._newest = ("", -1)  # execution, and cycle of the newest setpoint that the arm has taken up
        self._since = 0

    def stall_duration(self, now: int, execution: str, arm: JointState, untaken: float) -> float:
        """Return for how long the arm has taken up no further setpoint of an execution [s].

        Args:
            untaken: time for which setpoints were sent that it has not taken up [s]; while this executor oversleeps it
                sends none, and the arm can take none up.
        """
        newest = (execution, arm.cycle if arm.execution == execution else -1)
        if newest != self._newest:
            self._newest, self._since = newest, now
        return min((now - self._since) / 1e9, untaken)

    def restart(self, now: int) -> None:
        """Measure from `now` on; call it while no setpoints are sent."""
        self._since = now
