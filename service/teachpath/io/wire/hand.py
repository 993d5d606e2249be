"""What trackers send and the recorder answers, with every value checked on the way in."""

from __future__ import annotations

import math
from typing import Any

from teachpath.errors import UnusableInput, UnusableSample
from teachpath.io.wire.parsing import parse
from teachpath.records import Clock, Demonstration, Quaternion, Sample, StreamStatistics, Vector
from teachpath_proto import tracker_pb2

LARGEST_SAMPLE = 4096  # bytes; an honest one has about 200
FLEXION_COUNTS = (0, 18, 22)
UNIT_TOLERANCE = 0.01
NOT_MEASURED = (0.0, 0.0, 0.0, 0.0)  # an orientation
FARTHEST = 100.0  # [m or tracker units]; beyond it the units are wrong


def decode_sample(tracker: str, payload: bytes, receive_ns: int) -> Sample:
    """Check one hand sample.

    Raises:
        UnusableSample: it is too large, malformed, not finite, out of range or has no unit quaternion.
    """
    if len(payload) > LARGEST_SAMPLE:
        raise UnusableSample(f"a sample of {len(payload)} bytes is over the limit of {LARGEST_SAMPLE}")
    try:
        return sample_from(parse(tracker_pb2.HandSample, payload), tracker, receive_ns)
    except UnusableSample:
        raise
    except UnusableInput as error:
        raise UnusableSample(str(error)) from None


def sample_from(message: tracker_pb2.HandSample, tracker: str, receive_ns: int) -> Sample:
    """Check a parsed hand sample; raises UnusableSample."""
    p, q = message.position, message.orientation
    # a slice first: a quarter of the time of iterating over the message's own sequence
    position, turn, flexions = (p.x, p.y, p.z), (q.w, q.x, q.y, q.z), tuple(message.flexions[:])
    orientation = _unit(turn)
    fault = _fault(position, flexions, message.device_ns)
    if fault or (orientation is None and turn != NOT_MEASURED):
        fault = fault or "orientation ({:g}, {:g}, {:g}, {:g}) is no unit quaternion".format(*turn)
        raise UnusableSample(f"sample {message.sequence} of {tracker}: {fault}")
    return Sample(
        tracker=tracker,
        sequence=message.sequence,
        device_ns=message.device_ns,
        receive_ns=receive_ns,
        position=position,
        orientation=orientation,
        flexions=flexions,
        tracked=message.tracked,
        buttons=message.buttons,
    )


def _fault(position: Vector, flexions: tuple[float, ...], device_ns: int) -> str:
    """Say what is wrong with a sample, or nothing."""
    x, y, z = position
    if not math.isfinite(x + y + z):
        return f"position {position} is not finite"
    if not (-FARTHEST <= x <= FARTHEST and -FARTHEST <= y <= FARTHEST and -FARTHEST <= z <= FARTHEST):
        return f"position {position} is over {FARTHEST:g} m away; are its units metres?"
    if len(flexions) not in FLEXION_COUNTS:
        return f"{len(flexions)} flexions; a glove has 18 or 22, or send none"
    if flexions and not (min(flexions) >= 0.0 and max(flexions) <= 1.0 and math.isfinite(sum(flexions))):
        return "a flexion is outside 0 (open) to 1 (closed); is the glove calibrated?"
    if device_ns <= 0:
        return f"device time {device_ns} ns; send nanoseconds since the Unix epoch"
    return ""


def _unit(q: Quaternion) -> Quaternion | None:
    """Return a quaternion at unit length, or None when it is not near it."""
    w, x, y, z = q
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    if not abs(norm - 1.0) <= UNIT_TOLERANCE:
        return None
    return (w / norm, x / norm, y / norm, z / norm)


def sample_message(sample: Sample) -> tracker_pb2.HandSample:
    """Return the message of a hand sample; its receive time travels beside it."""
    w, x, y, z = sample.orientation or NOT_MEASURED
    return tracker_pb2.HandSample(
        sequence=sample.sequence,
        device_ns=sample.device_ns,
        position=tracker_pb2.Vector3(x=sample.position[0], y=sample.position[1], z=sample.position[2]),
        orientation=tracker_pb2.Quaternion(w=w, x=x, y=y, z=z),
        flexions=sample.flexions,
        tracked=sample.tracked,
        buttons=sample.buttons,
    )


def encode_report(
    task: str, tracker: str, demonstrations: list[str], account: StreamStatistics, *, idle: int = 0, **state: Any
) -> tracker_pb2.RecordingReport:
    """Return the report of a recording; `state` is its phase, state and pedal."""
    clock = account.clock or Clock(0, 0, 0.0)
    return tracker_pb2.RecordingReport(
        task=task,
        tracker=tracker,
        demonstrations=demonstrations,
        received=account.received,
        lost=account.lost,
        duplicated=account.duplicated,
        reordered=account.reordered,
        refused=account.refused,
        untracked=account.untracked,
        gaps=account.gaps,
        longest_gap_ns=account.longest_gap_ns,
        conflicts=account.conflicts,
        clock_jumps=account.clock_jumps,
        declared_rate=account.declared_rate,
        seen_rate=account.seen_rate,
        clock_offset_ns=clock.offset_ns,
        clock_uncertainty_ns=clock.uncertainty_ns,
        clock_rate=clock.rate,
        notes=account.notes,
        missing=[tracker_pb2.Stretch(first=first, last=last) for first, last in account.missing],
        idle=idle,
        **state,
    )


def encode_demonstration(demonstration: Demonstration) -> bytes:
    """Return the report of a demonstration."""
    return _reported(demonstration).SerializeToString()


def encode_feedback(newest: Demonstration | None, **feedback: Any) -> bytes:
    """Return what a hand should know; `feedback` are the fields of the message, `newest` its last demonstration."""
    told = tracker_pb2.HandFeedback(**feedback)
    if newest is not None:
        told.newest.CopyFrom(_reported(newest))
    return told.SerializeToString()


def _reported(demonstration: Demonstration) -> tracker_pb2.DemonstrationReport:
    begin, end = demonstration.transport
    return tracker_pb2.DemonstrationReport(
        demonstration=demonstration.id,
        task=demonstration.task,
        number=demonstration.number,
        verdict=demonstration.verdict,
        reasons=demonstration.reasons,
        mark=demonstration.mark,
        discarded=bool(demonstration.discarded_ns),
        transport=tracker_pb2.Span(begin=begin, end=end),
    )
