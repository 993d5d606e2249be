"""A recording is read by the batch as its samples are read one by one, whatever is in it."""

import io

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from teachpath.errors import UnusableSample
from teachpath.io import documents
from teachpath.io.store.mcap_file import McapFile
from teachpath.io.store.salvage import HEADER, TOPIC, RecordingHeader, salvage_stream
from teachpath.io.store.viewer_messages import message_batch
from teachpath.io.wire import decode_sample, message_types
from teachpath.records import Calibration, Sample
from tests.unit.io.test_sample_batches import GOOD_BATCH, damaged, messages

STATED_HEADER = RecordingHeader("lift", "glove", Calibration("lab"))


def one_by_one(payloads: list[bytes], receive_ns: list[int]) -> tuple[list[Sample], str]:
    samples = []
    for payload, ns in zip(payloads, receive_ns, strict=True):
        try:
            samples.append(decode_sample("glove", payload, ns))
        except UnusableSample as error:
            return samples, str(error)
    return samples, ""


def recording_of(payloads: list[bytes], receive_ns: list[int]) -> bytes:
    stream = io.BytesIO()
    file = McapFile(stream)
    file.add_metadata(HEADER, {"header": documents.encode(STATED_HEADER).decode()})
    channel = file.add_channel(TOPIC, message_types.HAND_SAMPLE)
    if payloads:
        stamps = np.array(receive_ns, np.uint64)
        file.add_messages([message_batch(channel, payloads, stamps, stamps)])
    file.finish()
    return stream.getvalue()


@settings(max_examples=40)
@given(
    st.lists(
        st.tuples(st.just(GOOD_BATCH) | messages() | damaged(), st.sampled_from([0, 5, 2**63 - 1, 2**63, 2**64 - 1]))
    ),
    st.sampled_from([0, 0, 1, 40]),
)
def test_what_a_recording_holds_is_read_to_the_first_sample_that_is_refused(
    stored: list[tuple[bytes, int]], cut: int
) -> None:
    payloads, receive_ns = [payload for payload, _ in stored], [ns for _, ns in stored]
    content = recording_of(payloads, receive_ns)
    header, samples, fault = salvage_stream(io.BytesIO(content[: len(content) - cut]))
    assert header == STATED_HEADER
    expected, refusal = one_by_one(payloads, receive_ns)
    assert repr(samples) == repr(expected)
    assert fault == refusal or (cut and not refusal)
