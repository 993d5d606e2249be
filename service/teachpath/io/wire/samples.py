"""Hand samples, with every value checked on the way in."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from google.protobuf.message import DecodeError

from teachpath.errors import UnusableSample
from teachpath.records import Quaternion, Sample
from teachpath_proto import tracker_pb2
from teachpath_proto.sample_rules import MAX_SAMPLE_SIZE, NOT_MEASURED, sample_fault


def decode_sample(tracker: str, payload: bytes, receive_ns: int) -> Sample:
    """Check one hand sample.

    Raises:
        UnusableSample: it is too large, malformed, not finite, out of range or has no unit quaternion.
    """
    message = _parse(payload)
    p, q = message.position, message.orientation
    # a slice first: a quarter of the time of iterating over the message's own sequence
    position, turn, flexions = (p.x, p.y, p.z), (q.w, q.x, q.y, q.z), tuple(message.flexions[:])
    joints = tuple(message.joints[:])
    sequence, device_ns = message.sequence, message.device_ns
    if fault := sample_fault(position, turn, flexions, device_ns, joints):
        raise UnusableSample(f"sample {sequence} of {tracker}: {fault}", sequence=sequence)
    orientation = None if turn == NOT_MEASURED else _normalized(turn)
    tracked, buttons = message.tracked, message.buttons
    return Sample(tracker, sequence, device_ns, receive_ns, position, orientation, flexions, tracked, buttons, joints)


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
        joints=sample.joints,
    ).SerializeToString()


def sample_payload(content: bytes | Mapping[str, Any]) -> bytes:
    """Return the message of a hand sample that came as protobuf, or as a JSON object with the names of its fields.

    The values are not checked yet; `decode_sample` does that. In JSON `device_ns` may be text, for languages whose
    numbers have fewer digits.

    Raises:
        UnusableSample: it is no `HandSample`, or too large.
    """
    if isinstance(content, bytes):
        return _parse(content).SerializeToString()
    try:
        return tracker_pb2.HandSample(**_with_number(content)).SerializeToString()
    except (TypeError, ValueError, AttributeError) as error:
        shown = json.dumps(content)[:120]
        raise UnusableSample(f"{shown} is no HandSample: {' '.join(str(error).split())}") from None


def _with_number(content: Mapping[str, Any]) -> Mapping[str, Any]:
    stamp = content.get("device_ns")
    if isinstance(stamp, str) and stamp.isascii() and stamp.isdecimal():
        return {**content, "device_ns": int(stamp)}
    return content


def _parse(payload: bytes) -> tracker_pb2.HandSample:
    if len(payload) > MAX_SAMPLE_SIZE:
        raise UnusableSample(f"a sample of {len(payload)} bytes is over the limit of {MAX_SAMPLE_SIZE}")
    try:
        return tracker_pb2.HandSample.FromString(payload)
    except DecodeError as error:
        raise UnusableSample(f"{len(payload)} bytes are not a HandSample: {error}") from None


def _normalized(q: Quaternion) -> Quaternion:
    w, x, y, z = q
    norm = math.sqrt(w * w + x * x + y * y + z * z)
    return (w / norm, x / norm, y / norm, z / norm)
