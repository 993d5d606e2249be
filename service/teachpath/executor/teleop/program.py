"""A live hand that drives the arm: tool and gripper mirror it while the clutch is pressed, and rest otherwise."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

import numpy as np

from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.teleop.clutch import CLUTCH, Clutch, RemoteClutch, tracked
from teachpath.executor.teleop.gripper import GripperFollower, observed_load
from teachpath.io.bus import Bus
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.execution.segments import MotionState
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.settings import MotionSettings
from teachpath.recording.demonstration import to_world
from teachpath.records import Array, Sample, TeleopRequest
from teachpath_proto.keys import Keys

KEPT: Final = 5000  # latencies
LATE: Final = "the arm is late; let the clutch go and press it again"


class TeleopProgram:
    """Drives an execution by the samples of one tracker, as a program does.

    Args:
        order: tracker, who presses its clutch, calibration, scene and scale.
        here: (6,) where the arm rests [rad].
        hearing: of the arm, which says what its gripper does and where the object is.
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
        here: Array,
        settings: MotionSettings,
        *,
        hearing: JointStateMonitor,
        period: float,
        silence: float,
        clock: Callable[[], int],
    ) -> None:
        self._order, self._clock, self._hearing = order, clock, hearing
        self._patience = silence * 1e9  # [ns]
        self._grip = GripperFollower(hearing.present().gripper_closed)
        model = CollisionModel(order.scene)
        self._mirror = TeleopFollower(model, here, settings, scale=order.scale, share=order.share, period=period)
        if order.scene.carried is not None:
            self._mirror.load = Load(position=order.scene.carried.position)
        still = np.zeros(6)
        self._moment = MotionState(np.array(here), still, still, self._grip.closed)
        self._came: deque[tuple[int, bytes]] = deque(maxlen=1)
        self._seen = 0  # [ns of the clock] when the newest tracked sample came
        self._clutch = Clutch()
        self._presser = RemoteClutch(bus, keys, order.clutch, clock) if order.clutch else None
        self._latencies: deque[float] = deque(maxlen=KEPT)
        self._answered = 0
        self._handle = bus.subscribe(keys.samples(order.tracker), self._receive)

    before = waits = False
    over = False
    progress = 0.0
    length = 0.0
    override = 1.0

    @property
    def standing(self) -> bool:
        """Whether the nominal motion is at rest."""
        return self._mirror.standing

    @property
    def held(self) -> bool:
        """Whether the clutch is open, or a hold was asked for."""
        return not self._clutch.pressed

    @property
    def stopped(self) -> bool:
        """Whether `hold` was asked for and not taken back."""
        return self._clutch.stopped

    @property
    def why_held(self) -> str:
        """Why the arm does not follow, in words."""
        return self._clutch.why

    @property
    def here(self) -> Array:
        """The newest setpoint's configuration (6,) [rad]."""
        return self._moment.position

    @property
    def doing(self) -> str:
        """What it does, and why the tool is not where the hand is."""
        following = f"mirroring {self._order.tracker}"
        return f"{following}: {self._mirror.reason}" if self._clutch.pressed and self._mirror.reason else following

    @property
    def place(self) -> str:
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
        if self._presser is not None:
            self._presser.listen()
        if self._came:
            self._hear(*self._came.pop())
        if self._clutch.pressed:
            self._watch(now)
        position, velocity, acceleration = self._mirror.step()
        if self._mirror.answered != self._answered:
            self._answered = self._mirror.answered
            self._latencies.append((now - self._answered) / 1e3)
        self._moment = MotionState(position, velocity, acceleration, self._grip.closed)
        return self._moment

    def think(self) -> None:
        """Do one piece of the work that leads to the next motion."""
        self._mirror.think()

    def hold(self) -> None:
        """Open the clutch until `resume`."""
        self._clutch.hold()
        self._mirror.release()

    def wait(self, waits: bool) -> None:
        """Open the clutch: the arm is late, and would be where the hand no longer is."""
        if waits and self._clutch.pressed:
            self._clutch.open(LATE)
            self._mirror.release()

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

    def close(self) -> None:
        """Stop listening to the tracker, and to who presses its clutch."""
        self._handle.close()
        if self._presser is not None:
            self._presser.close()

    def _receive(self, _: str, payload: bytes) -> None:
        self._came.append((self._clock(), payload))

    def _watch(self, now: int) -> None:
        """Open the clutch when nobody presses it any more, or nothing is heard of those whom the arm follows."""
        presser, why = self._presser, ""
        if now - self._seen > self._patience:
            why = "the hand was lost; let the clutch go and press it again"
        elif presser is not None and now - presser.seen > self._patience:
            why = f"nothing was heard of {self._order.clutch}, who presses the clutch; press it again"
        if why:
            self._clutch.open(why)
        elif presser is not None and not presser.down:
            self._clutch.hear(False)
        if not self._clutch.pressed:
            self._mirror.release()

    def _hear(self, when: int, payload: bytes) -> None:
        sample = tracked(self._order.tracker, payload, when)
        if sample is None:
            return
        self._seen = when
        arm = self._hearing.newest(when)
        if arm is not None and self._order.scene.carried is not None:
            self._mirror.load = observed_load(arm[1], self._mirror.load)
        followed = self._clutch.pressed
        down = self._presser.down if self._presser is not None else bool(sample.buttons & CLUTCH)
        if self._clutch.hear(down):
            self._grip.begin(sample)
            self._mirror.press(self._world(sample))
        elif self._clutch.pressed:
            self._grip.follow(sample)
            self._mirror.move(self._world(sample), when)
        elif followed:
            self._mirror.release()

    def _world(self, sample: Sample) -> Array:
        return to_world(self._order.calibration, np.array(sample.position))
