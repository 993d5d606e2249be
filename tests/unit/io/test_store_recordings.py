import math
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap.writer import Writer
from mcap_protobuf.decoder import DecoderFactory
from mcap_protobuf.schema import register_schema
from scipy.spatial.transform import Rotation

from teachpath.errors import NotFound, UnusableRecording
from teachpath.io.documents import encode
from teachpath.io.store.mcap_records import MAX_RECORD_SIZE, OPENING, read_records
from teachpath.io.store.motions import read_motion
from teachpath.io.store.recording_facts import read_facts
from teachpath.io.store.recordings import RecordingFile, Recordings
from teachpath.io.store.salvage import RecordingHeader, salvage
from teachpath.io.wire import encode_sample
from teachpath.recording.demonstration import to_world
from teachpath.records import Calibration, Sample
from teachpath_proto import tracker_pb2
from tests.unit.recording.hands import demonstration

HEADER = RecordingHeader("lift", "glove", Calibration("lab", scale=0.5))
SAMPLES = demonstration()


def take(folder: Path, samples: list[Sample] = SAMPLES) -> tuple[Recordings, RecordingFile]:
    recordings = Recordings(folder)
    begun = recordings.begin("d", HEADER)
    for sample in samples:
        begun.write(sample)
    return recordings, begun


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return take(tmp_path_factory.mktemp("recordings"))[1].finish({"verdict": "clean"})


def same(again: list[Sample], samples: list[Sample]) -> bool:
    return [(s.sequence, s.device_ns, s.receive_ns, s.position, s.orientation, s.tracker) for s in again] == [
        (s.sequence, s.device_ns, s.receive_ns, s.position, s.orientation, s.tracker) for s in samples
    ]


def test_a_recording_gives_back_every_sample_as_it_came(tmp_path: Path) -> None:
    recordings, begun = take(tmp_path)
    assert [f.name for f in recordings.unfinished()] == ["d.mcap.part"]
    file = begun.finish({})
    assert recordings.unfinished() == []
    assert recordings.place(file) == "lift/d.mcap"
    assert same(recordings.samples("lift/d.mcap"), SAMPLES)
    assert salvage(file)[0] == HEADER


def test_the_records_of_a_file_are_those_that_the_library_reads(whole: Path) -> None:
    with whole.open("rb") as stream, whole.open("rb") as again:
        assert list(read_records(stream)) == list(StreamReader(again).records)[1:]  # the first is the header


def test_what_was_flushed_is_there_before_the_end(tmp_path: Path) -> None:
    recordings, begun = take(tmp_path)
    begun.flush()
    header, samples, fault = salvage(recordings.unfinished()[0])
    assert header == HEADER
    assert same(samples, SAMPLES)
    assert fault
    begun.discard()
    assert recordings.unfinished() == []


@settings(max_examples=60, deadline=None)
@given(parts=st.lists(st.tuples(st.integers(1, 90), st.booleans()), min_size=1, max_size=8))
def test_parts_of_a_recording_are_kept_whether_the_hand_is_tracked_or_not(
    tmp_path_factory: pytest.TempPathFactory, parts: list[tuple[int, bool]]
) -> None:
    samples = iter(SAMPLES)
    recordings, begun = take(tmp_path_factory.mktemp("recordings"), [])
    written: list[Sample] = []
    for size, tracked in parts:
        for sample in islice(samples, size):
            written.append(sample._replace(tracked=tracked))
            begun.write(written[-1])
        begun.flush()
    begun.finish({})
    kept = recordings.samples("lift/d.mcap")
    assert same(kept, written)
    assert [sample.tracked for sample in kept] == [sample.tracked for sample in written]


@pytest.mark.parametrize("place", ["lift/moon.mcap", "", "..", "lift"])
def test_a_recording_that_is_not_there_is_named(tmp_path: Path, place: str) -> None:
    with pytest.raises(NotFound, match=r"is missing under .*; was the folder moved\?"):
        Recordings(tmp_path).path(place)


@settings(max_examples=150, deadline=None)
@given(cut=st.integers(0, 10**6))
def test_a_torn_recording_gives_its_first_samples_and_says_that_it_is_torn(whole: Path, cut: int) -> None:
    content = whole.read_bytes()
    torn = whole.with_name("torn.mcap")
    torn.write_bytes(content[: cut % (len(content) - 1)])
    header, samples, fault = salvage(torn)
    assert header in (None, HEADER)
    assert same(samples, SAMPLES[: len(samples)]) or header is None
    assert fault or len(samples) == len(SAMPLES)


@settings(max_examples=150, deadline=None)
@given(place=st.integers(0, 10**6), value=st.integers(0, 255))
def test_a_damaged_recording_gives_no_wrong_sample(whole: Path, place: int, value: int) -> None:
    content = bytearray(whole.read_bytes())
    content[place % len(content)] = value
    damaged = whole.with_name("damaged.mcap")
    damaged.write_bytes(content)
    header, samples, fault = salvage(damaged)
    if header == HEADER:
        assert same(samples, SAMPLES[: len(samples)])
    assert fault or len(samples) == len(SAMPLES)
    recordings = Recordings(whole.parents[1])
    if fault or header is None:
        with pytest.raises(UnusableRecording, match=r"lift/damaged\.mcap is damaged .*teachpath doctor"):
            recordings.samples("lift/damaged.mcap")


