"""One execution from where the arm is: approach, grasp, follow, release, retreat, each stretch under a governor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from teachpath.motion.certificate import track, verify
from teachpath.motion.governor import SLOWEST, Governor
from teachpath.motion.joints import ARM
from teachpath.motion.moves import approach, retreat, straight
from teachpath.motion.puma560 import Array
from teachpath.motion.scene import CollisionModel, Load
from teachpath.motion.settings import MotionSettings
from teachpath.motion.timing import RESERVE
from teachpath.motion.track import Track
from teachpath.records import Plan

NOWHERE: Final = 1e-9  # rad, a move shorter than this is none


@dataclass(frozen=True, eq=False)
class Stretch:
    """A piece of an execution: motion along a track, or a rest when `track` is None.

    Attributes:
        name: in words, for the operator.
        before: whether it comes before the path is followed.
        taught: whether this is the learned path itself.
        gripper_closed: while it lasts.
        rest: how long a rest lasts [s].
    """

    name: str
    before: bool
    gripper_closed: bool
    track: Track | None = None
    rest: float = 0.0
    taught: bool = False


@dataclass(frozen=True, eq=False)
class Moment:
    """The arm's nominal motion at one instant: (6,) in rad, rad/s, rad/s^2."""

    position: Array
    velocity: Array
    acceleration: Array
    gripper_closed: bool


class Program:
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
        self._rest_of: Iterator[Stretch] = iter(stretches(plan, here, settings, dwell))
        self._length = float(plan.lengths[-1])
        self._override, self._held, self._period = override, False, period
        self._elapsed = 0.0
        self._done = 0.0
        still = np.zeros(6)
        self._moment = Moment(np.array(here, dtype=np.float64), still, still, False)
        self._stretch: Stretch | None = None
        self._governor: Governor | None = None
        self._advance()

    @property
    def stretch(self) -> Stretch | None:
        """The stretch now under way; None when all are done."""
        return self._stretch

    @property
    def finished(self) -> bool:
        """Whether all is done."""
        return self._stretch is None

    @property
    def standing(self) -> bool:
        """Whether the arm's nominal motion is at rest."""
        return self._governor is None or self._governor.progress.standing

    @property
    def held(self) -> bool:
        """Whether rest was asked for, by `hold` or an override of zero, or nothing is left of the way back."""
        governor = self._governor
        returned = governor is not None and governor.backward and governor.progress.standing
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
    def place(self) -> str:
        """Where the execution is, in words."""
        if self._stretch is None:
            return "at its end"
        return f"at s = {self._done:.3f} m" if self._stretch.taught else self._stretch.name

    def hold(self) -> None:
        """Come to rest on the path as soon as the limits allow."""
        self._held = True
        if self._governor is not None:
            self._governor.hold()

    def resume(self) -> None:
        """Go on."""
        self._held = False
        if self._governor is not None:
            self._governor.resume()

    def reverse(self) -> None:
        """Go back to the beginning of this stretch and wait there; between two stretches, wait."""
        if self._governor is None:
            self.hold()
            return
        self._held = False
        self._governor.reverse()

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed from now on."""
        self._override = share
        if self._governor is not None:
            self._governor.set_override(share)

    def step(self) -> Moment:
        """Advance by one control period and return the nominal motion; never raises."""
        stretch, governor = self._stretch, self._governor
        if stretch is None:
            return self._moment
        if governor is None:
            self._elapsed += 0.0 if self.held else self._period
            if self._elapsed >= stretch.rest:
                self._advance()
            return self._moment
        state = governor.step()
        if stretch.taught:
            self._done = state.s
        position, velocity, acceleration = governor.motion[:, :6].copy()
        self._moment = Moment(position, velocity, acceleration, stretch.gripper_closed)
        if state.finished:
            self._advance()
        return self._moment

    def _advance(self) -> None:
        self._stretch = next(self._rest_of, None)
        self._elapsed, self._governor = 0.0, None
        if self._stretch is None:
            return
        closed = self._stretch.gripper_closed
        self._moment = Moment(self._moment.position, np.zeros(6), np.zeros(6), closed)
        if self._stretch.track is not None:
            self._governor = Governor(self._stretch.track, self._period, override=self._override)
            if self._held:
                self._governor.hold()


def stretches(plan: Plan, here: Array, settings: MotionSettings, dwell: float) -> list[Stretch]:
    """Return what an execution does from `here` (6,) to its end.

    Raises:
        PathRefused: the way from here to the start of the path, or home from its goal, is not free.
    """
    carries = plan.scene.carried is not None
    load = Load(placed=plan.scene.carried.position) if plan.scene.carried else None
    model = CollisionModel(plan.scene)
    stops = approach(model, here, plan.above_start, settings, load=load, gripper_open=carries)
    start, goal = plan.joints[0], plan.joints[-1]
    leave = retreat(model, start, goal, plan.above_goal, settings)
    closed = not carries
    return [
        *[piece for a, b in pairwise(stops) for piece in _move("on the approach", a, b, True, closed, settings)],
        *_move("on the way down", plan.above_start, start, True, closed, settings),
        Stretch("closing the gripper", True, True, rest=dwell if carries else 0.0),
        Stretch("on the path", False, True, track(plan), taught=True),
        Stretch("opening the gripper", False, closed, rest=dwell if carries else 0.0),
        *_move("on the way up", goal, plan.above_goal, False, closed, settings),
        *_move("on the way home", *leave, False, closed, settings),
    ]


def _move(name: str, start: Array, goal: Array, before: bool, closed: bool, settings: MotionSettings) -> list[Stretch]:
    if np.abs(goal - start).max() < NOWHERE:
        return []
    limits = ARM.scaled(*[settings.move_share] * 3)
    return [Stretch(name, before, closed, straight(start, goal, limits, reserve=RESERVE))]
