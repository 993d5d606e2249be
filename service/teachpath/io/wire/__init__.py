"""The wire: protobuf messages to records and back, with every value checked on the way in."""

from teachpath.io.wire.control import (
    ACTIONS,
    VERBS,
    decode_command,
    decode_entry,
    decode_lease,
    decode_lease_request,
    encode_command,
    encode_entry,
    encode_lease,
    encode_lease_request,
)
from teachpath.io.wire.hand import (
    FARTHEST,
    LARGEST_SAMPLE,
    decode_sample,
    encode_demonstration,
    encode_feedback,
    encode_report,
    sample_from,
    sample_message,
)
from teachpath.io.wire.jobs import encode_progress
from teachpath.io.wire.motion import (
    decode_setpoint,
    decode_state,
    decode_status,
    encode_setpoint,
    encode_state,
    encode_status,
)
from teachpath.io.wire.parsing import parse
from teachpath_proto.reports import report_document

__all__ = [
    "ACTIONS",
    "FARTHEST",
    "LARGEST_SAMPLE",
    "VERBS",
    "decode_command",
    "decode_entry",
    "decode_lease",
    "decode_lease_request",
    "decode_sample",
    "decode_setpoint",
    "decode_state",
    "decode_status",
    "encode_command",
    "encode_demonstration",
    "encode_entry",
    "encode_feedback",
    "encode_lease",
    "encode_lease_request",
    "encode_progress",
    "encode_report",
    "encode_setpoint",
    "encode_state",
    "encode_status",
    "parse",
    "report_document",
    "sample_from",
    "sample_message",
]