def begin_of(kind: Opcode, content: bytearray) -> int:
    """Return where the first record of a kind begins, behind its opening."""
    at = 8  # behind what every MCAP file begins with
    while content[at] != kind:
        at += OPENING.size + OPENING.unpack_from(content, at)[1]
    return at + OPENING.size


@pytest.mark.parametrize("size", [17, 2**32 - 16])
def test_a_damaged_index_of_messages_is_told(whole: Path, size: int) -> None:
    content = bytearray(whole.read_bytes())
    at = begin_of(Opcode.MESSAGE_INDEX, content) + 2  # behind its channel
    content[at : at + 4] = size.to_bytes(4, "little")
    damaged = whole.with_name("index.mcap")
    damaged.write_bytes(content)
    _, samples, fault = salvage(damaged)
    assert same(samples, SAMPLES[: len(samples)])
    assert fault.startswith(f"an index of messages states {size} bytes")


@pytest.mark.parametrize("length", [MAX_RECORD_SIZE + 1, 2**40, 2**63, 2**64 - 1])
def test_a_damaged_length_within_a_chunk_takes_no_memory(whole: Path, length: int) -> None:
    content = bytearray(whole.read_bytes())
    at = begin_of(Opcode.CHUNK, content)
    at += 28  # its times, the size that it expands to, and its check sum
    at += 4 + int.from_bytes(content[at : at + 4], "little")  # the name of its compression
    content[at : at + 8] = length.to_bytes(8, "little")
    damaged = whole.with_name("long.mcap")
    damaged.write_bytes(content)
    _, samples, fault = salvage(damaged)
    assert (samples, fault) == ([], f"a field of it is {length} bytes long, limit {MAX_RECORD_SIZE}: it is damaged")
    assert read_motion(damaged).fault == fault


def test_viewers_find_the_hand_and_its_frame_beside_the_samples(tmp_path: Path) -> None:
    quarter = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    lab = Calibration("lab", 0.5, quarter, (1.0, 2.0, 3.0))
    begun = Recordings(tmp_path).begin("d", RecordingHeader("lift", "glove", lab))
    for i, sample in enumerate(SAMPLES):
        begun.write(sample._replace(tracked=i % 10 != 0))
    file = begun.finish({})
    with file.open("rb") as stream:
        drawn = [
            (schema.name, channel.topic, decoded, message.log_time)
            for schema, channel, message, decoded in make_reader(
                stream, decoder_factories=[DecoderFactory()]
            ).iter_decoded_messages()
            if channel.topic != "samples"
        ]
    (frames,) = [d for _, topic, d, _ in drawn if topic == "frames"]
    poses = [(d, at) for _, topic, d, at in drawn if topic == "hand_pose"]
    assert {name for name, *_ in drawn} == {"foxglove.PoseInFrame", "foxglove.FrameTransforms"}
    assert len(poses) == sum(i % 10 != 0 for i in range(len(SAMPLES)))
    (frame,) = frames.transforms
    assert (frame.parent_frame_id, frame.child_frame_id) == ("world", poses[0][0].frame_id) == ("world", "tracker")
    turn = Rotation.from_quat([frame.rotation.x, frame.rotation.y, frame.rotation.z, frame.rotation.w])
    offset = [frame.translation.x, frame.translation.y, frame.translation.z]
    for (pose, at), sample in zip(poses, [s for i, s in enumerate(SAMPLES) if i % 10], strict=True):
        seen = turn.apply([pose.pose.position.x, pose.pose.position.y, pose.pose.position.z]) + offset
        np.testing.assert_allclose(seen, to_world(lab, np.array(sample.position)), atol=1e-12)
        assert pose.timestamp.seconds * 10**9 + pose.timestamp.nanos == at == sample.receive_ns


def test_what_came_on_the_wire_is_what_is_kept(tmp_path: Path) -> None:
    recordings = Recordings(tmp_path)
    begun = recordings.begin("d", HEADER)
    payload = encode_sample(SAMPLES[0]) + b"\xfa\x3e\x03new"  # a field of a newer client
    begun.write(SAMPLES[0], payload)
    begun.finish({"verdict": "clean"})
    with recordings.path("lift/d.mcap").open("rb") as stream:
        ((_, _, message),) = make_reader(stream).iter_messages(topics=["samples"])
    assert message.data == payload
    assert same(recordings.samples("lift/d.mcap"), SAMPLES[:1])
    assert read_facts(recordings.path("lift/d.mcap")) == {"verdict": "clean"}


def test_a_recording_of_before_the_drawing_is_read(tmp_path: Path) -> None:
    file = tmp_path / "lift" / "old.mcap"
    file.parent.mkdir()
    writer = Writer(str(file))
    writer.start(profile="", library="teachpath")
    writer.add_metadata("teachpath", {"header": encode(HEADER).decode()})
    schema = register_schema(writer, tracker_pb2.HandSample)
    channel = writer.register_channel(topic="samples", message_encoding="protobuf", schema_id=schema)
    for s in SAMPLES:
        writer.add_message(channel, s.receive_ns, encode_sample(s), s.device_ns)
    writer.finish()
    assert same(Recordings(tmp_path).samples("lift/old.mcap"), SAMPLES)
