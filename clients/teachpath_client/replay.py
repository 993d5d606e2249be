"""Recordings as a source: a stored demonstration played again with its original timing."""

from __future__ import annotations

import io
from collections.abc import Iterator

from mcap.reader import make_reader

from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_proto import tracker_pb2


def read_mcap(content: bytes) -> list[HandReading]:
    """Return the readings of a recording, in the order of their sequence numbers; times on the device's clock.

    Raises:
        ClientError: the file is no recording of hand samples.
    """
    messages: dict[int, tracker_pb2.HandSample] = {}
    try:
        for _, _, record in make_reader(io.BytesIO(content), validate_crcs=True).iter_messages(topics=["samples"]):
            message = tracker_pb2.HandSample.FromString(record.data)
            messages.setdefault(message.sequence, message)
    except Exception as error:  # damage shows as whatever the records, their compression and the messages raise
        raise ClientError(f"not a recording of hand samples, or a damaged one: {error!r}") from error
    if not messages:
        raise ClientError("the recording holds no hand samples")
    return list(_readings([messages[k] for k in sorted(messages)]))


def _readings(messages: list[tracker_pb2.HandSample]) -> Iterator[HandReading]:
    start_ns = messages[0].device_ns
    for m in messages:
        q = m.orientation
        measured = bool(q.w or q.x or q.y or q.z)
        yield HandReading(
            time=(m.device_ns - start_ns) * 1e-9,
            position=(m.position.x, m.position.y, m.position.z),
            orientation=(q.w, q.x, q.y, q.z) if measured else None,
            flexions=tuple(m.flexions),
            tracked=m.tracked,
            buttons=m.buttons,
            joints=tuple(m.joints),
        )
