"""A motion as trajectory_msgs/JointTrajectory of ROS 2: as JSON, and as the bytes that ROS 2 sends."""

from __future__ import annotations

import json
from typing import Any, Final

from teachpath.io.programs.cdr import CdrWriter
from teachpath.records import SampledMotion

TYPE: Final = "trajectory_msgs/msg/JointTrajectory"
SECOND: Final = 1_000_000_000  # [ns]


def joint_trajectory_json(motion: SampledMotion) -> bytes:
    """Write a motion as JSON: the message under `joint_trajectory`, what a reader must know of it under `notes`.

    Times are whole nanoseconds from the start; a stamp of 0 says that the motion begins when it is received.
    """
    document = {"notes": motion.notes, "type": TYPE, "joint_trajectory": _message(motion)}
    return json.dumps(document, allow_nan=False).encode()


def joint_trajectory_cdr(motion: SampledMotion) -> bytes:
    """Write a motion as the message alone, in CDR; it has no place for notes."""
    writer = CdrWriter()
    writer.int32(0)  # header.stamp: when it is received
    writer.uint32(0)
    writer.string("")  # header.frame_id: joints have none
    writer.strings(_joint_names(motion))
    writer.uint32(len(motion.times))
    rows = zip(motion.positions, motion.velocities, motion.accelerations, _durations(motion), strict=True)
    for position, velocity, acceleration, (seconds, nanoseconds) in rows:
        for values in (position, velocity, acceleration, ()):  # no effort
            writer.doubles(values)
        writer.int32(seconds)
        writer.uint32(nanoseconds)
    return writer.content


def _joint_names(motion: SampledMotion) -> list[str]:
    """Return the names of the joints without spaces, as in the arm's URDF or MJCF model."""
    return [name.replace(" ", "") for name in motion.joint_names]


def _message(motion: SampledMotion) -> dict[str, Any]:
    rows = zip(
        motion.positions.tolist(),
        motion.velocities.tolist(),
        motion.accelerations.tolist(),
        _durations(motion),
        strict=True,
    )
    return {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "joint_names": _joint_names(motion),
        "points": [
            {
                "positions": position,
                "velocities": velocity,
                "accelerations": acceleration,
                "effort": [],
                "time_from_start": {"sec": seconds, "nanosec": nanoseconds},
            }
            for position, velocity, acceleration, (seconds, nanoseconds) in rows
        ],
    }


def _durations(motion: SampledMotion) -> list[tuple[int, int]]:
    """Return seconds and nanoseconds from the start of every instant."""
    return [divmod(round(time * SECOND), SECOND) for time in motion.times.tolist()]
