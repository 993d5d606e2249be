"""Messages of an MCAP file, laid out by the batch as the records of a chunk, and compressed."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import zstandard
from mcap.opcode import Opcode
from numpy.typing import NDArray

COMPRESSION_LEVEL: Final = 1
_MESSAGE_HEAD = np.dtype(  # of a message; its data follow
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
_PREFIX_SIZE = 9  # bytes of opcode and length, which the length does not count

Integers = NDArray[np.uint64]
Bytes = NDArray[np.uint8]


@dataclass(frozen=True, eq=False)
class MessageBatch:
    """Messages of one channel; times in nanoseconds since the Unix epoch.

    Attributes:
        channel: as `McapFile.add_channel` returned it.
        sequences: (n,), of which the file keeps the lower 32 bits.
        log_times: (n,).
        publish_times: (n,).
        data: n messages, or their bytes (n, size).
    """

    channel: int
    sequences: Integers
    log_times: Integers
    publish_times: Integers
    data: Sequence[bytes] | Bytes


def message_records(batch: MessageBatch) -> tuple[bytes, Integers]:
    """Return the records of n messages, one after the other, and the size of each (n,) [bytes]."""
    n, size, data = len(batch.data), _MESSAGE_HEAD.itemsize, batch.data
    lengths = np.full(n, data.shape[1]) if isinstance(data, np.ndarray) else np.fromiter(map(len, data), np.int64, n)
    sizes = (lengths + size).astype(np.uint64)
    heads = np.empty(n, _MESSAGE_HEAD)
    heads["opcode"], heads["length"], heads["channel"] = Opcode.MESSAGE, sizes - _PREFIX_SIZE, batch.channel
    heads["sequence"] = batch.sequences & 0xFFFFFFFF
    heads["log_time"], heads["publish_time"] = batch.log_times, batch.publish_times
    if lengths.min() == lengths.max():  # as nearly always: the records are the rows of one array
        rows = data if isinstance(data, np.ndarray) else np.frombuffer(b"".join(data), np.uint8)
        laid_out = np.empty((n, size + int(lengths[0])), np.uint8)
        laid_out[:, :size] = heads.view(np.uint8).reshape(n, size)
        laid_out[:, size:] = rows.reshape(n, int(lengths[0]))
        return laid_out.tobytes(), sizes
    packed = heads.tobytes()
    return b"".join([part for i, each in enumerate(data) for part in (packed[size * i : size * (i + 1)], each)]), sizes


class Compressors(threading.local):
    """A compressor for each thread, which takes ten times as long to make as a chunk to compress."""

    def __init__(self) -> None:
        self.own: zstandard.ZstdCompressor = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL)


COMPRESSORS: Final = Compressors()
