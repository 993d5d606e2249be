"""A writer of MCAP files that makes one chunk of each batch of messages, from columns.

The library's own writer takes messages one by one, at several times the cost of all else between the wire and the
disk. This writer lays out the records itself (https://mcap.dev/spec); they are read with the library.
"""

from __future__ import annotations

import hashlib
import io
import struct
import zlib
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any, BinaryIO, Self

import numpy as np
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from mcap.stream_reader import StreamReader
from mcap_protobuf.schema import build_file_descriptor_set

from teachpath.errors import UnusableRecording
from teachpath.io.store.mcap_messages import COMPRESSORS, MessageBatch, message_records

MAGIC = b"\x89MCAP0\r\n"
DATA_END = struct.pack("<BQI", Opcode.DATA_END, 4, 0)
FOOTER = struct.Struct("<BQQQI")  # opcode, length, start of the summary and of its offsets, check sum
COMPRESSION = "zstd"
_INDEX = struct.Struct("<BQHI")  # opcode, length, channel, bytes of the entries


class McapFile:
    """Writes one MCAP file to `stream`, which stays open; every method raises what the stream raises."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream, self._offset = stream, 0
        self._hash = hashlib.sha256()
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._chunks: list[ChunkIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts: Counter[int] = Counter()
        self._write(MAGIC + _serialize(Header(profile="", library="teachpath")))

    @classmethod
    def reopen(cls, stream: BinaryIO, content: bytes) -> Self:
        """Copy the records of a file that this class wrote to `stream`, and go on writing behind them.

        They end where its data ends; a file that ends before its summary may be cut there.

        Raises:
            UnusableRecording: `content` has no end of its data, or is damaged.
        """
        file = cls(io.BytesIO())
        source = io.BytesIO(content)
        start, ended = 0, False
        try:
            for record in StreamReader(source, emit_chunks=True, validate_crcs=True).records:
                if ended := isinstance(record, DataEnd):
                    break
                file._note(record, start, source.tell() - start)
                start = source.tell()
        except Exception as error:  # damage shows as whatever the reader raises
            raise UnusableRecording(f"it is damaged: {error or type(error).__name__}") from None
        if not ended:
            raise UnusableRecording("its data has no end")
        file._stream, file._offset, file._hash = stream, 0, hashlib.sha256()
        file._write(content[:start])
        return file

    @property
    def sha256(self) -> str:
        """The SHA-256 of all that was written so far, hexadecimal."""
        return self._hash.hexdigest()

    @property
    def size(self) -> int:
        """How much was written so far [bytes]."""
        return self._offset

    def add_channel(self, topic: str, kind: type[Any]) -> int:
        """Declare a topic of protobuf messages and return its channel."""
        name, descriptors = kind.DESCRIPTOR.full_name, _descriptor_set(kind)
        number = len(self._channels) + 1
        schema = Schema(id=number, data=descriptors, encoding="protobuf", name=name)
        channel = Channel(id=number, topic=topic, message_encoding="protobuf", metadata={}, schema_id=number)
        self._schemas.append(schema)
        self._channels.append(channel)
        self._write(_serialize(schema, channel))
        return number

    def add_metadata(self, name: str, entries: dict[str, str]) -> None:
        """Write a metadata record."""
        record = _serialize(Metadata(name=name, metadata=entries))
        self._metadata.append(MetadataIndex(offset=self._offset, length=len(record), name=name))
        self._write(record)

    def add_messages(self, batches: Iterable[MessageBatch]) -> None:
        """Write batches as one chunk, one after the other; those without messages write nothing."""
        batches = [batch for batch in batches if len(batch.data)]
        if not batches:
            return
        pieces: list[bytes] = []
        entries: list[tuple[int, bytes]] = []  # of each batch: channel, and log time and offset of its messages
        offset = 0
        for batch in batches:
            records, sizes = message_records(batch)
            index = np.empty((len(batch.data), 2), "<u8")
            index[:, 0] = batch.log_times
            index[:, 1] = offset + np.cumsum(sizes) - sizes
            entries.append((batch.channel, index.tobytes()))
            pieces.append(records)
            offset += len(records)
        first = min(int(batch.log_times.min()) for batch in batches)
        last = max(int(batch.log_times.max()) for batch in batches)
        self._write_chunk(b"".join(pieces), first, last, entries)
        for batch in batches:
            self._counts[batch.channel] += len(batch.data)

    def finish(self) -> None:
        """Write the summary, by which a reader finds everything without reading the whole file."""
        self._write(DATA_END)
        start = self._offset
        groups: list[tuple[Opcode, Sequence[McapRecord]]] = [
            (Opcode.SCHEMA, self._schemas),
            (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.METADATA_INDEX, self._metadata),
        ]
        summary, offsets = b"", []
        for opcode, records in groups:
            group = _serialize(*records)
            offsets.append(SummaryOffset(opcode, start + len(summary), len(group)))
            summary += group
        offset_start = start + len(summary)
        summary += _serialize(*offsets)
        footer = _serialize(Footer(start, offset_start, 0))
        # The check sum covers the summary, and the footer up to the check sum itself.
        self._write(summary + footer[:-4] + struct.pack("<I", zlib.crc32(footer[:-4], zlib.crc32(summary))) + MAGIC)

    def _write(self, content: bytes) -> None:
        self._stream.write(content)
        self._hash.update(content)
        self._offset += len(content)

    def _note(self, record: McapRecord, start: int, length: int) -> None:
        """Note a record of a file that is reopened, for the summary; `start` and `length` in bytes."""
        if isinstance(record, Schema):
            self._schemas.append(record)
        elif isinstance(record, Channel):
            self._channels.append(record)
        elif isinstance(record, Metadata):
            self._metadata.append(MetadataIndex(offset=start, length=length, name=record.name))
        elif isinstance(record, Chunk):
            self._chunks.append(
                ChunkIndex(
                    chunk_length=length,
                    chunk_start_offset=start,
                    compression=record.compression,
                    compressed_size=len(record.data),
                    message_start_time=record.message_start_time,
                    message_end_time=record.message_end_time,
                    message_index_length=0,
                    message_index_offsets={},
                    uncompressed_size=record.uncompressed_size,
                )
            )
        elif isinstance(record, MessageIndex):
            self._chunks[-1].message_index_offsets[record.channel_id] = start
            self._chunks[-1].message_index_length += length
            self._counts[record.channel_id] += len(record.records)

    def _write_chunk(self, plain: bytes, first: int, last: int, entries: list[tuple[int, bytes]]) -> None:
        packed = COMPRESSORS.own.compress(plain)
        chunk = _serialize(
            Chunk(
                compression=COMPRESSION,
                data=packed,
                message_start_time=first,
                message_end_time=last,
                uncompressed_crc=zlib.crc32(plain),
                uncompressed_size=len(plain),
            )
        )
        start, offsets, indexes = self._offset, {}, b""
        for channel, index in entries:
            offsets[channel] = start + len(chunk) + len(indexes)
            indexes += _INDEX.pack(Opcode.MESSAGE_INDEX, 6 + len(index), channel, len(index)) + index
        self._write(chunk + indexes)
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


def _serialize(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    serialized: bytes = builder.end()  # type: ignore[no-untyped-call]
    return serialized


def _descriptor_set(kind: type[Any]) -> bytes:
    descriptors: bytes = build_file_descriptor_set(kind).SerializeToString()
    return descriptors
