"""The batch writer against the library's readers."""

import io
import zlib
from typing import NamedTuple

import numpy as np
import pytest
from google.protobuf.message import Message as ProtobufMessage
from mcap.reader import make_reader
from mcap.records import Chunk, ChunkIndex, Footer, Message, MessageIndex
from mcap.stream_reader import StreamReader, get_chunk_data_stream
from mcap.writer import Writer

from teachpath.io.store.mcap_file import FOOTER, MAGIC, McapFile
from teachpath.io.store.mcap_messages import MessageBatch
from teachpath_proto import tracker_pb2

KINDS: list[type[ProtobufMessage]] = [tracker_pb2.HandSample, tracker_pb2.Vector3]


class Sent(NamedTuple):
    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


BATCHES = [
    [Sent(1 + i % 2, 2**31 + i, 1000 * batch + 10 * i, i + 1, bytes([i]) * (i + batch)) for i in range(20)]
    for batch in range(1, 4)
]


def batch_of(channel: int, messages: list[Sent]) -> MessageBatch:
    chosen = [m for m in messages if m.channel == channel]
    times = (np.array([getattr(m, name) for m in chosen], np.uint64) for name in Sent._fields[1:4])
    return MessageBatch(channel, *times, [m.data for m in chosen])


@pytest.fixture
def written() -> bytes:
    stream = io.BytesIO()
    file = McapFile(stream)
    for i, kind in enumerate(KINDS):
        assert file.add_channel(f"topic-{i}", kind) == i + 1
    file.add_metadata("facts", {"a": "1"})
    for batch in BATCHES:
        file.add_messages(batch_of(channel, batch) for channel in (1, 2))
        file.add_messages([])
        file.add_messages([batch_of(3, batch)])
    file.finish()
    return stream.getvalue()


def test_a_reader_with_the_index_finds_every_message_of_a_topic_and_of_a_time(written: bytes) -> None:
    reader = make_reader(io.BytesIO(written), validate_crcs=True)
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert (summary.statistics.message_count, summary.statistics.chunk_count) == (60, 3)
    assert summary.statistics.channel_message_counts == {1: 30, 2: 30}
    assert [s.name for s in summary.schemas.values()] == [kind.DESCRIPTOR.full_name for kind in KINDS]
    sent = [m for batch in BATCHES for m in batch]
    for topic, channel in (("topic-0", 1), ("topic-1", 2)):
        found = [m for _, _, m in reader.iter_messages(topics=[topic])]
        assert [(m.sequence, m.log_time, m.publish_time, m.data) for m in found] == [
            (m.sequence, m.log_time, m.publish_time, m.data) for m in sent if m.channel == channel
        ]
    late = [m.log_time for _, _, m in reader.iter_messages(starting_at=2050, ending_before=3050)]
    assert late == [m.log_time for m in sent if 2050 <= m.log_time < 3050]
    assert [m.metadata for m in reader.iter_metadata()] == [{"a": "1"}]


def test_the_index_of_every_chunk_points_at_its_messages(written: bytes) -> None:
    stream = io.BytesIO(written)
    summary = make_reader(stream).get_summary()
    assert summary is not None
    for index in summary.chunk_indexes:
        assert isinstance(index, ChunkIndex)
        chunk = _record_at(written, index.chunk_start_offset)
        assert isinstance(chunk, Chunk)
        content, _ = get_chunk_data_stream(chunk, validate_crc=True)
        plain = content.read(chunk.uncompressed_size)
        for channel, offset in index.message_index_offsets.items():
            entries = _record_at(written, offset)
            assert isinstance(entries, MessageIndex)
            assert entries.channel_id == channel
            assert len(entries.records) == 10
            for log_time, at in entries.records:
                message = _record_at(plain, at)
                assert isinstance(message, Message)
                assert (message.channel_id, message.log_time) == (channel, log_time)


def _by_the_library() -> bytes:
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start(profile="", library="test")
    writer.add_metadata("facts", {"a": "1"})
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


@pytest.mark.parametrize("writer", ["ours", "the library's"])
def test_the_check_sum_of_the_summary_covers_all_from_its_start_to_the_check_sum(writer: str, written: bytes) -> None:
    """No reader in Python compares it, so that a wrong one would be found by other readers only."""
    content = written if writer == "ours" else _by_the_library()
    footer = _record_at(content, len(content) - FOOTER.size - len(MAGIC))
    assert isinstance(footer, Footer)
    assert footer.summary_start < len(content) - FOOTER.size - len(MAGIC)
    assert footer.summary_crc == zlib.crc32(content[footer.summary_start : -len(MAGIC) - 4])


def _record_at(content: bytes, offset: int) -> object:
    reader = StreamReader(io.BytesIO(content[offset:]), skip_magic=True, emit_chunks=True)
    return next(reader.records)
