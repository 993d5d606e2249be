"""One execution under way: its program, its state in words, and what is measured on its setpoints."""

from __future__ import annotations

from typing import Final

from teachpath.motion.program import Program
from teachpath.records import ExecutorStatus, Setpoint
from teachpath.workers.executor.meter import LimitMeter
from teachpath.workers.executor.pacing import Pacer

RESTING: Final = ("idle", "ended", "faulted")


class Execution:
    """Steps through a program and finds the state that belongs to what it does.

    Args:
        execution: its id.
        program: what to run through.
        rate: setpoints a second [Hz].
        offset: added to the loop's clock to get nanoseconds since the Unix epoch.
    """

    def __init__(self, execution: str, program: Program, *, rate: float, offset: int) -> None:
        self.execution = execution
        self.program = program
        self.state = "approaching"
        self.reason = ""
        self.tracking_error = 0.0
        self._period, self._offset = 1.0 / rate, offset
        self._ending = ""  # the state to end in as soon as the arm stands
        self._sent = 0
        self._meter = LimitMeter(rate, program.here)

    @property
    def resting(self) -> bool:
        """Whether it is over."""
        return self.state in RESTING

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

    def end(self, state: str, reason: str) -> None:
        """Come to rest on the path and end there as `ended` or `faulted`."""
        if not self._ending:
            self._ending, self.reason = state, reason
            self.program.hold()

    def step(self, due: int, sent_ns: int) -> Setpoint:
        """Advance by one control period and return its setpoint.

        Args:
            due: when the period began [ns of the loop's clock].
            sent_ns: now [ns since the Unix epoch].
        """
        moment = self.program.step()
        self._meter.add(moment.position, self.program)
        setpoint = Setpoint(
            cycle=self._sent,
            nominal_ns=due + self._offset,
            sent_ns=sent_ns,
            position=moment.position,
            velocity=moment.velocity,
            acceleration=moment.acceleration,
            gripper_closed=moment.gripper_closed,
            execution=self.execution,
        )
        self._sent += 1
        self.state = self._settled()
        return setpoint

    def status(self, pacer: Pacer) -> ExecutorStatus:
        """Tell where it stands, with the account of the loop that runs it."""
        late = pacer.lateness()
        return ExecutorStatus(
            execution=self.execution,
            state=self.state,
            reason=self.reason or (self.program.why_held if self.state == "held" else ""),
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
            duration=self._sent * self._period,
        )

    def _settled(self) -> str:
        program = self.program
        if self._ending:
            return self._ending if program.standing else "stopping"
        if program.stretch is None:
            return "ended"
        if program.held:
            return "held" if program.standing else "stopping"
        return "approaching" if program.stretch.before else "following"
