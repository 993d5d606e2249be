"""The controllers of robots whose programs can be written, and whether they can hold what a plan promises.

A controller goes from point to point in its own way. Where it goes in straight lines of the joints, it leaves a motion
with acceleration a by at most a T^2 / 8 between points a time T apart; where it also rounds the corners, which begins
halfway between two points at the earliest, by three times as much.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.records import SampledMotion

JOINTS: Final = 6
MAX_DEVIATION: Final = 0.002  # [rad] of a joint between two points: 2 mm at a reach of 1 m
PERIOD_TOLERANCE: Final = 1e-6  # of a cycle


@dataclass(frozen=True)
class RobotTarget:
    """A controller of robots.

    Attributes:
        title: what its programs are called.
        suffix: of its files.
        template: that makes a program.
        degrees: whether its joints are in degrees; else in radians.
        cycle: in whole multiples of which its points lie apart [s].
        min_cycles: between two points at least.
        cycles: between two points where nobody asks for others.
        rounds_corners: whether it goes past points, not through them.
        max_points: of a program.
        remark_width: characters of a remark at most.
    """

    title: str
    suffix: str
    template: str
    degrees: bool
    cycle: float
    min_cycles: int
    cycles: int
    rounds_corners: bool
    max_points: int
    remark_width: int = 110

    @property
    def rate(self) -> float:
        """Points a second where nobody asks for others [Hz]."""
        return 1.0 / (self.cycles * self.cycle)


TARGETS: Final[dict[str, RobotTarget]] = {
    "urscript": RobotTarget("Universal Robots, URScript", ".script", "urscript.j2", False, 0.002, 1, 4, False, 20_000),
    "rapid": RobotTarget("ABB, RAPID", ".mod", "rapid.j2", True, 0.004, 2, 3, True, 10_000),
    "krl": RobotTarget("KUKA, KRL", ".src", "krl.j2", True, 0.004, 2, 3, False, 10_000),
    "ls": RobotTarget("Fanuc, LS", ".ls", "ls.j2", True, 0.008, 1, 1, True, 9_999, remark_width=30),
}


def largest_deviation(motion: SampledMotion, target: RobotTarget) -> tuple[float, str, float]:
    """Return by how much a controller may leave a motion between its points [rad], by which joint, and when [s]."""
    bends = np.abs(np.diff(motion.positions, 2, axis=0))  # a T^2
    if not len(bends):
        return 0.0, "", 0.0
    row, joint = np.unravel_index(int(np.argmax(bends)), bends.shape)
    share = 3 / 8 if target.rounds_corners else 1 / 8
    return share * float(bends[row, joint]), motion.joint_names[joint], float(motion.times[row + 1])


def check_target(motion: SampledMotion, target: RobotTarget) -> None:
    """Check that a controller can hold what a plan promises.

    Raises:
        UnusableInput: its points would lie otherwise in time, it would leave the motion too far between them, they are
            too many, or it has another number of joints.
    """
    if motion.positions.shape[1] != JOINTS:
        raise UnusableInput(f"the arm has {motion.positions.shape[1]} joints; programs of {target.title} have {JOINTS}")
    cycles = 1.0 / (motion.rate * target.cycle)
    if abs(cycles - round(cycles)) > PERIOD_TOLERANCE or round(cycles) < target.min_cycles:
        raise UnusableInput(
            f"at {motion.rate:g} Hz points lie {1e3 / motion.rate:.4g} ms apart; {target.title} takes whole multiples "
            f"of {1e3 * target.cycle:g} ms, at least {target.min_cycles}: ask for {_rate(target, round(cycles)):.9g} Hz"
        )
    if len(motion.times) > target.max_points:
        raise UnusableInput(
            f"{len(motion.times)} points are over {target.max_points}, the limit of a program of {target.title}; ask "
            "for fewer a second"
        )
    _check_deviation(motion, target, round(cycles))


def _check_deviation(motion: SampledMotion, target: RobotTarget, cycles: int) -> None:
    deviation, joint, time = largest_deviation(motion, target)
    if deviation <= MAX_DEVIATION:
        return
    fewer = int(cycles * np.sqrt(MAX_DEVIATION / deviation))
    way_out = (
        f"ask for {_rate(target, fewer):.9g} Hz"
        if fewer >= target.min_cycles
        else "plan the path slower (motion.path_share)"
    )
    raise UnusableInput(
        f"between points {1e3 / motion.rate:.4g} ms apart {target.title} may leave the plan by {deviation:.4f} rad "
        f"({joint} at {time:.2f} s), limit {MAX_DEVIATION:g}; {way_out}"
    )


def _rate(target: RobotTarget, cycles: int) -> float:
    """Return the points a second [Hz] that lie so many cycles apart, or as few as the controller takes."""
    return 1.0 / (max(cycles, target.min_cycles) * target.cycle)
