"""One execution: its program, its state, and what is measured on its setpoints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Final

from teachpath.executor.arm_rest import ArmRest
from teachpath.executor.grasp_monitor import GraspMonitor
from teachpath.executor.late_arm import LATE_ARM_SUFFIX, is_too_late
from teachpath.executor.limit_meter import LimitMeter
from teachpath.executor.pacing import NominalClock, Pacer
from teachpath.executor.rest_points import RestPoints
from teachpath.executor.tracking_meter import TrackingMeter
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.motion_program import FollowedHand, MotionProgram
from teachpath.motion.execution.segments import Detour
from teachpath.records import Array, ExecutorStatus, JointState, Setpoint
from teachpath_proto.control import ExecutorState

STANDSTILL_SETPOINTS: Final = 3  # sent at rest before an arm moves: one may be lost
RESTART_TIMEOUT_NS: Final = 500_000_000  # [ns] within which an arm takes up setpoints that begin where it rests
SETTLING_TIME: Final = 0.3  # [s] after which an arm that is held has come to rest


class Execution:
    """Steps through a program, numbers and times its setpoints, and derives the state from what the program does.

    Args:
        execution: id of the execution.
        program: what to run.
        plan: id of the plan; empty with a live hand.
        confirm: checks that the certificate of the plan still holds; raises PathRefused.
        grasp: watches what the gripper holds.
        rate: setpoints a second [Hz].
        offset: what turns the loop's clock into nanoseconds since the Unix epoch, when added [ns].
        arm: by whose limits their use is measured.
        arm_rest: tells when the arm itself rests, which the execution waits for before it is over.

    Attributes:
        reason: why the execution is held, stopped or faulted, in words.
        tracking: measures the arm against the setpoints.
        revocation: why the certificate of the plan holds no longer; empty while it holds.
        displacement: how far the arm was pushed away while it was held [rad]; while this is not 0, nothing is sent.
        arm_stops: whether the arm follows a way to rest, because setpoints were late; nothing is sent meanwhile.
    """

    def __init__(
        self,
        execution: str,
        program: MotionProgram,
        *,
        plan: str,
        confirm: Callable[[], None],
        grasp: GraspMonitor,
        rate: float,
        offset: int,
        arm: Arm,
        arm_rest: ArmRest,
    ) -> None:
        self.id: str = execution
        self.program: MotionProgram = program
        self.plan: str = plan
        self.confirm: Callable[[], None] = confirm
        self.grasp: GraspMonitor = grasp
        self.state: ExecutorState = ExecutorState.APPROACHING
        self.reason: str = ""
        self.tracking: TrackingMeter = TrackingMeter(rate)
        self.revocation: str = ""
        self.displacement: float = 0.0
        self.arm_stops: bool = False
        self._rate = rate
        self._arm = arm
        self._arm_rest = arm_rest
        self._nominal_clock = NominalClock(rate, offset)
        self._rest_setpoints = 0  # sent since the nominal motion came to rest
        self._moving_setpoints = 0  # sent since the nominal motion began
        self._final_state: ExecutorState | None = None  # in which the execution ends as soon as it is at rest
        self._sent_count = 0
        self._rest_points = RestPoints(rate)
        self._restarted = (-1, 0)  # from which setpoint's rest it went on, and when [ns of the loop's clock]
        self._standstill_left = STANDSTILL_SETPOINTS  # at rest, still to be sent: the arm takes up a stream from there
        self._meter = LimitMeter(rate, program.current_q, arm)

    @property
    def is_resting(self) -> bool:
        """Whether the execution is over."""
        return self.state.is_resting

    @property
    def is_ending(self) -> bool:
        """Whether the execution is over as soon as the arm rests."""
        return self._final_state is not None

    @property
    def _is_over(self) -> bool:
        """Whether the execution waits for nothing but the rest of the arm."""
        return self.is_ending or self.program.finished

    @property
    def is_settled(self) -> bool:
        """Whether the execution has been held for so long that the arm itself rests."""
        return self.state is ExecutorState.HELD and self._rest_setpoints > SETTLING_TIME * self._rate

    @property
    def has_begun(self) -> bool:
        """Whether a setpoint was sent."""
        return self._sent_count > 0

    def refuse(self, reason: str) -> None:
        """End as faulted before the first setpoint: nothing was sent, so there is nothing to come to rest from."""
        self._final_state = self.state = ExecutorState.FAULTED
        self.reason = reason

    def arm_has_stopped(self, arm: JointState) -> bool:
        """Tell whether the arm has taken up a setpoint of the present standstill."""
        return arm.execution == self.id and arm.cycle >= self._sent_count - self._rest_setpoints

    def watch_rest(self, arm: JointState | None, now: int) -> None:
        """Look whether the arm rests, once the nominal motion does; `arm` is None while it is silent, `now` in ns."""
        if not self.program.at_rest:
            self._arm_rest.begin_again()
            return
        cannot_follow = arm is not None and bool(self.displacement or arm.inability)
        taken = cannot_follow or (arm is not None and self.arm_has_stopped(arm))
        self._arm_rest.update(arm, has_taken_standstill=taken, now=now)

    def untaken(self, arm: JointState) -> int:
        """Return how many setpoints were sent that the arm has not taken up yet."""
        return self._sent_count - 1 - (arm.cycle if arm.execution == self.id else -1)

    def wait_for_late_arm(self, arm: JointState) -> None:
        """Come to rest while the arm is late, because a stop would queue behind the setpoints it has yet to play."""
        waits, untaken = self.program.waiting, self.untaken(arm)
        is_late = is_too_late(untaken, self._moving_setpoints, self._rate, waits=waits)
        if not (waits and is_late) or self.arm_has_stopped(arm):
            self.program.set_waiting(is_late and not waits)

    def restart(self, cycle: int, due: int) -> bool:
        """Go on from where the arm rests that has followed the way to rest of a setpoint; tell whether that is known.

        Args:
            cycle: of that setpoint.
            due: now [ns of the loop's clock].
        """
        point = self._rest_points.find(cycle)
        if point is None:
            return False
        self.reason = self.program.restart(point) or self.reason
        self._restarted = (cycle, due)
        self._standstill_left = STANDSTILL_SETPOINTS
        self._rest_setpoints = 2  # the arm knows that it rests, so the time that was lost is let go
        self._moving_setpoints = 0
        self.arm_stops = False
        self._meter = LimitMeter(self._rate, self.program.current_q, self._arm, self._meter)
        return True

    def has_restarted(self, cycle: int, due: int) -> bool:
        """Tell whether it went on from the rest of that setpoint just now, so that the arm may not know yet."""
        return self._restarted[0] == cycle and due - self._restarted[1] < RESTART_TIMEOUT_NS

    def hold(self, reason: str) -> None:
        """Come to rest on the path and stay there, unless the execution is over or being ended."""
        if not self._is_over and not self.program.hold_requested:
            self.reason = reason
            self.program.hold()

    def resume(self) -> None:
        """Go on, unless the execution is over or being ended."""
        if not self._is_over:
            self._move_on()
            self.program.resume()

    def reverse(self) -> None:
        """Go back to the beginning of the segment, unless the execution is over or being ended."""
        if not self._is_over:
            self._move_on()
            self.program.reverse()

    def revoke(self, reason: str) -> None:
        """Hold for good, because the certificate of the plan holds no longer."""
        self.revocation = f"the certificate of {self.plan} was revoked: {reason}; stop, and plan the path again"
        self.program.hold()
        if not self._final_state:
            self.reason = self.revocation

    def start_detour(self, detour: Detour, start_q: Array) -> None:
        """Begin a step or a way back, unless the execution is being ended, or the nominal motion is not at rest.

        Args:
            start_q: (joints,) where the detour begins [rad].
        """
        if self._is_over or not self.program.at_rest:
            return
        if self.displacement:
            self._meter = LimitMeter(self._rate, start_q, self._arm, self._meter)
        self.displacement = 0.0
        self._move_on()
        self.program.start_detour(detour)

    def end(self, state: ExecutorState, reason: str) -> None:
        """Come to rest on the path and end there in `state`; the first end counts."""
        if not self._final_state:
            self._final_state, self.reason = state, reason
            self.program.hold()

    def skip_period(self) -> None:
        """Let a period pass without a setpoint, because the arm was pushed away and stays where it is."""
        self.state = self._current_state()

    def step(self, due: int, sent_ns: int) -> Setpoint:
        """Advance by one control period and return its setpoint.

        Args:
            due: when the period began [ns of the loop's clock].
            sent_ns: now [ns since the Unix epoch].
        """
        motion = self.program.step() if not self._standstill_left else self.program.state
        self._standstill_left = max(self._standstill_left - 1, 0)
        way_to_rest, point = self.program.way_to_rest()
        self._rest_points.add(self._sent_count, point, is_still=not len(way_to_rest))
        at_rest = self.program.at_rest
        self._meter.add(motion.position, self.program)
        nominal_ns = self._nominal_clock.stamp(due, at_rest=at_rest and self._rest_setpoints > 1)
        self._rest_setpoints = self._rest_setpoints + 1 if at_rest else 0
        self._moving_setpoints = 0 if at_rest else self._moving_setpoints + 1
        setpoint = Setpoint(
            cycle=self._sent_count,
            nominal_ns=nominal_ns,
            sent_ns=sent_ns,
            position=motion.position,
            velocity=motion.velocity,
            acceleration=motion.acceleration,
            gripper_closed=motion.gripper_closed,
            execution=self.id,
            on_path=motion.on_path,
            way_to_rest=way_to_rest,
            from_rest=self._standstill_left == STANDSTILL_SETPOINTS - 1,
            output=motion.output,
        )
        self.tracking.add(setpoint)
        self._sent_count += 1
        self.state = self._current_state()
        return setpoint

    def status(self, pacer: Pacer) -> ExecutorStatus:
        """Return the status, with the statistics of the loop that runs the execution."""
        late = pacer.lateness()
        latency_p50, latency_p99 = self.program.latency
        return ExecutorStatus(
            execution=self.id,
            state=self.state,
            reason=self._describe_reason(),
            progress=self.program.progress,
            override=self.program.override,
            cycles=self._sent_count,
            late=pacer.late,
            missed=pacer.missed,
            lateness_p50_us=late.p50,
            lateness_p99_us=late.p99,
            lateness_max_us=late.largest,
            limit_use=self._meter.max_use,
            limit_place=self._meter.max_use_location,
            tracking_error=self.tracking.largest,
            duration=self._sent_count / self._rate,
            length=self.program.arc_length,
            activity=self.program.activity + (LATE_ARM_SUFFIX if self.program.waiting else ""),
            hand_latency_p50_us=latency_p50,
            hand_latency_p99_us=latency_p99,
            ending=self.is_ending,
            **asdict(self.program.followed_hand or FollowedHand()),
        )

    def _move_on(self) -> None:
        self.reason = ""
        self.grasp.accept()

    def _describe_reason(self) -> str:
        if self.displacement:
            pushed = f"the arm was pushed {self.displacement:.3f} rad off the point where it was held"
            return f"{pushed}; resume brings it back slowly, stop ends here"
        return self.reason or (self.program.hold_reason if self.state is ExecutorState.HELD else "")

    def _current_state(self) -> ExecutorState:
        if self._is_over:
            return self._state_at_end()
        if self.program.held:
            return ExecutorState.HELD if self.program.at_rest else ExecutorState.STOPPING
        return ExecutorState.APPROACHING if self.program.before_path else ExecutorState.FOLLOWING

    def _state_at_end(self) -> ExecutorState:
        """Return the final state as soon as the arm itself rests; without that the end is a fault."""
        if self.program.at_rest and self._arm_rest.is_reached:
            return self._final_state or ExecutorState.ENDED
        if self.program.at_rest and self._arm_rest.problem:
            if self._final_state is not ExecutorState.FAULTED:
                self.reason = "; ".join(filter(None, (self.reason, self._arm_rest.problem)))
            return ExecutorState.FAULTED
        return ExecutorState.STOPPING if self._final_state else ExecutorState.FOLLOWING
