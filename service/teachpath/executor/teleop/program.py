"""Teleoperation: tool and gripper follow a live hand while its clutch is pressed, and rest otherwise."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final

import numpy as np

from teachpath.errors import Conflict
from teachpath.executor.joint_state_monitor import JointStateMonitor
from teachpath.executor.teleop.clutch import Clutch
from teachpath.executor.teleop.gripper import GripperFollower, observed_load
from teachpath.executor.teleop.hand_input import HandInput
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel, Load
from teachpath.motion.execution.motion_program import FollowedHand
from teachpath.motion.execution.segments import Detour, MotionState, RestPoint
from teachpath.motion.execution.teleop_follower import TeleopFollower
from teachpath.motion.settings import MotionSettings
from teachpath.recording.demonstration import to_world, turn_to_world
from teachpath.records import Array, Sample, Scene, TeleopRequest

MAX_LATENCIES: Final = 5000  # newest latencies of which the percentiles are taken
MAX_OFFSET: Final = 0.1  # [m] that a hand may be off where it was last followed, to be followed again by itself
LATE_ARM_HINT: Final = "the arm is late; let the clutch go and press it again"
MOVED_HINT: Final = "the hand moved too far while it was not followed; let the clutch go and press it again"
NO_TURN_HINT: Final = "the hand's own turns are not measured, so the tool keeps its orientation"


class TeleopProgram:
    """A motion program that one tracker's samples lead.

    Args:
        hand: samples of the tracker and state of its clutch; closed with the program.
        request: tracker, calibration and scale.
        scene: what the station has around the arm.
        start_q: (joints,) where the arm rests [rad].
        arm: that follows.
        joint_states: monitor of the arm, which says what its gripper does and where the object is.
        return_timeout: within which a hand that was lost is followed again while its clutch stays pressed [s].
        period: between two setpoints [s].
        clock: returns monotonic nanoseconds.

    Raises:
        PathRefused: the arm stands where it can follow nothing.
    """

    def __init__(
        self,
        hand: HandInput,
        request: TeleopRequest,
        scene: Scene,
        start_q: Array,
        settings: MotionSettings,
        arm: Arm,
        *,
        joint_states: JointStateMonitor,
        return_timeout: float,
        period: float,
        clock: Callable[[], int],
    ) -> None:
        self._hand = hand
        self._request = request
        self._arm = arm
        self._joint_states = joint_states
        self._clock = clock
        self._gripper = GripperFollower(joint_states.current().gripper_closed)
        model = CollisionModel(scene, arm)
        self._has_object = scene.carried is not None
        self._follower = TeleopFollower(
            model, start_q, settings, scale=request.scale, share=request.share, period=period
        )
        if scene.carried is not None:
            self._follower.load = Load(position=scene.carried.position)
        self._state = MotionState(
            np.array(start_q), np.zeros(len(start_q)), np.zeros(len(start_q)), self._gripper.closed
        )
        self._clutch = Clutch()
        self._return_timeout_ns = round(return_timeout * 1e9)
        self._followed = np.zeros(3)  # [m] where the hand was in the newest sample that was followed
        self.waiting: bool = False
        self._latencies: deque[float] = deque(maxlen=MAX_LATENCIES)
        self._answered_stamp = 0
        self._turn_hint = ""

    before_path: bool = False
    finished: bool = False
    progress: float = 0.0
    arc_length: float = 0.0
    override: float = 1.0

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
        """Whether `hold` was called and not taken back."""
        return self._clutch.hold_requested

    @property
    def hold_reason(self) -> str:
        """Why the arm does not follow, in words."""
        return self._clutch.reason

    @property
    def current_q(self) -> Array:
        """Configuration (joints,) of the newest setpoint [rad]."""
        return self._state.position

    @property
    def activity(self) -> str:
        """What the arm does, and why the tool is not where the hand is."""
        hand = self.followed_hand
        following = f"following {hand.hand} in scene {hand.hand_scene}"
        return f"{following}: {hand.hindrance}" if hand.hindrance else following

    @property
    def followed_hand(self) -> FollowedHand:
        """The hand that is followed, and what keeps the tool from it."""
        intrusion = self._hand.intrusion(self._clock())
        hindrances = (self._follower.reason, intrusion, self._turn_hint) if self._clutch.engaged else (intrusion,)
        return FollowedHand(
            self._request.tracker, self._request.scene, "; ".join(filter(None, hindrances)), self._clutch.awaits_press
        )

    @property
    def location(self) -> str:
        """Where the execution is, in words."""
        return f"while following {self._request.tracker}"

    @property
    def latency(self) -> tuple[float, float]:
        """Median and 99th percentile of the time from a sample's arrival to the setpoint that answers it [us]."""
        if not self._latencies:
            return 0.0, 0.0
        p50, p99 = np.percentile(np.array(self._latencies), (50, 99))
        return float(p50), float(p99)

    def step(self) -> MotionState:
        """Advance by one control period; never raises."""
        now = self._clock()
        if (newest := self._hand.poll()) is not None:
            self._take_sample(*newest)
        if self._clutch.engaged:
            self._check_presence(now)
        self._clutch.give_up_pause(now)
        position, velocity, acceleration = self._follower.step()
        if self._follower.answered_stamp != self._answered_stamp:
            self._answered_stamp = self._follower.answered_stamp
            self._latencies.append((now - self._answered_stamp) / 1e3)
        self._state = MotionState(position, velocity, acceleration, self._gripper.closed)
        return self._state

    @property
    def state(self) -> MotionState:
        """The motion of the newest setpoint."""
        return self._state

    def way_to_rest(self) -> tuple[Array, RestPoint]:
        """Return the states (n, 3, joints) of the way to rest from the newest setpoint, and where it ends."""
        way = self._follower.way_to_rest()
        return way, RestPoint(way[-1, 0] if len(way) else self._state.position)

    def restart(self, point: RestPoint) -> str:
        """Stand where the arm rests; the arm follows again if the hand is near to where it was. Returns nothing."""
        if self._clutch.engaged:
            self._pause(LATE_ARM_HINT)
        self._follower.rest_at(point.position)
        still = np.zeros(len(self._state.position))
        self._state = MotionState(point.position, still, still, self._gripper.closed)
        return ""

    def advance_planning(self) -> None:
        """Do one slice of the planning of the next motion."""
        self._follower.advance_planning()

    def hold(self) -> None:
        """Open the clutch until `resume`."""
        self._clutch.hold()
        self._follower.disengage()

    def set_waiting(self, waiting: bool) -> None:
        """Rest while the arm is late; it follows again if the hand is near to where it was."""
        self.waiting = waiting
        if waiting and self._clutch.engaged:
            self._pause(LATE_ARM_HINT)

    def resume(self) -> None:
        """Let the clutch be pressed again."""
        self._clutch.resume()

    def reverse(self) -> None:
        """Hold: the way of a hand is not kept."""
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
        """Stop listening to the hand."""
        self._hand.close()

    def _check_presence(self, now: int) -> None:
        """Open the clutch when nobody presses it any more, or when the hand is lost."""
        loss = self._hand.loss(now)
        if loss and self._hand.intrusion(now):
            self._clutch.disengage(loss)
        elif loss:
            self._pause(loss)
        elif self._hand.is_remote_clutch_released:
            self._clutch.update(False)
        if not (self._clutch.engaged or self._clutch.is_paused):
            self._follower.disengage()

    def _pause(self, why: str) -> None:
        """Rest, for a reason and what to do about it in words; for a while the arm goes on by itself."""
        seconds = self._return_timeout_ns / 1e9
        reason = f"{why.partition(';')[0]}; the arm goes on by itself if that ends within {seconds:g} s"
        self._clutch.pause(reason, why, self._clock() + self._return_timeout_ns)
        self._follower.pause()

    def _go_on(self, hand: Array, sample: Sample) -> None:
        """Follow again after a pause, unless the hand was moved far meanwhile: nobody expects the arm to go there."""
        now = self._clock()
        if self.waiting or self._hand.loss(now) or self._hand.intrusion(now):
            return
        if np.linalg.norm(hand - self._followed) > MAX_OFFSET:
            self._clutch.disengage(MOVED_HINT)
            return
        self._clutch.go_on()
        self._gripper.engage(sample)

    def _take_sample(self, came_ns: int, sample: Sample) -> None:
        latest = self._joint_states.latest(came_ns)
        if latest is not None and self._has_object:
            self._follower.load = observed_load(latest[1], self._arm, self._follower.load)
        was_engaged = self._clutch.engaged
        hand, orientation = to_world(self._request.calibration, np.array(sample.position)), self._orientation(sample)
        if self._clutch.update(self._hand.is_clutch_pressed(sample)):
            self._gripper.engage(sample)
            self._follower.engage(hand, orientation)
        elif self._clutch.is_paused:
            self._go_on(hand, sample)
        elif was_engaged and not self._clutch.engaged:
            self._follower.disengage()
        if self._clutch.engaged:
            self._followed = hand
            self._gripper.follow(sample)
            self._follower.set_hand(hand, came_ns, orientation)

    def _orientation(self, sample: Sample) -> Array | None:
        """Return the orientation (3, 3) of the hand in the world, if the tool is to turn with it and it is measured."""
        if self._request.orientation == "keep":
            return None
        self._turn_hint = NO_TURN_HINT if sample.orientation is None else ""
        return None if sample.orientation is None else turn_to_world(self._request.calibration, sample.orientation)
