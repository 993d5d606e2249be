"""The types of the messages, for files that describe what they hold."""

from __future__ import annotations

from typing import Final

from google.protobuf.message import Message

from teachpath_proto import motion_pb2, tracker_pb2

HAND_SAMPLE: Final[type[Message]] = tracker_pb2.HandSample
SETPOINT: Final[type[Message]] = motion_pb2.Setpoint
JOINT_STATE: Final[type[Message]] = motion_pb2.JointState
EXECUTOR_STATUS: Final[type[Message]] = motion_pb2.ExecutorStatus
JOURNAL_ENTRY: Final[type[Message]] = motion_pb2.JournalEntry
