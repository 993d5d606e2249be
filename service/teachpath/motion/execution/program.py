"""The motion program of a certified plan: approach, grasp, follow, release, retreat, each segment under a governor."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from teachpath.errors import Conflict
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.governor import MIN_OVERRIDE, Governor, WayToRest
from teachpath.motion.execution.segments import Detour, MotionState, RestPoint, Segment, plan_return_path, plan_segments
from teachpath.motion.planning.digest import verify
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.jog import node_length, time_at_length
from teachpath.motion.timing.timed_trajectory import TimedTrajectory
from teachpath.records import Array, Plan


class PlanProgram:
    """Runs the segments of an execution in order, one control period at a time.

    Args:
        plan: certified; checked again here.
        start_q: (joints,) where the arm rests [rad].
        settings: as for planning.
        arm: that the plan is for.
        override: share of the full speed, 0 to 1.
        dwell: how long the gripper takes to close or open [s].
        period: between two setpoints [s].

    Attributes:
        state: the motion of the newest setpoint.
        waiting: whether the program waits for an arm that is late.
        override: share of the full speed that is asked for.
        arc_length: of the learned path that is done [m].

    Raises:
        PathRefused: the plan has changed since it was certified, or the way from `start_q` to its start is not free.
    """

    latency: tuple[float, float] = (0.0, 0.0)  # a plan answers no hand
    followed_hand: None = None

    def __init__(
        self,
        plan: Plan,
        start_q: Array,
        settings: MotionSettings,
        arm: Arm,
        *,
        override: float = 1.0,
        dwell: float = 0.5,
        period: float = 0.004,
    ) -> None:
        verify(plan, arm)
        self._plan, self._settings, self._arm = plan, settings, arm
        self._segments = plan_segments(plan, start_q, settings, arm, dwell)
        self._next = 0  # index of the segment behind the present one
        self._length = float(plan.lengths[-1])
        self.override: float = override
        self._held = False
        self.waiting: bool = False
        self._period, self._elapsed = period, 0.0
        self.arc_length: float = 0.0
        self.state: MotionState = MotionState(q := np.array(start_q, dtype=np.float64), 0.0 * q, 0.0 * q, False)
        self._segment: Segment | None = None
        self._governor: Governor | None = None  # of the segment
        self._detour: Detour | None = None
        self._detour_governors: deque[Governor] = deque()
        self._advance()

    @property
    def before_path(self) -> bool:
        """Whether the present segment comes before the path."""
        return self._segment is not None and self._segment.before_path

    @property
    def finished(self) -> bool:
        """Whether all segments are done."""
        return self._segment is None

    @property
    def at_rest(self) -> bool:
        """Whether the arm's nominal motion is at rest."""
        governor = self._active_governor
        return governor is None or governor.progress.at_rest

    @property
    def held(self) -> bool:
        """Whether the arm is to rest: after `hold`, at an override of zero, or at the end of the way back."""
        governor = self._active_governor
        # On the way back it may rest elsewhere, too: where the arm was late, until that goes on.
        returned = governor is not None and governor.reversing and governor.progress.at_rest and governor.tau <= 0.0
        return self._held or self.override < MIN_OVERRIDE or returned

    @property
    def hold_reason(self) -> str:
        """Why the arm is held without a call of `hold`, in words."""
        if self.override < MIN_OVERRIDE:
            return f"the override is {self.override:g}"
        # Told to go back, it is said to be held until its next step.
        return f"back at the beginning {self.location}; resume to go on" if self.held and not self._held else ""

    @property
    def hold_requested(self) -> bool:
        """Whether `hold` was called and not taken back."""
        return self._held

    @property
    def current_q(self) -> Array:
        """Configuration (joints,) of the newest setpoint [rad]."""
        return self.state.position

    @property
    def progress(self) -> float:
        """Share of the learned path's length that is done, 0 to 1."""
        return min(self.arc_length / self._length, 1.0)

    @property
    def activity(self) -> str:
        """What the arm does, in words."""
        if self._detour is not None and self._detour.name:
            return self._detour.name
        return self._segment.name if self._segment is not None else ""

    @property
    def location(self) -> str:
        """Where the execution is, in words."""
        if self._segment is None:
            return "at its end"
        return f"at s = {self.arc_length:.3f} m" if self.activity == "on the path" else self.activity

    def hold(self) -> None:
        """Come to rest on the path as soon as the limits allow."""
        self._held = True
        for governor in self._governors():
            governor.hold()

    def set_waiting(self, waiting: bool) -> None:
        """Come to rest on the path until the arm has caught up, or go on."""
        self.waiting = waiting
        for governor in self._governors():
            governor.set_waiting(waiting)

    def resume(self) -> None:
        """Go on to the end."""
        self._held = False
        for governor in self._governors():
            governor.resume()

    def reverse(self) -> None:
        """Go back to the beginning of the segment or step, and hold there; without a motion under way, hold."""
        if self._governor is None:
            self.hold()
            return
        self._held = False
        step = self._detour is not None and self._detour.is_step
        for governor in self._detour_governors if step else [*self._detour_governors, self._governor]:
            if governor is self._governor or step:
                governor.reverse()
            else:
                governor.resume()

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed from now on."""
        self.override = share
        for governor in self._governors():
            governor.set_override(share)

    def plan_step(self, *, length: float = 0.0, nodes: int = 0) -> Detour:
        """Plan a step along the path by a length [m] or by nodes of the plan, at most to an end of the path.

        Raises:
            Conflict: the arm is not held on the path, or the path ends there.
        """
        segment, governor = self._segment, self._governor
        if segment is None or segment.trajectory is None or governor is None or not segment.is_path:
            activity = self.activity or "at rest"
            raise Conflict(f"steps are taken on the path; the arm is {activity}: resume, and hold it there")
        if self._detour is not None and not self._detour.is_step:
            raise Conflict(f"the arm is {self.activity}; resume, and hold it on the path")
        if not (self.held and self.at_rest):
            raise Conflict("the arm still moves; hold it first, then step")
        done = self.arc_length
        goal = node_length(self._plan.lengths, done, nodes) if nodes else done + length
        begin = governor.tau if self._detour is None else time_at_length(segment.trajectory, done)
        return Detour.of_step(segment.trajectory, begin, min(max(goal, 0.0), self._length), 1.0 / self._period)

    def plan_return(self, start_q: Array) -> Detour:
        """Plan the way back from `start_q` (joints,) to where it was held; raises PathRefused if it is not free."""
        assert self._segment is not None
        way = plan_return_path(self._plan, self._segment, start_q, self.current_q, self._settings, self._arm)
        return Detour("on the way back to the path", tuple(way))

    def advance_planning(self) -> None:
        """Do nothing: all was planned before the start."""

    def start_detour(self, detour: Detour) -> None:
        """Follow a step or a way back; the arm rests at its beginning."""
        self._detour = detour if detour.trajectories else None
        self._detour_governors = deque(self._governor_of(trajectory) for trajectory in detour.trajectories)
        self._held = False

    def step(self) -> MotionState:
        """Advance by one control period and return the nominal motion; never raises."""
        segment, governor = self._segment, self._active_governor
        if segment is None:
            return self.state
        if governor is None:
            self._elapsed += 0.0 if self.held or self.waiting else self._period
            self.state = replace(self.state, output="" if self.held or self.waiting else segment.output)
            if self._elapsed >= segment.rest_time:
                self._advance()
            return self.state
        state = governor.step()
        on_path = segment.is_path and self.activity == segment.name
        if on_path:
            # The table of the whole path ends a last bit away from its length; that of a step ends where the step does.
            self.arc_length = self._length if state.finished and self._detour is None else state.s
        output = segment.output if on_path and self._detour is None and governor.goes_forward else ""
        position, velocity, acceleration = governor.motion[:, :-1].copy()
        self.state = MotionState(position, velocity, acceleration, segment.gripper_closed, on_path, output)
        if state.finished and not self.held:
            self._finish()
        return self.state

    def close(self) -> None:
        """Do nothing: a plan holds nothing that must be freed."""

    def way_to_rest(self) -> tuple[Array, RestPoint]:
        """Return the states (n, 3, joints) of the way to rest from the newest setpoint, and where it ends."""
        active = self._active_governor
        way = active.way_to_rest() if active is not None else WayToRest(np.empty((0, 3, len(self.state.position))), 0.0)
        end = way.states[-1, 0] if len(way.states) else self.state.position
        taus = tuple((governor, way.tau if governor is active else governor.tau) for governor in self._governors())
        return way.states, RestPoint(end, self._next - 1, self._detour, taus, self._elapsed, self.state.on_path)

    def restart(self, point: RestPoint) -> str:
        """Go on from where the arm rests, as the program was at that setpoint, whatever it has done since.

        Returns:
            Why it is held there instead: an arm that was told to step goes no farther by itself. Else nothing.
        """
        steps = any(detour is not None and detour.is_step for detour in (point.detour, self._detour))
        self._held = self._held or steps
        self._next = point.segment
        self._advance()
        self._elapsed, self._detour = point.elapsed, point.detour
        for governor, tau in point.governors:
            governor.restart_at(tau, held=self._held)
        governors = deque(governor for governor, _ in point.governors)
        if self._governor is not None:
            self._governor = governors.pop()
        self._detour_governors = governors
        self.state = replace(self.state, position=point.position, on_path=point.on_path, output="")
        if point.on_path and (active := self._active_governor) is not None:
            self.arc_length = float(active.motion[0, -1])
        if steps and governors and governors[0].progress.finished:
            self._finish()
            return ""
        late = f"setpoints were late on a step, and the arm rests {self.location}, short of its end"
        return f"{late}: step again, or resume" if steps else ""

    @property
    def _active_governor(self) -> Governor | None:
        return self._detour_governors[0] if self._detour_governors else self._governor

    def _governors(self) -> list[Governor]:
        return [*self._detour_governors, *([self._governor] if self._governor is not None else [])]

    def _governor_of(self, trajectory: TimedTrajectory) -> Governor:
        governor = Governor(trajectory, self._period, override=self.override)
        governor.set_waiting(self.waiting)
        return governor

    def _finish(self) -> None:
        if self._detour is None:
            self._advance()
            return
        self._detour_governors.popleft()
        if self._detour_governors:
            return
        end_time, self._detour = self._detour.end_time, None
        if end_time is not None and self._governor is not None:
            self._governor.rest_at(end_time)
            self._held = True

    def _advance(self) -> None:
        self._segment = self._segments[self._next] if self._next < len(self._segments) else None
        self._next += 1
        self._elapsed, self._governor = 0.0, None
        if self._segment is None:
            return
        self.state = self._segment.begin(self.state)
        if self._segment.trajectory is not None:
            self._governor = self._governor_of(self._segment.trajectory)
            if self._held:
                self._governor.hold()
