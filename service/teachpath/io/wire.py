"""The wire: protobuf messages to records and back, with every value checked on the way in."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np
from google.protobuf.json_format import MessageToDict
from google.protobuf.message import DecodeError, Message

from teachpath.errors import UnusableInput, UnusableSample
from teachpath.records import (
    Account,
    Array,
    Clock,
    Demonstration,
    ExecutorStatus,
    Job,
    JointState,
    Quaternion,
    Sample,
    Setpoint,
    Vector,
)
from teachpath_proto import job_pb2, motion_pb2, tracker_pb2

LARGEST_SAMPLE = 4096  # bytes; an honest one has about 200
FLEXION_COUNTS = (0, 18, 22)
UNIT_TOLERANCE = 0.01
NOT_MEASURED = (0.0, 0.0, 0.0, 0.0)  # an orientation
FARTHEST = 100.0  # [m or tracker units]; beyond it the units are wrong

M = TypeVar("M", bound=Message)


def parse(kind: type[M], payload: bytes) -> M:
    """Parse a protobuf message of `kind`.

    Raises:
        UnusableInput: the payload is not such a message.
    """
    try:
        return kind.FromString(payload)
    except DecodeError as error:
        raise UnusableInput(f"{len(payload)} bytes are not a {kind.DESCRIPTOR.name}: {error}") from None


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
    task: str, tracker: str, demonstrations: list[str], account: Account, *, idle: int = 0, **state: Any
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
        idle=idle,
        **state,
    )


def encode_demonstration(demonstration: Demonstration) -> bytes:
    """Return the report of a demonstration."""
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
    ).SerializeToString()


def report_document(report: tracker_pb2.RecordingReport) -> dict[str, Any]:
    """Return a recording's report as a JSON object; counts are numbers."""
    document = MessageToDict(report, preserving_proto_field_name=True, always_print_fields_with_no_presence=True)
    # protobuf's JSON writes 64-bit integers as text
    wide = {f.name for f in report.DESCRIPTOR.fields if f.cpp_type in (f.CPPTYPE_INT64, f.CPPTYPE_UINT64)}
    return {key: int(value) if key in wide else value for key, value in document.items()}


def encode_setpoint(setpoint: Setpoint) -> bytes:
    """Return a setpoint's message."""
    return motion_pb2.Setpoint(
        cycle=setpoint.cycle,
        nominal_ns=setpoint.nominal_ns,
        sent_ns=setpoint.sent_ns,
        position=setpoint.position.tolist(),
        velocity=setpoint.velocity.tolist(),
        acceleration=setpoint.acceleration.tolist(),
        gripper_closed=setpoint.gripper_closed,
        execution=setpoint.execution,
    ).SerializeToString()


def decode_setpoint(payload: bytes) -> Setpoint:
    """Check a setpoint; raises UnusableInput when it is malformed or not finite."""
    m = parse(motion_pb2.Setpoint, payload)
    where = f"setpoint {m.cycle}"
    return Setpoint(
        cycle=m.cycle,
        nominal_ns=m.nominal_ns,
        sent_ns=m.sent_ns,
        position=_joints(m.position, where),
        velocity=_joints(m.velocity, where),
        acceleration=_joints(m.acceleration, where),
        gripper_closed=m.gripper_closed,
        execution=m.execution,
    )


def encode_state(state: JointState) -> bytes:
    """Return a joint state's message."""
    return motion_pb2.JointState(
        stamp_ns=state.stamp_ns,
        cycle=state.cycle,
        position=state.position.tolist(),
        velocity=state.velocity.tolist(),
        torque=state.torque.tolist(),
        tracking_error=state.tracking_error,
        missed=state.missed,
        holding=state.holding,
        gripper_closed=state.gripper_closed,
        object_position=state.object_position,
        object_orientation=state.object_orientation,
        execution=state.execution,
    ).SerializeToString()


def decode_state(payload: bytes) -> JointState:
    """Check a joint state; raises UnusableInput when it is malformed or not finite."""
    m = parse(motion_pb2.JointState, payload)
    where = f"joint state after setpoint {m.cycle}"
    if len(m.object_position) != 3 or len(m.object_orientation) != 4:
        raise UnusableInput("joint state: the object needs a position of 3 numbers and an orientation of 4")
    x, y, z = m.object_position
    w, i, j, k = m.object_orientation
    return JointState(
        stamp_ns=m.stamp_ns,
        cycle=m.cycle,
        position=_joints(m.position, where),
        velocity=_joints(m.velocity, where),
        torque=_joints(m.torque, where),
        tracking_error=m.tracking_error,
        missed=m.missed,
        holding=m.holding,
        gripper_closed=m.gripper_closed,
        object_position=(x, y, z),
        object_orientation=(w, i, j, k),
        execution=m.execution,
    )


def _joints(values: Iterable[float], where: str) -> Array:
    joints = np.array(list(values), dtype=np.float64)
    if joints.shape != (6,) or not np.all(np.isfinite(joints)):
        raise UnusableInput(f"{where}: needs 6 finite numbers a joint array, got {joints.tolist()}")
    return joints


def encode_command(verb: str, execution: str, *, plan: bytes = b"", override: float = 1.0) -> bytes:
    """Return the message of a command: `verb` is start, override, hold, resume, reverse or stop."""
    return motion_pb2.ExecutorCommand(
        verb=verb.upper(), execution=execution, plan=plan, override=override
    ).SerializeToString()


def decode_command(payload: bytes) -> tuple[str, str, bytes, float]:
    """Return (verb in lower case, execution, plan in JSON, override) of a command; raises UnusableInput."""
    m = parse(motion_pb2.ExecutorCommand, payload)
    if m.verb not in motion_pb2.ExecutorCommand.Verb.values() or not m.verb:
        raise UnusableInput(f"command {m.verb} is unknown: say start, override, hold, resume, reverse or stop")
    if not 0.0 <= m.override <= 1.0:
        raise UnusableInput(f"override {m.override:g} is outside 0 to 1")
    return motion_pb2.ExecutorCommand.Verb.Name(m.verb).lower(), m.execution, m.plan, m.override


def encode_status(status: ExecutorStatus) -> bytes:
    """Return the message of an executor's status."""
    fields = {name: getattr(status, name) for name in ExecutorStatus.__dataclass_fields__}
    return motion_pb2.ExecutorStatus(**fields).SerializeToString()


def decode_status(payload: bytes) -> ExecutorStatus:
    """Return the executor's status; raises UnusableInput when malformed."""
    m = parse(motion_pb2.ExecutorStatus, payload)
    return ExecutorStatus(**{name: getattr(m, name) for name in ExecutorStatus.__dataclass_fields__})


def encode_progress(job: Job) -> bytes:
    """Return the message that tells of a job's progress."""
    return job_pb2.JobProgress(
        id=job.id, kind=job.kind, state=job.state.value, fraction=job.fraction, message=job.message
    ).SerializeToString()
