"""What trackers and operators ask of the recorder, and what it answers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from teachpath.io.wire.parsing import parse
from teachpath.records import (
    Amendment,
    Clock,
    Demonstration,
    RecordingRequest,
    RecordingStatus,
    Routine,
    StopRequest,
    TaskReference,
)
from teachpath_proto import tracker_pb2
from teachpath_proto.reports import report_document


def decode_recording_request(payload: bytes) -> RecordingRequest:
    """Return the recording that a client wants to start; raises UnusableInput."""
    m = parse(tracker_pb2.StartRecording, payload)
    countdown = m.countdown if m.HasField("countdown") else None
    routine = Routine(armed=m.armed, countdown=countdown, takes=m.takes, one_by_one=m.one_by_one)
    return RecordingRequest(m.task, m.tracker, m.calibration, m.scene, m.rate, routine)


def decode_stop_request(payload: bytes) -> StopRequest:
    """Return the recording that a client wants to end; raises UnusableInput when malformed."""
    m = parse(tracker_pb2.StopRecording, payload)
    return StopRequest(m.tracker, m.last_sequence, m.discard)


def decode_tracker(payload: bytes) -> str:
    """Return the tracker whose recording is to pause or resume; raises UnusableInput when malformed."""
    return parse(tracker_pb2.PauseRecording, payload).tracker


def decode_task_reference(payload: bytes) -> TaskReference:
    """Return the task whose demonstration is to be discarded or restored; raises UnusableInput when malformed."""
    m = parse(tracker_pb2.PickDemonstration, payload)
    return TaskReference(m.task, m.tracker)


def decode_amendment(payload: bytes) -> tuple[str, Amendment]:
    """Return the id of a demonstration and what is to be changed of it; raises UnusableInput when malformed."""
    m = parse(tracker_pb2.AmendDemonstration, payload)
    return m.demonstration, Amendment(
        mark=m.mark if m.HasField("mark") else None,
        discarded=m.discarded if m.HasField("discarded") else None,
        trim=(m.trim.begin, m.trim.end) if m.HasField("trim") else None,
    )


def encode_recording_status(status: RecordingStatus) -> bytes:
    """Return the report of a recording; `status` has its statistics."""
    return _report(status).SerializeToString()


def encode_recorder_status(statuses: Iterable[RecordingStatus]) -> bytes:
    """Return the reports of all running recordings; each of `statuses` has its statistics."""
    return tracker_pb2.RecorderStatus(recordings=[_report(status) for status in statuses]).SerializeToString()


def recording_document(status: RecordingStatus) -> dict[str, Any]:
    """Return the report of a recording as a JSON object; `status` has its statistics."""
    return report_document(_report(status))


def encode_demonstration(demonstration: Demonstration) -> bytes:
    """Return the report of a demonstration."""
    return _demonstration_report(demonstration).SerializeToString()


def encode_feedback(status: RecordingStatus, newest: Demonstration | None) -> bytes:
    """Return what the hand and its operator should know at once.

    Args:
        status: of the recording.
        newest: the last demonstration that it made; None: there is none, or it cannot be read.
    """
    message = tracker_pb2.HandFeedback(
        task=status.task,
        phase=status.phase or "",
        state=status.state or "",
        holding=status.phase is not None and status.phase.is_hand_closed,
        countdown_left=status.countdown_left,
        takes_left=status.takes_left,
        takes=len(status.demonstrations),
        pending_command=status.pending_command or "",
        hint=status.hint,
    )
    if newest is not None:
        message.newest.CopyFrom(_demonstration_report(newest))
    return message.SerializeToString()


def _report(status: RecordingStatus) -> tracker_pb2.RecordingReport:
    statistics = status.statistics
    assert statistics is not None, "a report needs a status that was taken with its statistics"
    clock = statistics.clock or Clock(0, 0, 0.0)
    return tracker_pb2.RecordingReport(
        task=status.task,
        tracker=status.tracker,
        demonstrations=status.demonstrations,
        received=statistics.received,
        lost=statistics.lost,
        duplicated=statistics.duplicated,
        reordered=statistics.reordered,
        late=statistics.late,
        refused=statistics.refused,
        untracked=statistics.untracked,
        gaps=statistics.gaps,
        longest_gap_ns=statistics.longest_gap_ns,
        conflicts=statistics.conflicts,
        clock_jumps=statistics.clock_jumps,
        declared_rate=statistics.declared_rate,
        seen_rate=statistics.seen_rate,
        clock_offset_ns=clock.offset_ns,
        clock_uncertainty_ns=clock.uncertainty_ns,
        clock_rate=clock.rate,
        notes=statistics.notes,
        missing=[tracker_pb2.SequenceRange(first=first, last=last) for first, last in statistics.missing],
        idle=status.idle,
        phase=status.phase or "",
        state=status.state or "",
        pedal_used=status.pedal_used,
        countdown_left=status.countdown_left,
        takes_left=status.takes_left,
        pending_command=status.pending_command or "",
    )


def _demonstration_report(demonstration: Demonstration) -> tracker_pb2.DemonstrationReport:
    begin, end = demonstration.transport
    return tracker_pb2.DemonstrationReport(
        demonstration=demonstration.id,
        task=demonstration.task,
        number=demonstration.number,
        verdict=demonstration.verdict,
        reasons=demonstration.reasons,
        advice=demonstration.advice,
        mark=demonstration.mark,
        discarded=bool(demonstration.discarded_ns),
        transport=tracker_pb2.Span(begin=begin, end=end),
    )
