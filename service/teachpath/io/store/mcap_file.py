"""MCAP, written by the batch: many messages become one chunk in one go.

The library's own writer takes messages one by one, at several times the cost of a hand sample's way from the wire to
the disk. Here its records are laid out by the batch (https://mcap.dev/spec); everything reads them with the library.
"""

from __future__ import annotations

import io
import struct
import zlib
from collections import Counter
from collections.abc import Sequence
from typing import Any, BinaryIO, NamedTuple, Self

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap_protobuf.schema import build_file_descriptor_set

from teachpath.errors import UnusableRecording

MAGIC = b"\x89MCAP0\r\n"
DATA_END = struct.pack("<BQI", Opcode.DATA_END, 4, 0)
FOOTER = struct.Struct("<BQQQI")  # opcode, length, start of the summary and of its offsets, check sum
COMPRESSION, LEVEL = "zstd", 1
_MESSAGE = struct.Struct("<BQHIQQ")  # opcode, length, channel, sequence, log time, publish time; then the data
_HEAD = _MESSAGE.size - 9  # bytes of it that its length counts
_INDEX = struct.Struct("<BQHI")  # opcode, length, channel, bytes of the entries


class Stamped(NamedTuple):
    """One message of a batch; times in nanoseconds since the Unix epoch."""

    channel: int
    sequence: int
    log_time: int
    publish_time: int
    data: bytes


class McapFile:
    """Writes one MCAP file to `stream`, which stays open; every method raises what the stream raises."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream, self._at = stream, 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunks: list[ChunkIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts: Counter[int] = Counter()
        self._put(MAGIC + _laid_out(Header(profile="", library="teachpath")))

    @classmethod
    def continued(cls, stream: BinaryIO, content: bytes) -> Self:
        """Copy a finished file of ours to `stream`, to write on where its records ended.

        Raises:
            UnusableRecording: `content` is no such file.
        """
        summary = SeekingReader(io.BytesIO(content)).get_summary() if content.endswith(MAGIC) else None
        _, _, start, _, _ = FOOTER.unpack_from(content, len(content) - FOOTER.size - len(MAGIC))
        end = start - len(DATA_END)
        if summary is None or summary.statistics is None or content[end:start] != DATA_END:
            raise UnusableRecording("it is no MCAP file that was finished here")
        file = cls(io.BytesIO())
        file._stream, file._at = stream, 0
        file._put(content[:end])
        file._schemas, file._channels = list(summary.schemas.values()), list(summary.channels.values())
        file._chunks, file._metadata = summary.chunk_indexes, summary.metadata_indexes
        file._counts = Counter(summary.statistics.channel_message_counts)
        return file

    def add_channel(self, topic: str, kind: type[Any]) -> int:
        """Declare a topic of protobuf messages and return its channel."""
        name, description = kind.DESCRIPTOR.full_name, _description(kind)
        number = len(self._channels) + 1
        schema = Schema(id=number, data=description, encoding="protobuf", name=name)
        channel = Channel(id=number, topic=topic, message_encoding="protobuf", metadata={}, schema_id=number)
        self._schemas.append(schema)
        self._channels.append(channel)
        self._put(_laid_out(schema, channel))
        return number

    def add_metadata(self, name: str, entries: dict[str, str]) -> None:
        """Write named facts."""
        record = _laid_out(Metadata(name=name, metadata=entries))
        self._metadata.append(MetadataIndex(offset=self._at, length=len(record), name=name))
        self._put(record)

    def add_messages(self, batch: Sequence[Stamped]) -> None:
        """Write a batch as one chunk; an empty one writes nothing."""
        if not batch:
            return
        pieces: list[bytes] = []
        entries: dict[int, list[int]] = {}  # of a channel: log time and offset of each of its messages, in turn
        offset = 0
        for channel, sequence, log_time, publish_time, data in batch:
            length = _HEAD + len(data)
            pieces.append(_MESSAGE.pack(Opcode.MESSAGE, length, channel, sequence, log_time, publish_time))
            pieces.append(data)
            entries.setdefault(channel, []).extend((log_time, offset))
            offset += 9 + length
        self._put_chunk(b"".join(pieces), min(m.log_time for m in batch), max(m.log_time for m in batch), entries)
        self._counts.update({channel: len(each) // 2 for channel, each in entries.items()})

    def finish(self) -> None:
        """Write what lets a reader find everything without reading the whole."""
        self._put(DATA_END)
        start = self._at
        groups: list[tuple[Opcode, Sequence[McapRecord]]] = [
            (Opcode.SCHEMA, self._schemas),
            (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.METADATA_INDEX, self._metadata),
        ]
        summary, offsets = b"", []
        for opcode, records in groups:
            group = _laid_out(*records)
            offsets.append(SummaryOffset(opcode, start + len(summary), len(group)))
            summary += group
        offset_start = start + len(summary)
        summary += _laid_out(*offsets)
        footer = _laid_out(Footer(start, offset_start, 0))
        # The check sum covers the summary and the footer up to the check sum itself.
        self._put(summary + footer[:-4] + struct.pack("<I", zlib.crc32(footer[:-4], zlib.crc32(summary))) + MAGIC)

    def _put(self, content: bytes) -> None:
        self._stream.write(content)
        self._at += len(content)

    def _put_chunk(self, plain: bytes, first: int, last: int, entries: dict[int, list[int]]) -> None:
        packed = zstandard.ZstdCompressor(level=LEVEL).compress(plain)
        chunk = _laid_out(
            Chunk(
                compression=COMPRESSION,
                data=packed,
                message_start_time=first,
                message_end_time=last,
                uncompressed_crc=zlib.crc32(plain),
                uncompressed_size=len(plain),
            )
        )
        start, offsets, indexes = self._at, {}, b""
        for channel, flat in entries.items():
            offsets[channel] = start + len(chunk) + len(indexes)
            indexes += _INDEX.pack(Opcode.MESSAGE_INDEX, 6 + 8 * len(flat), channel, 8 * len(flat))
            indexes += struct.pack(f"<{len(flat)}Q", *flat)
        self._put(chunk + indexes)
        self._chunks.append(
            ChunkIndex(
                chunk_length=len(chunk),
                chunk_start_offset=start,
                compression=COMPRESSION,
                compressed_size=len(packed),
                message_start_time=first,
                message_end_time=last,
                message_index_length=len(indexes),
                message_index_offsets=offsets,
                uncompressed_size=len(plain),
            )
        )

    def _statistics(self) -> Statistics:
        return Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self._counts),
            chunk_count=len(self._chunks),
            message_count=self._counts.total(),
            message_start_time=min((c.message_start_time for c in self._chunks), default=0),
            message_end_time=max((c.message_end_time for c in self._chunks), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )


def _laid_out(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    laid_out: bytes = builder.end()  # type: ignore[no-untyped-call]
    return laid_out


def _description(kind: type[Any]) -> bytes:
    description: bytes = build_file_descriptor_set(kind).SerializeToString()
    return description
