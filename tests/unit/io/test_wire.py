import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message
from hypothesis import given
from hypothesis import strategies as st

from teachpath.errors import UnusableInput, UnusableSample
from teachpath.io import wire
from teachpath.records import Command, ExecutorStatus, JournalEntry, Lease, LeaseRequest, Setpoint
from teachpath_proto import motion_pb2, tracker_pb2
from teachpath_proto.control import CommandVerb, ExecutorState, JournalVerb, LeaseAction
from tests.unit.recording.hands import sample

FLOATS = (FieldDescriptor.CPPTYPE_DOUBLE, FieldDescriptor.CPPTYPE_FLOAT)
FIELD_VALUES = {
    FieldDescriptor.CPPTYPE_INT64: 1, FieldDescriptor.CPPTYPE_UINT64: 1, FieldDescriptor.CPPTYPE_INT32: 1,
    FieldDescriptor.CPPTYPE_UINT32: 1, FieldDescriptor.CPPTYPE_ENUM: 1, FieldDescriptor.CPPTYPE_BOOL: True,
    FieldDescriptor.CPPTYPE_DOUBLE: 0.5, FieldDescriptor.CPPTYPE_FLOAT: 0.5, FieldDescriptor.CPPTYPE_STRING: "a",
}  # fmt: skip
DECODERS = [
    (motion_pb2.Setpoint, wire.decode_setpoint),
    (motion_pb2.JointState, wire.decode_state),
    (motion_pb2.ExecutorStatus, wire.decode_status),
    (motion_pb2.ExecutorCommand, wire.decode_command),
    (motion_pb2.LeaseRequest, wire.decode_lease_request),
    (motion_pb2.Lease, wire.decode_lease),
    (tracker_pb2.StartRecording, wire.decode_recording_request),
]

GOOD_SAMPLE = sample(7, (0.1, 0.2, 0.3))
RESTING_SETPOINT = Setpoint(0, 1, 1, np.zeros(6), np.zeros(6), np.zeros(6), False, "e1")


def payload(**changes: object) -> bytes:
    return wire.encode_sample(GOOD_SAMPLE._replace(**changes))  # type: ignore[arg-type]


def test_a_sample_survives_the_wire() -> None:
    again = wire.decode_sample("glove", payload(), GOOD_SAMPLE.receive_ns)
    assert again._replace(flexions=()) == GOOD_SAMPLE._replace(flexions=())
    assert again.flexions == pytest.approx(GOOD_SAMPLE.flexions, abs=1e-7)


@given(st.binary(max_size=300))
def test_any_bytes_are_a_sample_or_a_sentence(noise: bytes) -> None:
    try:
        decoded = wire.decode_sample("glove", noise, 1)
    except UnusableSample:
        return
    assert all(math.isfinite(v) for v in decoded.position)


