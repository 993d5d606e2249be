"""The arm's joint states for any number of viewers: decimated and coalesced, so that no viewer slows the arm down."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.wire import decode_setpoint, decode_state
from teachpath.records import JointState
from teachpath_proto.keys import Keys

MAX_QUEUED: Final = 512  # newest messages that wait for a subscriber which does not poll


@dataclass(frozen=True, eq=False)
class JointFrame:
    """The newest joint state, and the largest values since the frame before.

    Attributes:
        state: the newest joint state.
        speed: (joints,) joint velocity of largest size since the frame before [rad/s].
        tracking_error: largest since the frame before [rad].
        lateness: of the setpoints since the frame before, the largest [s], or None when none was sent.
    """

    state: JointState
    speed: tuple[float, ...]
    tracking_error: float
    lateness: float | None


class JointFeed:
    """Receives one arm's joint states and setpoints for any number of subscribers."""

    def __init__(self, bus: Bus, keys: Keys, *, robot: str) -> None:
        self._bus, self._keys, self._robot = bus, keys, robot
        self._lock = threading.Lock()
        self._subscribers: tuple[JointStateSubscriber, ...] = ()
        self._last: bytes | None = None
        self._handles: list[Handle] = []

    def start(self) -> None:
        """Receive from now on."""
        self._handles = [
            self._bus.subscribe(self._keys.state(self._robot), self._receive_state),
            self._bus.subscribe(self._keys.setpoint(self._robot), self._receive_setpoint),
        ]

    def stop(self) -> None:
        """Stop receiving; a second call does nothing."""
        for handle in self._handles:
            handle.close()
        self._handles.clear()

    def subscribe(self) -> JointStateSubscriber:
        """Return a new subscriber, which begins with the newest joint state."""
        subscriber = JointStateSubscriber()
        if self._last is not None:
            subscriber.states.append(self._last)
        with self._lock:
            self._subscribers = (*self._subscribers, subscriber)
        return subscriber

    def unsubscribe(self, subscriber: JointStateSubscriber) -> None:
        """Drop a subscriber that has gone."""
        with self._lock:
            self._subscribers = tuple(o for o in self._subscribers if o is not subscriber)

    # on the transport's threads: append only

    def _receive_state(self, _: str, payload: bytes) -> None:
        self._last = payload
        for subscriber in self._subscribers:
            subscriber.states.append(payload)

    def _receive_setpoint(self, _: str, payload: bytes) -> None:
        for subscriber in self._subscribers:
            subscriber.setpoints.append(payload)


class JointStateSubscriber:
    """Collects what the arm does until it is polled."""

    def __init__(self) -> None:
        self.states: deque[bytes] = deque(maxlen=MAX_QUEUED)
        self.setpoints: deque[bytes] = deque(maxlen=MAX_QUEUED)

    def poll(self) -> JointFrame | None:
        """Return the frame since the last call, or None when no joint state has come."""
        states = [state for payload in _drain(self.states) if (state := _state(payload)) is not None]
        lateness = [late for payload in _drain(self.setpoints) if (late := _lateness(payload)) is not None]
        if not states:
            return None
        return JointFrame(
            states[-1],
            tuple(max((float(s.velocity[k]) for s in states), key=abs) for k in range(len(states[-1].velocity))),
            max(state.tracking_error for state in states),
            max(lateness, default=None),
        )


def _drain(queue: deque[bytes]) -> list[bytes]:
    return [queue.popleft() for _ in range(len(queue))]


def _state(payload: bytes) -> JointState | None:
    try:
        return decode_state(payload)
    except UnusableInput:
        return None  # the next one comes in 10 ms; whoever commands the arm reports it


def _lateness(payload: bytes) -> float | None:
    try:
        setpoint = decode_setpoint(payload)
    except UnusableInput:
        return None
    return (setpoint.sent_ns - setpoint.nominal_ns) * 1e-9
