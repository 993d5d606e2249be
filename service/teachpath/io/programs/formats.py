"""The formats in which motions leave."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.programs.joint_trajectory import joint_trajectory_cdr, joint_trajectory_json
from teachpath.io.programs.robot_program import robot_program
from teachpath.io.programs.robot_targets import TARGETS
from teachpath.io.programs.rosbag import joint_trajectory_bag
from teachpath.io.programs.timed_csv import timed_csv
from teachpath.records import SampledMotion

MAX_POINTS: Final = 100_000  # of one file
MIN_RATE, MAX_RATE = 1.0, 10_000.0  # [Hz]


@dataclass(frozen=True)
class ProgramFormat:
    """A format of motions.

    Attributes:
        title: what it is, for people.
        suffix: of its files.
        media_type: of its files.
        write: makes the content of a file.
        rate: instants a second where nobody asks for others [Hz].
        certified_only: whether it moves a robot, so that it may hold nothing but a certified motion.
    """

    title: str
    suffix: str
    media_type: str
    write: Callable[[SampledMotion], bytes]
    rate: float = 250.0
    certified_only: bool = False


FORMATS: Final[dict[str, ProgramFormat]] = {
    "csv": ProgramFormat("table of time and joints", ".csv", "text/csv; charset=utf-8", timed_csv),
    "json": ProgramFormat("ROS 2 JointTrajectory, JSON", ".json", "application/json", joint_trajectory_json),
    "cdr": ProgramFormat("ROS 2 JointTrajectory, CDR", ".cdr", "application/octet-stream", joint_trajectory_cdr),
    "mcap": ProgramFormat("ROS 2 bag, MCAP", ".mcap", "application/octet-stream", joint_trajectory_bag, 100.0),
} | {
    name: ProgramFormat(
        target.title,
        target.suffix,
        "text/plain; charset=us-ascii",
        partial(robot_program, target=target),
        target.rate,
        True,
    )
    for name, target in TARGETS.items()
}


def format_named(name: str) -> ProgramFormat:
    """Return a format by its name; raises UnusableInput."""
    if name not in FORMATS:
        raise UnusableInput(f"there is no format {name!r} of motions; known: {', '.join(FORMATS)}")
    return FORMATS[name]


def check_rate(rate: float, duration: float) -> None:
    """Check that a motion of `duration` [s] can be written at `rate` [Hz]; raises UnusableInput."""
    if not MIN_RATE <= rate <= MAX_RATE:
        raise UnusableInput(f"a rate of {rate:g} Hz is outside {MIN_RATE:g} to {MAX_RATE:g}")
    if duration * rate > MAX_POINTS:
        raise UnusableInput(
            f"{duration:.1f} s at {rate:g} Hz are over {MAX_POINTS} points, the limit of a file; ask for "
            f"{int(MAX_POINTS / duration)} Hz or fewer"
        )
