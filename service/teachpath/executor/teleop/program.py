"""A live hand that drives the arm: tool and gripper mirror it while the clutch is pressed, and rest otherwise."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

import numpy as np

from teachpath.errors import Conflict
from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.teleop.clutch import CLUTCH_BUTTON, Clutch, RemoteClutch, decode_tracked
from teachpath.executor.teleop.gripper import GripperFollower, observed_load
from teachpath.io.bus import Bus
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.execution.segments import Detour, MotionState
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.settings import MotionSettings
from teachpath.recording.demonstration import to_world
from teachpath.records import Array, Sample, TeleopRequest
from teachpath_proto.keys import Keys

MAX_LATENCIES: Final = 5000  # latencies
LATE_ARM_HINT: Final = "the arm is late; let the clutch go and press it again"


class TeleopProgram:
    """Drives an execution by the samples of one tracker, as a program does.

    Args:
        order: tracker, who presses its clutch, calibration, scene and scale.
        start_q: (6,) where the arm rests [rad].
        joint_states: monitor of the arm, which says what its gripper does and where the object is.
        period: between two setpoints [s].
        silence: after which the hand is lost, or who presses its clutch [s].
        clock: monotonic nanoseconds.

    Raises:
        PathRefused: the arm stands where it can follow nothing.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        order: TeleopRequest,
        start_q: Array,
        settings: MotionSettings,
        *,
        joint_states: JointStateMonitor,
        period: float,
        silence: float,
        clock: Callable[[], int],
    ) -> None:
        self._order, self._clock, self._joint_states = order, clock, joint_states
        self._silence_ns = silence * 1e9  # [ns]
        self._gripper = GripperFollower(joint_states.current().gripper_closed)
        model = CollisionModel(order.scene)
        self._follower = TeleopFollower(model, start_q, settings, scale=order.scale, share=order.share, period=period)
        if order.scene.carried is not None:
            self._follower.load = Load(position=order.scene.carried.position)
        still = np.zeros(6)
        self._state = MotionState(np.array(start_q), still, still, self._gripper.closed)
        self._newest: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._last_seen_ns = 0  # [ns of the clock] when the newest tracked sample came
        self._clutch = Clutch()
        self._remote_clutch = RemoteClutch(bus, keys, order.clutch, clock) if order.clutch else None
        self._latencies: deque[float] = deque(maxlen=MAX_LATENCIES)
        self._answered_stamp = 0
        self._handle = bus.subscribe(keys.samples(order.tracker), self._receive)

    before_path = waiting = False
    finished = False
    progress = 0.0
    arc_length = 0.0
    override = 1.0

    @property
    def at_rest(self) -> bool:
        """Whether the nominal motion is at rest."""
        return self._follower.at_rest

    @property
    def held(self) -> bool:
        """Whether the clutch is open, or a hold was asked for."""
        return not self._clutch.engaged

    @property
    def hold_requested(self) -> bool:
        """Whether `hold` was asked for and not taken back."""
        return self._clutch.hold_requested

    @property
    def hold_reason(self) -> str:
        """Why the arm does not follow, in words."""
        return self._clutch.reason

    @property
    def current_q(self) -> Array:
        """The newest setpoint's configuration (6,) [rad]."""
        return self._state.position

    @property
    def activity(self) -> str:
        """What it does, and why the tool is not where the hand is."""
        following = f"mirroring {self._order.tracker}"
        return f"{following}: {self._follower.reason}" if self._clutch.engaged and self._follower.reason else following

    @property
    def location(self) -> str:
        """Where it is, in words."""
        return f"while mirroring {self._order.tracker}"

    @property
    def latency(self) -> tuple[float, float]:
        """Median and 99th percentile of the time from a sample's coming to the setpoint that answers it [us]."""
        if not self._latencies:
            return 0.0, 0.0
        p50, p99 = np.percentile(np.array(self._latencies), (50, 99))
        return float(p50), float(p99)

    def step(self) -> MotionState:
        """Advance by one control period; never raises."""
        now = self._clock()
        if self._remote_clutch is not None:
            self._remote_clutch.poll()
        if self._newest:
            self._take_sample(*self._newest.pop())
        if self._clutch.engaged:
            self._check_presence(now)
        position, velocity, acceleration = self._follower.step()
        if self._follower.answered_stamp != self._answered_stamp:
            self._answered_stamp = self._follower.answered_stamp
            self._latencies.append((now - self._answered_stamp) / 1e3)
        self._state = MotionState(position, velocity, acceleration, self._gripper.closed)
        return self._state

    def advance_planning(self) -> None:
        """Do one piece of the work that leads to the next motion."""
        self._follower.advance_planning()

    def hold(self) -> None:
        """Open the clutch until `resume`."""
        self._clutch.hold()
        self._follower.disengage()

    def set_waiting(self, waiting: bool) -> None:
        """Open the clutch: the arm is late, and would be where the hand no longer is."""
        if waiting and self._clutch.engaged:
            self._clutch.disengage(LATE_ARM_HINT)
            self._follower.disengage()

    def resume(self) -> None:
        """Let the clutch be pressed again."""
        self._clutch.resume()

    def reverse(self) -> None:
        """Hold: a hand's way is not kept."""
        self.hold()

    def set_override(self, share: float) -> None:
        """Hold at zero; a hand has its own speed."""
        if share <= 0.0:
            self.hold()

    def plan_step(self, *, length: float = 0.0, nodes: int = 0) -> Detour:
        """Raise Conflict: a live hand has no path."""
        raise Conflict("a live hand has no path to step on; stop it, and run a plan")

    def plan_return(self, start_q: Array) -> Detour:
        """Raise Conflict: the hand has moved on since the arm was pushed away."""
        off = float(np.abs(start_q - self.current_q).max())
        raise Conflict(f"the arm was pushed {off:.3f} rad away; stop, and begin again from where it is")

    def start_detour(self, detour: Detour) -> None:
        """Do nothing: a live hand plans no detours."""

    def close(self) -> None:
        """Stop listening to the tracker, and to who presses its clutch."""
        self._handle.close()
        if self._remote_clutch is not None:
            self._remote_clutch.close()

    def _receive(self, _: str, payload: bytes) -> None:
        self._newest.append((self._clock(), payload))

    def _check_presence(self, now: int) -> None:
        """Open the clutch when nobody presses it any more, or nothing is heard of those whom the arm follows."""
        presser, why = self._remote_clutch, ""
        if now - self._last_seen_ns > self._silence_ns:
            why = "the hand was lost; let the clutch go and press it again"
        elif presser is not None and now - presser.last_seen_ns > self._silence_ns:
            why = f"nothing was heard of {self._order.clutch}, who presses the clutch; press it again"
        if why:
            self._clutch.disengage(why)
        elif presser is not None and not presser.pressed:
            self._clutch.update(False)
        if not self._clutch.engaged:
            self._follower.disengage()

    def _take_sample(self, when: int, payload: bytes) -> None:
        sample = decode_tracked(self._order.tracker, payload, when)
        if sample is None:
            return
        self._last_seen_ns = when
        arm = self._joint_states.latest(when)
        if arm is not None and self._order.scene.carried is not None:
            self._follower.load = observed_load(arm[1], self._follower.load)
        followed = self._clutch.engaged
        down = self._remote_clutch.pressed if self._remote_clutch is not None else bool(sample.buttons & CLUTCH_BUTTON)
        if self._clutch.update(down):
            self._gripper.engage(sample)
            self._follower.engage(self._world(sample))
        elif self._clutch.engaged:
            self._gripper.follow(sample)
            self._follower.set_hand(self._world(sample), when)
        elif followed:
            self._follower.disengage()

    def _world(self, sample: Sample) -> Array:
        return to_world(self._order.calibration, np.array(sample.position))