@given(cut=st.integers(0, 200), flip=st.integers(0, 200), bit=st.integers(0, 7))
def test_a_damaged_sample_is_refused_or_whole(cut: int, flip: int, bit: int) -> None:
    damaged = bytearray(payload())
    damaged[flip % len(damaged)] ^= 1 << bit
    try:
        decoded = wire.decode_sample("glove", bytes(damaged[:cut]), 1)
    except UnusableSample:
        return
    norm = math.hypot(*decoded.orientation) if decoded.orientation else 1.0
    assert norm == pytest.approx(1.0, abs=1e-9)
    assert all(0.0 <= f <= 1.0 for f in decoded.flexions)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"position": (math.nan, 0.0, 0.0)}, "not finite"),
        ({"position": (0.0, math.inf, 0.0)}, "not finite"),
        ({"position": (0.0, 500.0, 0.0)}, "units"),
        ({"orientation": (0.5, 0.0, 0.0, 0.0)}, "no unit quaternion"),
        ({"orientation": (math.nan, 0.0, 0.0, 0.0)}, "no unit quaternion"),
        ({"flexions": (0.1,) * 7}, "18 or 22"),
        ({"flexions": (1.5,) * 22}, "calibrated"),
        ({"flexions": (math.nan,) * 22}, "calibrated"),
        ({"device_ns": 0}, "device time"),
    ],
)
def test_a_refusal_names_the_sample_and_the_fault(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(UnusableSample, match=sentence) as caught:
        wire.decode_sample("glove", payload(**changes), 1)
    assert "sample 7 of glove" in str(caught.value)


def test_a_huge_sample_is_refused_unread() -> None:
    with pytest.raises(UnusableSample, match="10000000 bytes is over the limit"):
        wire.decode_sample("glove", bytes(10_000_000), 1)


@given(st.binary(max_size=200))
def test_setpoints_states_and_commands_never_let_rubbish_through(noise: bytes) -> None:
    for decode in (wire.decode_setpoint, wire.decode_state, wire.decode_command):
        with pytest.raises(UnusableInput):
            decode(noise)


def filled(kind: type[Message]) -> Message:
    """A message with something in every field."""
    message = kind()
    for field in message.DESCRIPTOR.fields:
        repeated = field.is_repeated
        if field.cpp_type == field.CPPTYPE_MESSAGE:
            inner = filled(field.message_type._concrete_class)
            getattr(message, field.name).extend([inner]) if repeated else getattr(message, field.name).CopyFrom(inner)
        else:
            value = b"" if field.type == field.TYPE_BYTES else FIELD_VALUES[field.cpp_type]
            getattr(message, field.name).extend([value]) if repeated else setattr(message, field.name, value)
    return message


def float_fields(message: Message, path: tuple[str, ...] = ()) -> Iterator[tuple[Message, FieldDescriptor]]:
    for field, value in message.ListFields():
        if field.cpp_type == field.CPPTYPE_MESSAGE:
            for inner in value if field.is_repeated else [value]:
                yield from float_fields(inner)
        elif field.cpp_type in FLOATS:
            yield message, field


@pytest.mark.parametrize(("kind", "decode"), DECODERS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused_in_any_field_of_any_message(
    kind: type[Message], decode: Callable[[bytes], object], value: float
) -> None:
    whole = filled(kind)
    for number, (_, field) in enumerate(float_fields(whole)):
        broken = filled(kind)
        place, found = list(float_fields(broken))[number]
        assert found.name == field.name
        if field.is_repeated:
            getattr(place, field.name)[0] = value
        else:
            setattr(place, field.name, value)
        with pytest.raises(UnusableInput, match=field.name) as error:
            decode(broken.SerializeToString())
        assert str(value) in str(error.value)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_no_float_of_a_hand_sample_or_a_way_to_rest_lets_one_through(value: float) -> None:
    hand = tracker_pb2.HandSample.FromString(payload())
    for number in range(len(list(float_fields(hand)))):
        place, field = list(float_fields(hand))[number]
        for index in range(len(place.flexions)) if field.is_repeated else [0]:
            with pytest.raises(UnusableSample, match="sample 7 of glove"):
                wire.decode_sample("glove", with_value(hand, number, index, value), 1)
    way = np.zeros((3, 3, 6))
    for place in np.ndindex(way.shape):
        way[place] = value
        with pytest.raises(UnusableInput, match="way to rest is not finite"):
            wire.decode_setpoint(wire.encode_setpoint(replace(RESTING_SETPOINT, way_to_rest=way)))
        way[place] = 0.0


def with_value(message: Message, number: int, index: int, value: float) -> bytes:
    """Return the message with one value instead of another."""
    changed = type(message).FromString(message.SerializeToString())
    place, field = list(float_fields(changed))[number]
    if field.is_repeated:
        getattr(place, field.name)[index] = value
    else:
        setattr(place, field.name, value)
    return changed.SerializeToString()


def test_the_words_of_the_contract_are_those_of_its_messages() -> None:
    verbs = [f"VERB_{verb.name}" for verb in CommandVerb]
    assert motion_pb2.ExecutorCommand.Verb.keys() == ["VERB_UNSPECIFIED", *verbs]
    named = {f"ACTION_{action.name}" for action in LeaseAction if action is not LeaseAction.LOOK}
    assert {*motion_pb2.LeaseRequest.Action.keys()} == named | {"ACTION_UNSPECIFIED"}


def test_a_state_that_nobody_knows_is_refused() -> None:
    with pytest.raises(UnusableInput, match="'dancing' is none of idle, starting"):
        wire.decode_status(motion_pb2.ExecutorStatus(state="dancing").SerializeToString())


@pytest.mark.parametrize("state", ExecutorState)
def test_a_status_survives_the_wire_with_its_state(state: ExecutorState) -> None:
    status = ExecutorStatus(execution="e1", state=state)
    decoded = wire.decode_status(wire.encode_status(status))
    assert decoded == status
    assert decoded.state is state


@pytest.mark.parametrize("verb", CommandVerb)
def test_commands_survive_the_wire(verb: CommandVerb) -> None:
    command = Command(verb, "e1", b"{}", 0.5, -0.25, -3, "token", "Ada", "plan-1", "moved", b"[]", "stop-1")
    assert wire.decode_command(wire.encode_command(command)) == command


@pytest.mark.parametrize("verb", [CommandVerb.START, CommandVerb.TELEOPERATE])
@pytest.mark.parametrize("execution", ["", "bad id/../x", "a" * 65, "..", "-"])
def test_a_new_execution_needs_a_name(verb: CommandVerb, execution: str) -> None:
    with pytest.raises(UnusableInput, match=r"cannot name a new execution: .*\(field execution\)"):
        wire.decode_command(wire.encode_command(Command(verb, execution)))


def test_words_about_control_survive_the_wire() -> None:
    for action in LeaseAction:
        request = LeaseRequest(action, "Ada", "token", 2.5, True)
        assert wire.decode_lease_request(wire.encode_lease_request(request)) == request
    lease = Lease("Ada", 2.5, True, "Bea", 7.5, "token")
    assert wire.decode_lease(wire.encode_lease(lease)) == lease
    entry = JournalEntry(5, "Ada", JournalVerb.HOLD, "e1", "done")
    assert wire.decode_entry(wire.encode_entry(entry)) == entry
    for fields in ({}, {"verb": "dance"}, {"verb": "Hold"}):
        with pytest.raises(UnusableInput, match="the journal knows no"):
            wire.decode_entry(motion_pb2.JournalEntry(**fields).SerializeToString())
    assert set(JournalVerb) > set(CommandVerb)  # whatever is commanded stands there
    assert {f"{action} control" for action in LeaseAction} - {"look control", "beat control"} < set(JournalVerb)


def test_an_override_outside_its_range_is_refused() -> None:
    with pytest.raises(UnusableInput, match=r"override 1\.5"):
        wire.decode_command(wire.encode_command(Command(CommandVerb.OVERRIDE, "e1", override=1.5)))


def test_a_drivers_fault_is_a_line_that_can_be_shown_and_its_state_is_no_flood() -> None:
    state = motion_pb2.JointState(position=[0.0] * 6, velocity=[0.0] * 6, torque=[0.0] * 6)
    state.object_position.extend([0.0] * 3)
    state.object_orientation.extend([1.0, 0.0, 0.0, 0.0])
    state.fault = "brake\n" + "x" * 5000
    fault = wire.decode_state(state.SerializeToString()).fault
    assert fault == "brake" + "x" * 295
    state.fault = "x" * 20_000
    with pytest.raises(UnusableInput, match="bytes is over the limit of 16384"):
        wire.decode_state(state.SerializeToString())
    state.fault = ""
    state.position.extend([0.0] * 1000)
    with pytest.raises(UnusableInput, match="got 1006 numbers"):
        wire.decode_state(state.SerializeToString())


@pytest.mark.parametrize("count", [6, 7])
def test_setpoints_and_states_have_as_many_joints_as_the_arm(count: int) -> None:
    joints, way = np.linspace(0.0, 1.0, count), np.random.default_rng(0).normal(size=(4, 3, count))
    sent = wire.encode_setpoint(Setpoint(1, 2, 3, joints, -joints, 2 * joints, True, "e", way_to_rest=way))
    came = wire.decode_setpoint(sent)
    np.testing.assert_array_equal([came.position, came.velocity, came.acceleration], [joints, -joints, 2 * joints])
    np.testing.assert_array_equal(came.way_to_rest, way)
    broken = motion_pb2.Setpoint.FromString(sent)
    broken.velocity.pop()
    with pytest.raises(UnusableInput, match=f"needs {count} finite numbers a joint array, got {count - 1} numbers"):
        wire.decode_setpoint(broken.SerializeToString())
