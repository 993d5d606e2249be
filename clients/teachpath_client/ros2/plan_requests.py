"""Trajectories that ask for the execution of a plan: which one is meant, or why none begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from teachpath_client.ros2.messages import SECOND, TRAJECTORY, Malformed, decode, stamp_of
from teachpath_client.ros2.trajectories import MAX_POINTS, JointMotion, difference, read_trajectory
from teachpath_client.station import Station

MAX_AGE: Final = 2.0  # [s] of a request's stamp, either way: who sends it has a clock of his own
PLAN_RATE: Final = 500.0  # [Hz] of the plans that requests are compared with
MAX_SIZE: Final = 20_000_000  # bytes of a message; 100,000 points of six joints have 17,200,000


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """The motion of a plan, as the station writes it.

    Attributes:
        motion: with velocities.
        duration: [s].
    """

    motion: JointMotion
    duration: float


class PlanRequests:
    """Judges messages; it moves nothing.

    Args:
        joints: names of the arm's joints, in its order.
        plans: that may be asked for, by their ids.
    """

    def __init__(self, joints: Sequence[str], plans: Mapping[str, PlannedMotion]) -> None:
        self._joints, self._plans = joints, plans
        self._newest = 0  # stamp of the newest request [ns]

    def plan_of(self, content: bytes, now_ns: int) -> str | None:
        """Return the id of the plan that a message asks for; None: it has no points, which asks for a stop.

        A stamp counts once, whatever becomes of its request.

        Args:
            content: a JointTrajectory in CDR.
            now_ns: the time [ns since the Unix epoch].

        Raises:
            Malformed: it is none, too old, came before, or is the motion of no plan that may be asked for.
        """
        message = decode(TRAJECTORY, content, largest=MAX_SIZE)
        if not message.points:
            return None
        self._check_stamp(stamp_of(message.header), now_ns)
        asked = read_trajectory(message, self._joints)
        off = {name: difference(asked, plan.motion, plan.duration) for name, plan in self._plans.items()}
        same = [name for name, where in off.items() if not where]
        if len(same) > 1:
            raise Malformed(f"it is the motion of {' and of '.join(same)}: let only one of them be asked for")
        if not same:
            raise Malformed("it is no plan's motion: " + "; ".join(f"{name}: {where}" for name, where in off.items()))
        return same[0]

    def _check_stamp(self, stamp_ns: int, now_ns: int) -> None:
        if stamp_ns == 0:
            raise Malformed("it has no stamp; set header.stamp to the time at which it is sent")
        age = (now_ns - stamp_ns) / SECOND
        if abs(age) > MAX_AGE:
            when = f"{age:.1f} s old" if age > 0.0 else f"{-age:.1f} s ahead of the clock here"
            raise Malformed(f"its stamp is {when}, limit {MAX_AGE:g} s; are the clocks of both machines right?")
        if stamp_ns <= self._newest:
            raise Malformed("its stamp is not later than that of the request before: it came twice")
        self._newest = stamp_ns


def planned_motion(station: Station, plan: str, joints: Sequence[str]) -> PlannedMotion:
    """Return the motion of a plan; raises ClientError where its certificate does not hold.

    Args:
        station: that has it.
        plan: its id.
        joints: names of the arm's joints, in its order.
    """
    duration = station.get_plan(plan).duration
    content = station.program(plan, "cdr", rate=min(PLAN_RATE, (MAX_POINTS - 1) / duration))
    message = decode(TRAJECTORY, content, largest=MAX_SIZE)
    return PlannedMotion(read_trajectory(message, joints), duration)
