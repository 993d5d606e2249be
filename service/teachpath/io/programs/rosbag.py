"""A motion as a bag of ROS 2 (rosbag2, storage MCAP) with one message, trajectory_msgs/JointTrajectory."""

from __future__ import annotations

import io
from typing import Final

from mcap.writer import Writer

from teachpath.io.programs.joint_trajectory import TYPE, joint_trajectory_cdr
from teachpath.records import SampledMotion

TOPIC: Final = "/joint_trajectory"
NOTES: Final = "teachpath-notes"  # name of the metadata
_MESSAGE_SEPARATOR: Final = "=" * 80  # between the definitions of messages
SCHEMA: Final = f"""std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint[] points
{_MESSAGE_SEPARATOR}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{_MESSAGE_SEPARATOR}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
{_MESSAGE_SEPARATOR}
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
{_MESSAGE_SEPARATOR}
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
"""


def joint_trajectory_bag(motion: SampledMotion) -> bytes:
    """Write a motion as an MCAP file that `ros2 bag` reads; the notes are its metadata."""
    file = io.BytesIO()
    writer = Writer(file)
    writer.start(profile="ros2", library="teachpath")
    schema = writer.register_schema(name=TYPE, encoding="ros2msg", data=SCHEMA.encode())
    channel = writer.register_channel(
        topic=TOPIC, message_encoding="cdr", schema_id=schema, metadata={"offered_qos_profiles": ""}
    )
    stamp = motion.stamp_ns
    writer.add_message(channel, log_time=stamp, data=joint_trajectory_cdr(motion), publish_time=stamp)
    writer.add_metadata(NOTES, {f"{number:02d}": note for number, note in enumerate(motion.notes, 1)})
    writer.finish()  # type: ignore[no-untyped-call]
    return file.getvalue()
