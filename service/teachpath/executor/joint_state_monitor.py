"""What the executor hears of the arm: its newest joint state, how long it has been silent, whether it obeys."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable

from teachpath.errors import Unreachable, UnusableInput
from teachpath.io import wire
from teachpath.records import JointState

log = logging.getLogger(__name__)


class JointStateMonitor:
    """Keeps the newest joint state.

    Args:
        robot: name of the arm.
        silence: after which it counts as gone [s].
        clock: monotonic nanoseconds.
    """

    def __init__(self, robot: str, silence: float, clock: Callable[[], int]) -> None:
        self._robot, self._silence, self._clock = robot, silence, clock
        self._payloads: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._latest: tuple[int, JointState] | None = None

    def receive(self, _: str, payload: bytes) -> None:
        """Take a joint state from the bus; it is read by the loop, and by who asks where the arm is."""
        self._payloads.append((self._clock(), payload))

    def poll(self) -> None:
        """Read what came."""
        try:
            when, payload = self._payloads.pop()
            self._latest = (when, wire.decode_state(payload))
        except IndexError:
            return
        except UnusableInput as error:
            log.warning("left out: %s", error)

    def latest(self, now: int) -> tuple[float, JointState] | None:
        """Return how long the arm has been silent [s] and what it said last, or None when it never spoke."""
        return None if self._latest is None else ((now - self._latest[0]) / 1e9, self._latest[1])

    def current(self) -> JointState:
        """Return how the arm stands now; raises Unreachable when it is silent."""
        self.poll()
        heard = self.latest(self._clock())
        if heard is None or heard[0] > self._silence:
            raise Unreachable(f"no joint state from {self._robot}; is the simulator or the arm's driver running?")
        return heard[1]


class SetpointStallDetector:
    """Notices an arm that speaks, but takes up no setpoints any more."""

    def __init__(self) -> None:
        self._newest = ("", -1)
        self._since = 0

    def stall_duration(self, now: int, execution: str, arm: JointState) -> float:
        """Return for how long the arm has taken up no further setpoint of an execution [s]."""
        newest = (execution, arm.cycle if arm.execution == execution else -1)
        if newest != self._newest:
            self._newest, self._since = newest, now
        return (now - self._since) / 1e9

    def restart(self, now: int) -> None:
        """Count from now on: nothing is sent to the arm."""
        self._since = now
