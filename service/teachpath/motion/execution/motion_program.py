"""What the executor runs, setpoint by setpoint: a certified plan, or the motion that a live hand leads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from teachpath.motion.arm.puma560 import Array
from teachpath.motion.execution.segments import Detour, MotionState, RestPoint


@dataclass(frozen=True, slots=True)
class FollowedHand:
    """A live hand that the arm follows, as `ExecutorStatus` has it.

    Attributes:
        hand: its tracker; empty: there is none.
        hand_scene: the scene in which it is followed.
        hindrance: what keeps the tool from where the hand is, in words; empty: nothing.
        awaits_clutch: whether the arm rests until the clutch is pressed, and nothing else keeps it.
    """

    hand: str = ""
    hand_scene: str = ""
    hindrance: str = ""
    awaits_clutch: bool = False


class MotionProgram(Protocol):
    """A motion that advances by one control period at a time and obeys the operator meanwhile."""

    @property
    def before_path(self) -> bool:
        """Whether what it does comes before the path is followed."""

    @property
    def finished(self) -> bool:
        """Whether all is done."""

    @property
    def at_rest(self) -> bool:
        """Whether the arm's nominal motion is at rest."""

    @property
    def held(self) -> bool:
        """Whether the arm is to rest, because of `hold` or for a reason of the program's own."""

    @property
    def hold_requested(self) -> bool:
        """Whether `hold` was called and not taken back."""

    @property
    def hold_reason(self) -> str:
        """Why the arm is held without a call of `hold`, in words."""

    @property
    def waiting(self) -> bool:
        """Whether the program waits for an arm that is late."""

    @property
    def current_q(self) -> Array:
        """Configuration (joints,) of the newest setpoint [rad]."""

    @property
    def override(self) -> float:
        """Share of the full speed that is asked for."""

    @property
    def progress(self) -> float:
        """Share of the learned path's length that is done, 0 to 1."""

    @property
    def arc_length(self) -> float:
        """Arc length of the learned path that is done [m]."""

    @property
    def activity(self) -> str:
        """What the arm does, in words."""

    @property
    def followed_hand(self) -> FollowedHand | None:
        """The live hand that the program follows; None: it follows a plan."""

    @property
    def location(self) -> str:
        """Where the execution is, in words."""

    @property
    def latency(self) -> tuple[float, float]:
        """Median and 99th percentile of the time from a hand's sample to the setpoint that answers it [us]."""

    def step(self) -> MotionState:
        """Advance by one control period and return the nominal motion; never raises."""

    @property
    def state(self) -> MotionState:
        """The motion of the newest setpoint."""

    def way_to_rest(self) -> tuple[Array, RestPoint]:
        """Return the states (n, 3, 6) of the way to rest from the newest setpoint, and where it ends.

        They are position [rad], velocity and acceleration one control period apart, the first one period ahead.
        """

    def restart(self, point: RestPoint) -> str:
        """Go on from where the arm rests after a way to rest; return why it is held there instead, or nothing."""

    def advance_planning(self) -> None:
        """Do one slice of the planning, in the time that is left behind a setpoint."""

    def hold(self) -> None:
        """Come to rest as soon as the limits allow."""

    def resume(self) -> None:
        """Go on after `hold`."""

    def reverse(self) -> None:
        """Go back along the path."""

    def set_override(self, share: float) -> None:
        """Go at `share` of the full speed from now on."""

    def set_waiting(self, waiting: bool) -> None:
        """Come to rest because the arm is late, or go on because it has caught up."""

    def plan_step(self, *, length: float = 0.0, nodes: int = 0) -> Detour:
        """Plan a step along the path, by a length [m] or a number of the plan's nodes; negative is back.

        Raises:
            Conflict: no step can be taken from here.
        """

    def plan_return(self, start_q: Array) -> Detour:
        """Plan the way back to `current_q` from the configuration `start_q` (joints,), where the arm rests.

        Raises:
            Conflict: the program has no way back.
            PathRefused: the way is not free.
        """

    def start_detour(self, detour: Detour) -> None:
        """Follow a detour that was planned; the arm rests at its beginning."""

    def close(self) -> None:
        """Free what the program holds; it takes no further step."""
