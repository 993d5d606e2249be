"""Samples decoded by the batch are those that are decoded one by one, for whatever comes."""

import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.errors import UnusableSample
from teachpath.io.wire import SampleBatchDecoder, decode_sample
from teachpath.records import Sample
from teachpath_proto import tracker_pb2

numbers = st.sampled_from([0.0, -0.0, 0.5, -0.25, 1.0, 99.9, 100.1, math.nan, math.inf, 1e300]) | st.floats(-2.0, 2.0)
quaternions = st.sampled_from(
    [(1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (0.6, 0.0, -0.8, 0.0), (1.0099999999999999, 0.0, 0.0, 0.0)]
) | st.tuples(numbers, numbers, numbers, numbers)


@st.composite
def messages(draw: st.DrawFn) -> bytes:
    message = tracker_pb2.HandSample(
        sequence=draw(st.sampled_from([0, 1, 127, 128, 2**62, 2**64 - 1]) | st.integers(0, 300)),
        device_ns=draw(st.sampled_from([0, -1, 5, 2**63 - 1]) | st.integers(10**18, 10**18 + 1000)),
        flexions=[draw(st.sampled_from([0.0, 0.3, 1.0, 1.1, math.nan]))] * draw(st.sampled_from([0, 18, 22, 3])),
        tracked=draw(st.booleans()),
        buttons=draw(st.sampled_from([0, 1, 2, 300, 2**32 - 1])),
        joints=[draw(st.sampled_from([0.0, -3.1, 12.5, 13.0, math.nan]))] * draw(st.sampled_from([0, 6, 7, 5])),
    )
    if draw(st.booleans()):
        message.position.x, message.position.y, message.position.z = draw(st.tuples(numbers, numbers, numbers))
    if draw(st.booleans()):
        q = message.orientation
        q.w, q.x, q.y, q.z = draw(quaternions)
    return message.SerializeToString()


GOOD_BATCH = tracker_pb2.HandSample(
    sequence=3,
    device_ns=10**18,
    position=tracker_pb2.Vector3(x=0.1, y=0.2, z=0.3),
    orientation=tracker_pb2.Quaternion(w=0.6, x=0.0, y=0.8, z=0.1e-3),
    flexions=[0.25] * 22,
    tracked=True,
).SerializeToString()
ODD_BATCHES = [
    b"",
    GOOD_BATCH + GOOD_BATCH,  # the last of each field counts, and the flexions of both
    GOOD_BATCH + b"\x1a\x00",
    GOOD_BATCH + b"\x92\x03\x01a",  # a field that we do not know
    GOOD_BATCH[:-1],
    GOOD_BATCH + b"\x08\x83\x80\x00",  # a number in more bytes than it needs
    bytes(5000),
    b"\xff" * 20,
]


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    payload = bytearray(draw(messages()))
    for _ in range(draw(st.integers(1, 3))):
        if payload:
            payload[draw(st.integers(0, len(payload) - 1))] = draw(st.integers(0, 255))
    return bytes(payload[: draw(st.integers(0, len(payload)))] if draw(st.booleans()) else payload)


@settings(max_examples=60)
@given(st.lists(messages() | st.just(GOOD_BATCH) | st.sampled_from(ODD_BATCHES) | damaged(), min_size=1, max_size=30))
def test_a_batch_is_decoded_as_its_samples_one_by_one(payloads: list[bytes]) -> None:
    columns, usable = SampleBatchDecoder().decode(payloads, range(len(payloads)), "glove")
    for i, (payload, sample) in enumerate(zip(payloads, columns, strict=True)):
        if not usable[i]:
            continue  # left to the decoder of single samples
        assert repr(sample) == repr(decode_sample("glove", payload, i))
        assert columns[i] == sample


@given(st.integers(1, 300), st.integers(0, 2**50))
def test_messages_as_trackers_send_them_are_decoded_by_the_batch(count: int, first: int) -> None:
    payloads = []
    for i in range(count):
        message = tracker_pb2.HandSample.FromString(GOOD_BATCH)
        message.sequence, message.device_ns, message.position.x = first + i, 10**18 + i, 0.001 * (i + 1)
        payloads.append(message.SerializeToString())
    columns, usable = SampleBatchDecoder().decode(payloads, [7] * count)
    assert usable.all()
    assert columns.sequence.tolist() == list(range(first, first + count))


@pytest.mark.parametrize(("field", "value"), [("device_ns", 0), ("flexions", [1.5] * 22), ("flexions", [0.1] * 4)])
def test_what_is_refused_alone_is_never_decoded_by_the_batch(field: str, value: Any) -> None:
    message = tracker_pb2.HandSample.FromString(GOOD_BATCH)
    message.ClearField(field)
    if value:
        getattr(message, field).extend(value)
    payload = message.SerializeToString()
    assert not SampleBatchDecoder().decode([payload], [1])[1].any()
    with pytest.raises(UnusableSample):
        decode_sample("glove", payload, 1)


def test_columns_and_samples_are_the_same() -> None:
    columns, _ = SampleBatchDecoder().decode([GOOD_BATCH] * 3, [1, 2, 3], "glove")
    samples: list[Sample] = list(columns)
    assert [columns[i] for i in range(-3, 0)] == samples
    assert list(columns[1:]) == samples[1:]
    assert list(type(columns).of(samples)) == samples
    assert list(type(columns).joined([columns, type(columns).of(samples)])) == samples * 2
