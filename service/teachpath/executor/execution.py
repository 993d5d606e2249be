"""One execution under way: its program, its state in words, and what is measured on its setpoints."""

from __future__ import annotations

from typing import Final

from teachpath.executor.limit_meter import LimitMeter
from teachpath.executor.pacing import Pacer
from teachpath.executor.teleop.program import TeleopProgram
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.execution.segments import Detour
from teachpath.records import Array, ExecutorStatus, JointState, Setpoint

RESTING: Final = ("idle", "ended", "faulted")
WAITING: Final = ", waiting for the arm, which is late"
LATE: Final = 0.3  # s, by which an arm may play its setpoints late; a driver's delay and the way there are less
CAUGHT_UP: Final = 0.25  # s, below which an arm that was late has caught up
SETTLED: Final = 0.3  # s after which an arm that is held has come to rest


class Execution:
    """Steps through a program and finds the state that belongs to what it does.

    Args:
        execution: its id.
        program: what to run through, or a live hand.
        plan: id of its plan; empty with a live hand.
        rate: setpoints a second [Hz].
        offset: added to the loop's clock to get nanoseconds since the Unix epoch.
    """

    def __init__(
        self, execution: str, program: PlanProgram | TeleopProgram, *, plan: str, rate: float, offset: int
    ) -> None:
        self.execution = execution
        self.program = program
        self.plan = plan
        self.state = "approaching"
        self.reason = ""
        self.tracking_error = 0.0
        self.revoked = ""  # why its certificate holds no longer
        self.displaced = 0.0  # [rad] that the arm was pushed off while it was held; nothing is sent then
        self._rate, self._offset = rate, offset
        self._nominal = 0  # [ns since the Unix epoch] of the newest setpoint
        self._still = 0  # setpoints since the arm's nominal motion came to rest
        self._moving = 0  # setpoints since it began to move
        self._ending = ""  # the state to end in as soon as the arm stands
        self._sent = 0
        self._meter = LimitMeter(rate, program.here)

    @property
    def resting(self) -> bool:
        """Whether it is over."""
        return self.state in RESTING

    @property
    def settled(self) -> bool:
        """Whether it is held for so long that the arm itself rests."""
        return self.state == "held" and self._still > SETTLED * self._rate

    def rests_with(self, arm: JointState) -> bool:
        """Tell whether the arm has taken up a setpoint of the standstill that it is held at."""
        return arm.execution == self.execution and arm.cycle >= self._sent - self._still

    def wait_for(self, arm: JointState) -> None:
        """Come to rest while the arm is late: behind the motion that waits to be played, a stop would wait too."""
        taken = arm.cycle if arm.execution == self.execution else -1
        waiting = self._sent - 1 - taken
        if not self.program.waits:
            self.program.wait(min(waiting, self._moving) > LATE * self._rate)
        elif waiting < CAUGHT_UP * self._rate or self.rests_with(arm):
            self.program.wait(False)

    def override(self, share: float) -> None:
        """Go at `share` of the full speed."""
        self.program.set_override(share)

    def hold(self, reason: str) -> None:
        """Come to rest on the path and wait there."""
        if not self._ending and not self.program.stopped:
            self.reason = reason
            self.program.hold()

    def resume(self) -> None:
        """Go on, unless it is being ended."""
        if not self._ending:
            self.reason = ""
            self.program.resume()

    def reverse(self) -> None:
        """Go back to the beginning of this stretch, unless it is being ended."""
        if not self._ending:
            self.reason = ""
            self.program.reverse()

    def revoke(self, reason: str) -> None:
        """Hold for good: its certificate holds no longer."""
        self.revoked = f"the certificate of {self.plan} was revoked: {reason}; stop, and plan the path again"
        self.program.hold()
        if not self._ending:
            self.reason = self.revoked

    def take_aside(self, aside: Detour, here: Array) -> None:
        """Begin a step, or a way back from `here` (6,), unless it is being ended or moves already."""
        if self._ending or not self.program.standing:
            return
        if self.displaced:
            self._meter = LimitMeter(self._rate, here, self._meter)
        self.displaced, self.reason = 0.0, ""
        if isinstance(self.program, PlanProgram):
            self.program.take_aside(aside)

    def end(self, state: str, reason: str) -> None:
        """Come to rest on the path and end there as `ended` or `faulted`."""
        if not self._ending:
            self._ending, self.reason = state, reason
            self.program.hold()

    def think(self) -> None:
        """Do what is to be done behind a setpoint; only a live hand leaves something."""
        if isinstance(self.program, TeleopProgram):
            self.program.think()

    def wait(self) -> None:
        """Let a period pass in which nothing is sent: the arm was pushed away and stays where it is."""
        self.state = self._state_now()

    def step(self, due: int, sent_ns: int) -> Setpoint:
        """Advance by one control period and return its setpoint.

        Args:
            due: when the period began [ns of the loop's clock].
            sent_ns: now [ns since the Unix epoch].
        """
        moment = self.program.step()
        self._meter.add(moment.position, self.program)
        self._nominal = self._due(due + self._offset, self._still > 1 and self.program.standing)
        self._still, self._moving = (self._still + 1, 0) if self.program.standing else (0, self._moving + 1)
        setpoint = Setpoint(
            cycle=self._sent,
            nominal_ns=self._nominal,
            sent_ns=sent_ns,
            position=moment.position,
            velocity=moment.velocity,
            acceleration=moment.acceleration,
            gripper_closed=moment.gripper_closed,
            execution=self.execution,
            on_path=moment.on_path,
        )
        self._sent += 1
        self.state = self._state_now()
        return setpoint

    def _due(self, now: int, at_rest: bool) -> int:
        """Return when this setpoint is due on the clock of the motion, which loses what the loop oversleeps.

        So position, velocity and acceleration belong to their times whatever happens. At rest, once two setpoints have
        told of it, the lost time is let go.
        """
        return now if at_rest or not self._sent else self._nominal + round(1e9 / self._rate)

    def status(self, pacer: Pacer) -> ExecutorStatus:
        """Tell where it stands, with the account of the loop that runs it."""
        late = pacer.lateness()
        hand = self.program.latency if isinstance(self.program, TeleopProgram) else (0.0, 0.0)
        return ExecutorStatus(
            execution=self.execution,
            state=self.state,
            reason=self._why(),
            progress=self.program.progress,
            override=self.program.override,
            cycles=self._sent,
            late=pacer.late,
            missed=pacer.missed,
            lateness_p50_us=late.p50,
            lateness_p99_us=late.p99,
            lateness_max_us=late.largest,
            limit_use=self._meter.largest,
            limit_place=self._meter.place,
            tracking_error=self.tracking_error,
            duration=self._sent / self._rate,
            length=self.program.length,
            stretch=self.program.doing + (WAITING if self.program.waits else ""),
            hand_latency_p50_us=hand[0],
            hand_latency_p99_us=hand[1],
        )

    def _why(self) -> str:
        if self.displaced:
            pushed = f"the arm was pushed {self.displaced:.3f} rad off the point where it was held"
            return f"{pushed}; resume brings it back slowly, stop ends here"
        return self.reason or (self.program.why_held if self.state == "held" else "")

    def _state_now(self) -> str:
        program = self.program
        if self._ending:
            return self._ending if program.standing else "stopping"
        if program.over:
            return "ended"
        if program.held:
            return "held" if program.standing else "stopping"
        return "approaching" if program.before else "following"
