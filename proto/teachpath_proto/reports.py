"""The report of a recording as JSON."""

from __future__ import annotations

from typing import Any

from google.protobuf.json_format import MessageToDict

from teachpath_proto import tracker_pb2


def report_document(report: tracker_pb2.RecordingReport) -> dict[str, Any]:
    """Return a recording's report as a JSON object; counts are numbers."""
    document = MessageToDict(report, preserving_proto_field_name=True, always_print_fields_with_no_presence=True)
    # protobuf's JSON writes 64-bit integers as text
    wide = {f.name for f in report.DESCRIPTOR.fields if f.cpp_type in (f.CPPTYPE_INT64, f.CPPTYPE_UINT64)}
    numbers = {key: int(value) if key in wide else value for key, value in document.items()}
    return numbers | {"missing": [[stretch.first, stretch.last] for stretch in report.missing]}
