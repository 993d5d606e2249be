"""The records of an MCAP file in turn; a chunk is decompressed within limits, and its records are read one by one."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO, Final, cast

import lz4.frame
import zstandard
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Chunk, Header, McapRecord, Message, MessageIndex
from mcap.stream_reader import StreamReader

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings

MAX_RECORD_SIZE: Final = 16 * 1024 * 1024  # bytes of a record, and of what one chunk expands to
MAX_RECORDS_PER_SAMPLE: Final = 10  # a sample has some messages for viewers beside it
OPENING: Final = struct.Struct("<BQ")  # of a record: its kind, and the bytes that follow
# Of the record of a message: its kind, the bytes that follow, channel, number, time of the log, time of publication.
MESSAGE: Final = struct.Struct("<BQHIQQ")
MESSAGE_KIND: Final = int(Opcode.MESSAGE)
INDEX: Final = struct.Struct("<HI")  # of messages: channel, and the bytes of the entries that follow
INDEX_ENTRY: Final = struct.Struct("<QQ")  # time of the log, and where in the chunk


class BoundedStream:
    """What is read of a file, in pieces that are no longer than a record may be.

    A record's own length is limited by the reader, but not those of its fields, and a damaged one asks for any memory.

    Args:
        stream: of the file.
    """

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream

    def read(self, length: int) -> bytes:
        """Return the next bytes, at most `length`; raises UnusableRecording where that is too many."""
        if length > MAX_RECORD_SIZE:
            raise UnusableRecording(f"a field of it is {length} bytes long, limit {MAX_RECORD_SIZE}: it is damaged")
        return self._stream.read(length)


class RecordReader(StreamReader):
    """The library's reader; it reads an index of messages at once, where the library reads number after number."""

    def _read_record(self, opcode: int, length: int) -> McapRecord | None:
        if opcode != Opcode.MESSAGE_INDEX:
            return super()._read_record(opcode, length)
        content = self._stream.read(length)
        if len(content) < length:
            raise EndOfFile
        channel, size = INDEX.unpack_from(content)
        entries = content[INDEX.size : INDEX.size + size]
        if len(entries) < size or size % INDEX_ENTRY.size:
            raise UnusableRecording(f"an index of messages states {size} bytes and has {len(entries)}: it is damaged")
        return MessageIndex(channel, list(INDEX_ENTRY.iter_unpack(entries)))


def open_records(stream: BinaryIO, *, emit_chunks: bool = False) -> Iterator[McapRecord]:
    """Yield the records of a file, or its chunks as they are; no damage asks for more memory than records may have."""
    bounded = cast(BinaryIO, BoundedStream(stream))
    reader = RecordReader(bounded, emit_chunks=emit_chunks, validate_crcs=True, record_size_limit=MAX_RECORD_SIZE)
    return iter(reader.records)


def read_records(stream: BinaryIO, limits: ImportSettings | None = None) -> Iterator[McapRecord]:
    """Yield every record but chunks, whose records take their place.

    Args:
        stream: of the file, at its beginning.
        limits: of a file that is imported; without them only each chunk is limited, to 16 MiB.

    Raises:
        UnusableRecording: it has no header, or expands to more than the limits.
        EndOfFile: it is cut off.
    """
    records = open_records(stream, emit_chunks=True)
    if not isinstance(next(records, None), Header):
        raise UnusableRecording("it has no MCAP header")
    expanded = count = 0
    for record in records:
        if isinstance(record, Chunk):
            expanded += record.uncompressed_size
            if limits is not None and expanded > limits.max_expanded_size:
                raise UnusableRecording(
                    f"its chunks expand to {expanded} bytes or more, limit {limits.max_expanded_size} "
                    "(imports.max_expanded_size); split the recording"
                )
        for each in _chunk_records(record) if isinstance(record, Chunk) else (record,):
            count += 1
            if limits is not None and count > limits.max_samples * MAX_RECORDS_PER_SAMPLE:
                raise UnusableRecording(
                    f"it has over {limits.max_samples * MAX_RECORDS_PER_SAMPLE} records, {MAX_RECORDS_PER_SAMPLE} for "
                    "each sample of imports.max_samples; split the recording"
                )
            yield each


def _chunk_records(chunk: Chunk) -> Iterator[McapRecord]:
    plain = _decompressed(chunk)
    if chunk.uncompressed_crc not in (0, zlib.crc32(plain)):
        raise UnusableRecording("the check sum of a chunk is wrong")
    stream = io.BytesIO(plain)
    records = StreamReader(stream, skip_magic=True, emit_chunks=True, record_size_limit=MAX_RECORD_SIZE).records
    begin = 0
    try:
        while begin < len(plain):
            kind = plain[begin]
            if kind == MESSAGE_KIND and (message := _message_at(plain, begin)) is not None:
                yield message
                begin += MESSAGE.size + len(message.data)
                continue
            if kind == 0:
                raise UnusableRecording(f"byte {begin} of a chunk begins no record")
            stream.seek(begin)
            if not isinstance(record := next(records), Chunk):  # a chunk in a chunk is none
                yield record
            begin = stream.tell()
    except EndOfFile:
        if stream.tell() < len(plain):
            raise


def _message_at(plain: bytes, begin: int) -> Message | None:
    """Return the message whose record begins there, or None where it is not whole.

    A recording has little else, and the library reads one in four times the time.
    """
    data = begin + MESSAGE.size
    if data > len(plain):
        return None
    _, length, channel, number, logged, published = MESSAGE.unpack_from(plain, begin)
    end = begin + OPENING.size + length
    if not data <= end <= len(plain):
        return None
    return Message(channel, logged, plain[data:end], published, number)


def _decompressed(chunk: Chunk) -> bytes:
    """Return what a chunk holds; never takes more memory than the chunk says that it needs, nor more than the limit."""
    size = chunk.uncompressed_size
    if size > MAX_RECORD_SIZE:
        raise UnusableRecording(
            f"a chunk of {len(chunk.data)} bytes expands to {size}, limit {MAX_RECORD_SIZE}; write it in smaller chunks"
        )
    if chunk.compression == "zstd":
        decompressor = zstandard.ZstdDecompressor(max_window_size=MAX_RECORD_SIZE)
        plain = decompressor.stream_reader(chunk.data).read(size + 1)
    elif chunk.compression == "lz4":
        plain = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size + 1)
    elif chunk.compression == "":
        plain = chunk.data
    else:
        raise UnusableRecording(f"a chunk is compressed by {chunk.compression!r}; known: zstd, lz4, none")
    if len(plain) != size:
        raise UnusableRecording(
            f"a chunk that states {size} bytes expands to {'more' if len(plain) > size else len(plain)}"
        )
    return plain
