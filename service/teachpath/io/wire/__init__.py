"""The wire: protobuf messages to records and back, with every value checked on the way in."""

from teachpath.io.wire.control import (
    decode_command,
    decode_entry,
    decode_lease,
    decode_lease_request,
    encode_command,
    encode_entry,
    encode_lease,
    encode_lease_request,
)
from teachpath.io.wire.jobs import encode_progress
from teachpath.io.wire.motion import (
    decode_setpoint,
    decode_state,
    decode_status,
    encode_setpoint,
    encode_state,
    encode_status,
    without_way_to_rest,
)
from teachpath.io.wire.recording import (
    decode_amendment,
    decode_recording_request,
    decode_stop_request,
    decode_task_reference,
    decode_tracker,
    encode_demonstration,
    encode_feedback,
    encode_recorder_status,
    encode_recording_status,
    recording_document,
)
from teachpath.io.wire.sample_batches import SampleBatchDecoder
from teachpath.io.wire.samples import (
    decode_sample,
    encode_sample,
    sample_payload,
)
from teachpath_proto.sample_rules import MAX_COORDINATE, MAX_SAMPLE_SIZE

__all__ = [
    "MAX_COORDINATE",
    "MAX_SAMPLE_SIZE",
    "SampleBatchDecoder",
    "decode_amendment",
    "decode_command",
    "decode_entry",
    "decode_lease",
    "decode_lease_request",
    "decode_recording_request",
    "decode_sample",
    "decode_setpoint",
    "decode_state",
    "decode_status",
    "decode_stop_request",
    "decode_task_reference",
    "decode_tracker",
    "encode_command",
    "encode_demonstration",
    "encode_entry",
    "encode_feedback",
    "encode_lease",
    "encode_lease_request",
    "encode_progress",
    "encode_recorder_status",
    "encode_recording_status",
    "encode_sample",
    "encode_setpoint",
    "encode_state",
    "encode_status",
    "recording_document",
    "sample_payload",
    "without_way_to_rest",
]
