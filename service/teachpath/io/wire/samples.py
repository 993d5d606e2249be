"""Hand samples, with every value checked on the way in."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from teachpath.errors import UnusableInput, UnusableSample
from teachpath.io.wire.parsing import parse
from teachpath.records import Quaternion, Sample, Vector
from teachpath_proto import tracker_pb2

MAX_SAMPLE_SIZE = 4096  # bytes; an honest sample has about 200
FLEXION_COUNTS = (0, 18, 22)
UNIT_TOLERANCE = 0.01  # by which the norm of a quaternion may differ from 1
NOT_MEASURED = (0.0, 0.0, 0.0, 0.0)  # an orientation on the wire
MAX_COORDINATE = 100.0  # [m or tracker units]; beyond it the units are wrong


def decode_sample(tracker: str, payload: bytes, receive_ns: int) -> Sample:
    """Check one hand sample.

    Raises:
        UnusableSample: it is too large, malformed, not finite, out of range or has no unit quaternion.
    """
    message = _parse(payload)
    p, q = message.position, message.orientation
    # a slice first: a quarter of the time of iterating over the message's own sequence
    position, turn, flexions = (p.x, p.y, p.z), (q.w, q.x, q.y, q.z), tuple(message.flexions[:])
    orientation = _unit(turn)
    fault = _fault(position, flexions, message.device_ns)
    if fault or (orientation is None and turn != NOT_MEASURED):
        fault = fault or "orientation ({:g}, {:g}, {:g}, {:g}) is no unit quaternion".format(*turn)
        raise UnusableSample(f"sample {message.sequence} of {tracker}: {fault}", sequence=message.sequence)
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


def encode_sample(sample: Sample) -> bytes:
    """Return the message of a hand sample; its receive time travels beside it.

    Raises:
        ValueError: a number does not fit its field.
    """
    w, x, y, z = sample.orientation or NOT_MEASURED
    return tracker_pb2.HandSample(
        sequence=sample.sequence,
        device_ns=sample.device_ns,
        position=tracker_pb2.Vector3(x=sample.position[0], y=sample.position[1], z=sample.position[2]),
        orientation=tracker_pb2.Quaternion(w=w, x=x, y=y, z=z),
        flexions=sample.flexions,
        tracked=sample.tracked,
        buttons=sample.buttons,
    ).SerializeToString()


def sample_payload(content: bytes | Mapping[str, Any]) -> bytes:
    """Return the message of a hand sample that came as protobuf, or as a JSON object with the names of its fields.

    The values are not checked yet; `decode_sample` does that.

    Raises:
        UnusableSample: it is no `HandSample`, or too large.
    """
    if isinstance(content, bytes):
        return _parse(content).SerializeToString()
    try:
        return tracker_pb2.HandSample(**content).SerializeToString()
    except (TypeError, ValueError, AttributeError) as error:
        shown = json.dumps(content)[:120]
        raise UnusableSample(f"{shown} is no HandSample: {' '.join(str(error).split())}") from None


def _parse(payload: bytes) -> tracker_pb2.HandSample:
    if len(payload) > MAX_SAMPLE_SIZE:
        raise UnusableSample(f"a sample of {len(payload)} bytes is over the limit of {MAX_SAMPLE_SIZE}")
    try:
        return parse(tracker_pb2.HandSample, payload, check_finite=False)
    except UnusableInput as error:
        raise UnusableSample(str(error)) from None


def _fault(position: Vector, flexions: tuple[float, ...], device_ns: int) -> str:
    """Say what is wrong with a sample, or nothing."""
    x, y, z = position
    if not math.isfinite(x + y + z):
        return f"position {position} is not finite"
    limit = MAX_COORDINATE
    if not (-limit <= x <= limit and -limit <= y <= limit and -limit <= z <= limit):
        return f"position {position} is over {limit:g} m away; are its units metres?"
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
