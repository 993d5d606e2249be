"""One execution under way: its program, its state in words, and what is measured on its setpoints."""

from __future__ import annotations

from typing import Final

from teachpath.executor.limit_meter import LimitMeter
from teachpath.executor.pacing import Pacer
from teachpath.motion.execution.motion_program import MotionProgram
from teachpath.motion.execution.segments import Detour
from teachpath.records import Array, ExecutorStatus, JointState, Setpoint
from teachpath_proto.control import ExecutorState

LATE_ARM_SUFFIX: Final = ", waiting for the arm, which is late"
MAX_ARM_LAG: Final = 0.3  # s, by which an arm may play its setpoints late; a driver's delay and the way there are less
CAUGHT_UP_LAG: Final = 0.25  # s, below which an arm that was late has caught up
SETTLING_TIME: Final = 0.3  # s after which an arm that is held has come to rest


class Execution:
    """Steps through a program and finds the state that belongs to what it does.

    Args:
        execution: its id.
        program: what to run through.
        plan: id of its plan; empty with a live hand.
        rate: setpoints a second [Hz].
        offset: added to the loop's clock to get nanoseconds since the Unix epoch.
    """

    def __init__(self, execution: str, program: MotionProgram, *, plan: str, rate: float, offset: int) -> None:
        self.id = execution
        self.program = program
        self.plan = plan
        self.state = ExecutorState.APPROACHING
        self.reason = ""
        self.tracking_error = 0.0
        self.revocation = ""  # why its certificate holds no longer
        self.displacement = 0.0  # [rad] that the arm was pushed off while it was held; nothing is sent then
        self._rate, self._epoch_offset = rate, offset
        self._nominal_ns = 0  # [ns since the Unix epoch] of the newest setpoint
        self._rest_setpoints = 0  # setpoints since the arm's nominal motion came to rest
        self._moving_setpoints = 0  # setpoints since it began to move
        self._final_state: ExecutorState | None = None  # the state to end in as soon as the arm stands
        self._sent_count = 0
        self._meter = LimitMeter(rate, program.current_q)

    @property
    def is_resting(self) -> bool:
        """Whether it is over."""
        return self.state.is_resting

    @property
    def is_settled(self) -> bool:
        """Whether it is held for so long that the arm itself rests."""
        return self.state is ExecutorState.HELD and self._rest_setpoints > SETTLING_TIME * self._rate

    def arm_has_stopped(self, arm: JointState) -> bool:
        """Tell whether the arm has taken up a setpoint of the standstill that it is held at."""
        return arm.execution == self.id and arm.cycle >= self._sent_count - self._rest_setpoints

    def wait_for_late_arm(self, arm: JointState) -> None:
        """Come to rest while the arm is late: behind the motion that waits to be played, a stop would wait too."""
        taken = arm.cycle if arm.execution == self.id else -1
        waiting = self._sent_count - 1 - taken
        if not self.program.waiting:
            self.program.set_waiting(min(waiting, self._moving_setpoints) > MAX_ARM_LAG * self._rate)
        elif waiting < CAUGHT_UP_LAG * self._rate or self.arm_has_stopped(arm):
            self.program.set_waiting(False)

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed."""
        self.program.set_override(share)

    def hold(self, reason: str) -> None:
        """Come to rest on the path and wait there."""
        if not self._final_state and not self.program.hold_requested:
            self.reason = reason
            self.program.hold()

    def resume(self) -> None:
        """Go on, unless it is being ended."""
        if not self._final_state:
            self.reason = ""
            self.program.resume()

    def reverse(self) -> None:
        """Go back to the beginning of this stretch, unless it is being ended."""
        if not self._final_state:
            self.reason = ""
            self.program.reverse()

    def revoke(self, reason: str) -> None:
        """Hold for good: its certificate holds no longer."""
        self.revocation = f"the certificate of {self.plan} was revoked: {reason}; stop, and plan the path again"
        self.program.hold()
        if not self._final_state:
            self.reason = self.revocation

    def start_detour(self, detour: Detour, start_q: Array) -> None:
        """Begin a step, or a way back from `here` (6,), unless it is being ended or moves already."""
        if self._final_state or not self.program.at_rest:
            return
        if self.displacement:
            self._meter = LimitMeter(self._rate, start_q, self._meter)
        self.displacement, self.reason = 0.0, ""
        self.program.start_detour(detour)

    def end(self, state: ExecutorState, reason: str) -> None:
        """Come to rest on the path and end there as `ended` or `faulted`."""
        if not self._final_state:
            self._final_state, self.reason = state, reason
            self.program.hold()

    def advance_planning(self) -> None:
        """Let the program plan in the time that is left behind a setpoint."""
        self.program.advance_planning()

    def skip_period(self) -> None:
        """Let a period pass in which nothing is sent: the arm was pushed away and stays where it is."""
        self.state = self._current_state()

    def step(self, due: int, sent_ns: int) -> Setpoint:
        """Advance by one control period and return its setpoint.

        Args:
            due: when the period began [ns of the loop's clock].
            sent_ns: now [ns since the Unix epoch].
        """
        moment = self.program.step()
        self._meter.add(moment.position, self.program)
        self._nominal_ns = self._nominal_time(
            due + self._epoch_offset, self._rest_setpoints > 1 and self.program.at_rest
        )
        self._rest_setpoints, self._moving_setpoints = (
            (self._rest_setpoints + 1, 0) if self.program.at_rest else (0, self._moving_setpoints + 1)
        )
        setpoint = Setpoint(
            cycle=self._sent_count,
            nominal_ns=self._nominal_ns,
            sent_ns=sent_ns,
            position=moment.position,
            velocity=moment.velocity,
            acceleration=moment.acceleration,
            gripper_closed=moment.gripper_closed,
            execution=self.id,
            on_path=moment.on_path,
        )
        self._sent_count += 1
        self.state = self._current_state()
        return setpoint

    def _nominal_time(self, now: int, at_rest: bool) -> int:
        """Return when this setpoint is due on the clock of the motion, which loses what the loop oversleeps.

        So position, velocity and acceleration belong to their times whatever happens. At rest, once two setpoints have
        told of it, the lost time is let go.
        """
        return now if at_rest or not self._sent_count else self._nominal_ns + round(1e9 / self._rate)

    def status(self, pacer: Pacer) -> ExecutorStatus:
        """Tell where it stands, with the account of the loop that runs it."""
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
            tracking_error=self.tracking_error,
            duration=self._sent_count / self._rate,
            length=self.program.arc_length,
            stretch=self.program.activity + (LATE_ARM_SUFFIX if self.program.waiting else ""),
            hand_latency_p50_us=latency_p50,
            hand_latency_p99_us=latency_p99,
        )

    def _describe_reason(self) -> str:
        if self.displacement:
            pushed = f"the arm was pushed {self.displacement:.3f} rad off the point where it was held"
            return f"{pushed}; resume brings it back slowly, stop ends here"
        return self.reason or (self.program.hold_reason if self.state is ExecutorState.HELD else "")

    def _current_state(self) -> ExecutorState:
        program = self.program
        if self._final_state:
            return self._final_state if program.at_rest else ExecutorState.STOPPING
        if program.finished:
            return ExecutorState.ENDED
        if program.held:
            return ExecutorState.HELD if program.at_rest else ExecutorState.STOPPING
        return ExecutorState.APPROACHING if program.before_path else ExecutorState.FOLLOWING
