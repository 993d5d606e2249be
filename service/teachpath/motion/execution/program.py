"""One execution from where the arm is: approach, grasp, follow, release, retreat, each stretch under a governor."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Final

import numpy as np

from teachpath.errors import Conflict
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.execution.governor import SLOWEST, Governor
from teachpath.motion.execution.segments import Detour, MotionState, Segment, plan_return_path, stretches
from teachpath.motion.planning.certificate import verify
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing.jog import jog_trajectory, time_at_length
from teachpath.motion.timing.timed_trajectory import TimedTrajectory
from teachpath.records import Plan

REACHED: Final = 1e-5  # m, a node as near as this is where the arm is


class PlanProgram:
    """Runs through the stretches, one control period at a time.

    Args:
        plan: certified; checked again here.
        here: (6,) where the arm really is, at rest [rad].
        settings: as for planning.
        override: share of the full speed, 0 to 1.
        dwell: how long the gripper takes to close or open [s].
        period: between two setpoints [s].

    Raises:
        PathRefused: the plan has changed since it was certified, or the way from here to its start is not free.
    """

    def __init__(
        self,
        plan: Plan,
        here: Array,
        settings: MotionSettings,
        *,
        override: float = 1.0,
        dwell: float = 0.5,
        period: float = 0.004,
    ) -> None:
        verify(plan)
        self._plan, self._settings = plan, settings
        self._rest_of: Iterator[Segment] = iter(stretches(plan, here, settings, dwell))
        self._length = float(plan.lengths[-1])
        self._override, self._held, self._waits, self._period = override, False, False, period
        self._elapsed = 0.0
        self._done = 0.0
        still = np.zeros(6)
        self._moment = MotionState(np.array(here, dtype=np.float64), still, still, False)
        self._stretch: Segment | None = None
        self._governor: Governor | None = None  # of the stretch
        self._aside: Detour | None = None
        self._aside_governors: deque[Governor] = deque()
        self._advance()

    @property
    def before(self) -> bool:
        """Whether what it does comes before the path is followed."""
        return self._stretch is not None and self._stretch.before

    @property
    def over(self) -> bool:
        """Whether all is done."""
        return self._stretch is None

    @property
    def standing(self) -> bool:
        """Whether the arm's nominal motion is at rest."""
        governor = self._driver
        return governor is None or governor.progress.standing

    @property
    def held(self) -> bool:
        """Whether rest was asked for, by `hold` or an override of zero, or nothing is left of the way back."""
        governor = self._driver
        returned = governor is not None and governor.backward and governor.progress.standing and not self._waits
        return self._held or self._override < SLOWEST or returned

    @property
    def why_held(self) -> str:
        """Why it stands without having been told to, in words."""
        if self._override < SLOWEST:
            return f"the override is {self._override:g}"
        return "" if self._held else f"back at the beginning {self.place}; resume to go on"

    @property
    def stopped(self) -> bool:
        """Whether `hold` was asked for and not taken back."""
        return self._held

    @property
    def waits(self) -> bool:
        """Whether it waits for an arm that is late."""
        return self._waits

    @property
    def here(self) -> Array:
        """The newest setpoint's configuration (6,) [rad]."""
        return self._moment.position

    @property
    def override(self) -> float:
        """Share of the full speed asked for."""
        return self._override

    @property
    def progress(self) -> float:
        """Share of the learned path's length that is done, 0 to 1."""
        return min(self._done / self._length, 1.0)

    @property
    def length(self) -> float:
        """How far along the learned path it is [m]."""
        return self._done

    @property
    def doing(self) -> str:
        """What it does, in words."""
        if self._aside is not None and self._aside.name:
            return self._aside.name
        return self._stretch.name if self._stretch is not None else ""

    @property
    def place(self) -> str:
        """Where the execution is, in words."""
        if self._stretch is None:
            return "at its end"
        return f"at s = {self._done:.3f} m" if self.doing == "on the path" else self.doing

    def hold(self) -> None:
        """Come to rest on the path as soon as the limits allow."""
        self._held = True
        for governor in self._governors():
            governor.hold()

    def wait(self, waits: bool) -> None:
        """Come to rest on the path until the arm has caught up, or go on as was asked for."""
        self._waits = waits
        for governor in self._governors():
            governor.wait(waits)

    def resume(self) -> None:
        """Go on."""
        self._held = False
        for governor in self._governors():
            governor.resume()

    def reverse(self) -> None:
        """Go back to the beginning of this stretch or step and wait there; between two stretches, wait."""
        if self._governor is None:
            self.hold()
            return
        self._held = False
        step = self._aside is not None and self._aside.landing is not None
        for governor in self._aside_governors if step else [*self._aside_governors, self._governor]:
            if governor is self._governor or step:
                governor.reverse()
            else:
                governor.resume()

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed from now on."""
        self._override = share
        for governor in self._governors():
            governor.set_override(share)

    def plan_step(self, *, length: float = 0.0, nodes: int = 0) -> Detour:
        """Work out a step from where the arm is held on the path; `take_aside` begins it.

        Args:
            length: along the path [m], negative is back; a step beyond an end goes to the end.
            nodes: the same in nodes of the plan, from the one where the arm is or just was.

        Raises:
            Conflict: the arm is not held on the path, or the path ends there.
        """
        stretch, governor = self._stretch, self._governor
        if stretch is None or stretch.track is None or governor is None or not stretch.taught:
            raise Conflict(
                f"steps are taken on the path; the arm is {self.doing or 'at rest'}: resume, and hold it there"
            )
        if self._aside is not None and self._aside.landing is None:
            raise Conflict(f"the arm is {self.doing}; resume, and hold it on the path")
        if not (self.held and self.standing):
            raise Conflict("the arm still moves; hold it first, then step")
        goal = self._node(nodes) if nodes else self._done + length
        landing = time_at_length(stretch.track, min(max(goal, 0.0), self._length))
        begin = governor.tau if self._aside is None else time_at_length(stretch.track, self._done)
        return Detour("", (jog_trajectory(stretch.track, begin, landing, 1.0 / self._period),), landing)

    def _node(self, count: int) -> float:
        """Return the length [m] of the node that is `count` nodes away; one that is reached already does not count."""
        lengths = self._plan.lengths
        if count > 0:
            node = int(np.searchsorted(lengths, self._done + REACHED, side="right")) + count - 1
        else:
            node = int(np.searchsorted(lengths, self._done - REACHED, side="left")) + count
        return float(lengths[min(max(node, 0), len(lengths) - 1)])

    def plan_return(self, here: Array) -> Detour:
        """Work out the way back from `here` (6,) to the point where the arm was held; `take_aside` begins it.

        Raises:
            PathRefused: the way is not free.
        """
        assert self._stretch is not None
        tracks = plan_return_path(self._plan, self._stretch, here, self.here, self._settings)
        return Detour("on the way back to the path", tuple(tracks))

    def take_aside(self, aside: Detour) -> None:
        """Begin a step or a way back; the arm rests at its beginning."""
        self._aside = aside if aside.tracks else None
        self._aside_governors = deque(self._governor_of(track) for track in aside.tracks)
        self._held = False

    def step(self) -> MotionState:
        """Advance by one control period and return the nominal motion; never raises."""
        stretch, governor = self._stretch, self._driver
        if stretch is None:
            return self._moment
        if governor is None:
            self._elapsed += 0.0 if self.held or self._waits else self._period
            if self._elapsed >= stretch.rest:
                self._advance()
            return self._moment
        state = governor.step()
        on_path = stretch.taught and self.doing == stretch.name
        if on_path:
            self._done = self._length if state.finished else state.s  # the table ends within rounding of the length
        position, velocity, acceleration = governor.motion[:, :6].copy()
        self._moment = MotionState(position, velocity, acceleration, stretch.gripper_closed, on_path)
        if state.finished and not self.held:
            self._finish()
        return self._moment

    @property
    def _driver(self) -> Governor | None:
        return self._aside_governors[0] if self._aside_governors else self._governor

    def _governors(self) -> list[Governor]:
        return [*self._aside_governors, *([self._governor] if self._governor is not None else [])]

    def _governor_of(self, track: TimedTrajectory) -> Governor:
        governor = Governor(track, self._period, override=self._override)
        governor.wait(self._waits)
        return governor

    def _finish(self) -> None:
        aside = self._aside
        if aside is None:
            self._advance()
            return
        self._aside_governors.popleft()
        if self._aside_governors:
            return
        self._aside = None
        if aside.landing is not None and self._governor is not None:
            self._governor.place(aside.landing)
            self._held = True

    def _advance(self) -> None:
        self._stretch = next(self._rest_of, None)
        self._elapsed, self._governor = 0.0, None
        if self._stretch is None:
            return
        closed = self._stretch.gripper_closed
        self._moment = MotionState(self._moment.position, np.zeros(6), np.zeros(6), closed)
        if self._stretch.track is not None:
            self._governor = self._governor_of(self._stretch.track)
            if self._held:
                self._governor.hold()
