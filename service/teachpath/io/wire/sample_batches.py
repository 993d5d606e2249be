"""Hand samples decoded by the batch: messages that are laid out alike are read as the rows of one array.

Nearly all messages of a tracker have their fields at the same bytes. A message that has not, or that holds a value
which may be refused, is left to `decode_sample`, which says what is wrong with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from teachpath.records import SampleColumns
from teachpath_proto.sample_rules import (
    FLEXION_COUNTS,
    JOINT_COUNTS,
    MAX_ANGLE,
    MAX_COORDINATE,
    MAX_SAMPLE_SIZE,
    UNIT_TOLERANCE,
)

MAX_LAYOUTS: Final = 64  # that are remembered
MAX_TRIES: Final = 8  # layouts that are looked for among the messages of one size
ROUNDING: Final = 1e-9  # a norm so near to its limit is left to `decode_sample`
MAX_VARINT_SIZE: Final = 9  # bytes, of numbers under 2**63
VARINT, FIXED64, BYTES = 0, 1, 2  # wire types of protobuf
VARINT_FIELDS: Final = {1: "sequence", 2: "device_ns", 6: "tracked", 7: "buttons"}
VECTOR_FIELDS: Final = {3: (0, 3), 4: (3, 4)}  # first and number of the doubles of position and orientation
FLEXIONS_FIELD: Final = 5
JOINTS_FIELD: Final = 8

Bytes = NDArray[np.uint8]


class SampleBatchDecoder:
    """Decodes many hand samples at once; not thread-safe."""

    def __init__(self) -> None:
        self._layouts: dict[int, list[_Layout]] = {}  # by size

    def decode(
        self, payloads: Sequence[bytes], receive_ns: Sequence[int], tracker: str = ""
    ) -> tuple[SampleColumns, NDArray[np.bool_]]:
        """Decode n samples.

        Returns:
            Their columns, and (n,) which of them are decoded; `decode_sample` decides on the others, whose values mean
            nothing.
        """
        n = len(payloads)
        usable = np.zeros(n, np.bool_)
        columns = SampleColumns(
            tracker,
            np.zeros(n, np.uint64),
            np.zeros(n, np.int64),
            np.array(receive_ns, np.uint64),
            np.zeros((n, 3)),
            np.zeros((n, 4)),
            np.zeros((n, max(FLEXION_COUNTS)), np.float32),
            np.zeros(n, np.int64),
            np.zeros(n, np.bool_),
            np.zeros(n, np.int64),
            np.full((n, max(JOINT_COUNTS)), np.nan),
        )
        sizes = np.fromiter(map(len, payloads), np.int64, n)
        for size in set(sizes.tolist()):
            if 0 < size <= MAX_SAMPLE_SIZE:
                self._decode_size(payloads, np.flatnonzero(sizes == size), columns, usable)
        width = int(np.isfinite(columns.joints).any(axis=0).sum())
        return replace(columns, joints=columns.joints[:, :width]), usable

    def _decode_size(
        self, payloads: Sequence[bytes], left: NDArray[np.int64], columns: SampleColumns, usable: NDArray[np.bool_]
    ) -> None:
        """Decode the messages at the indices `left`, which are of one size."""
        size = len(payloads[left[0]])
        rows = np.frombuffer(b"".join([payloads[i] for i in left.tolist()]), np.uint8).reshape(-1, size)
        known = self._layouts.get(size, [])
        for layout in known:
            left, rows = layout.read(rows, left, columns, usable)
            if not len(left):
                return
        for _ in range(MAX_TRIES):
            if not len(left):
                return
            try:
                layout = _Layout(payloads[left[0]])
            except (ValueError, IndexError):
                left, rows = left[1:], rows[1:]
                continue
            self._remember(layout)
            left, rows = layout.read(rows, left, columns, usable)

    def _remember(self, layout: _Layout) -> None:
        if sum(map(len, self._layouts.values())) >= MAX_LAYOUTS:
            self._layouts.clear()
        self._layouts.setdefault(layout.size, []).append(layout)


class _Layout:
    """Where the fields of a message lie.

    Raises:
        ValueError, IndexError: the message is damaged, or laid out in another way than any tracker known lays it out.
    """

    def __init__(self, payload: bytes) -> None:
        self.size = len(payload)
        self._varints: dict[str, slice] = {}
        self._doubles: list[int] = []  # which of position and orientation
        self._flexions = self._joints = slice(0, 0)
        starts: list[int] = []  # of the doubles
        # of each byte, what is the same in all messages of this layout: all bits of a mark, the highest of a number
        self._mask = np.full(self.size, 0xFF, np.uint8)
        seen: set[int] = set()
        at = 0
        while at < self.size:
            field, kind, at = _tag(payload, at, seen)
            if kind == VARINT and field in VARINT_FIELDS:
                end = _varint_end(payload, at)
                self._varints[VARINT_FIELDS[field]] = slice(at, end)
                self._mask[at:end] = 0x80
            elif kind == BYTES and (field in VECTOR_FIELDS or field in (FLEXIONS_FIELD, JOINTS_FIELD)):
                end, at = _length(payload, at)
                if field == FLEXIONS_FIELD:
                    self._flexions = slice(at, end)
                    self._mask[at:end] = 0
                elif field == JOINTS_FIELD:
                    self._joints = slice(at, end)
                    self._mask[at:end] = 0
                else:
                    self._add_vector(payload, at, end, starts, *VECTOR_FIELDS[field])
            else:
                raise ValueError(f"field {field} of type {kind}")
            at = end
        _check_count(self._flexions, 4, FLEXION_COUNTS)
        _check_count(self._joints, 8, JOINT_COUNTS)
        self._marks = np.frombuffer(payload, np.uint8) & self._mask
        self._places = np.array([start + byte for start in starts for byte in range(8)], np.int64)

    def _add_vector(self, payload: bytes, at: int, end: int, starts: list[int], first: int, count: int) -> None:
        seen: set[int] = set()
        while at < end:
            field, kind, at = _tag(payload, at, seen)
            if kind != FIXED64 or not 1 <= field <= count or at + 8 > end:
                raise ValueError(f"field {field} of type {kind}")
            self._doubles.append(first + field - 1)
            starts.append(at)
            self._mask[at : at + 8] = 0
            at += 8

    def read(
        self, rows: Bytes, indices: NDArray[np.int64], columns: SampleColumns, usable: NDArray[np.bool_]
    ) -> tuple[NDArray[np.int64], Bytes]:
        """Put the values of the messages (n, size) of this layout into the columns at their indices (n,).

        Returns:
            Indices and rows of the messages that are laid out otherwise.
        """
        ours = ~np.any((rows & self._mask) != self._marks, axis=1)
        if not ours.any():
            return indices, rows
        rest = indices[~ours], rows[~ours]
        if len(rest[0]):
            indices, rows = indices[ours], rows[ours]
        numbers = np.zeros((len(rows), 7))
        numbers[:, self._doubles] = np.take(rows, self._places, axis=1).view("<f8")
        position, turn = numbers[:, :3], numbers[:, 3:]
        flexions = np.ascontiguousarray(rows[:, self._flexions]).view("<f4")
        joints = np.ascontiguousarray(rows[:, self._joints]).view("<f8")
        device_ns = self._integers(rows, "device_ns").astype(np.int64)
        turned = turn.any(axis=1)
        with np.errstate(all="ignore"):  # what is not finite is left to `decode_sample`
            norm = np.where(turned, _norm(turn), 1.0)
            turn = turn / norm[:, None]
            fit = (np.abs(position) <= MAX_COORDINATE).all(axis=1) & (device_ns > 0)
            fit &= ((flexions >= 0.0) & (flexions <= 1.0)).all(axis=1)
            fit &= (np.abs(joints) <= MAX_ANGLE).all(axis=1)
            fit &= np.abs(norm - 1.0) <= UNIT_TOLERANCE - ROUNDING
        columns.sequence[indices] = self._integers(rows, "sequence")
        columns.device_ns[indices] = device_ns
        columns.position[indices] = position
        columns.orientation[indices] = turn
        columns.flexions[indices, : flexions.shape[1]] = flexions
        columns.flexion_count[indices] = flexions.shape[1]
        columns.joints[indices, : joints.shape[1]] = joints
        columns.tracked[indices] = self._integers(rows, "tracked") != 0
        columns.buttons[indices] = (self._integers(rows, "buttons") & np.uint64(0xFFFFFFFF)).astype(np.int64)
        usable[indices] = fit
        return rest

    def _integers(self, rows: Bytes, name: str) -> NDArray[np.uint64]:
        """Return the numbers (n,) of a field that protobuf writes as seven bits a byte, the lowest first."""
        place = self._varints.get(name)
        total: NDArray[Any] = np.zeros(len(rows), np.uint64)
        if place is not None:
            for shift, column in enumerate(range(place.start, place.stop)):
                total |= (rows[:, column] & 0x7F).astype(np.uint64) << np.uint64(7 * shift)
        return total


def _check_count(place: slice, size: int, counts: tuple[int, ...]) -> None:
    """Check that the bytes at a place are one of `counts` values of `size` bytes; raises ValueError."""
    count, rest = divmod(place.stop - place.start, size)
    if rest or count not in counts:
        raise ValueError("another number of flexions or joints")


def _norm(turn: NDArray[np.float64]) -> NDArray[np.float64]:
    w, x, y, z = turn.T  # in the order of `decode_sample`, so that both round alike
    return np.asarray(np.sqrt(w * w + x * x + y * y + z * z))


def _tag(payload: bytes, at: int, seen: set[int]) -> tuple[int, int, int]:
    """Return field, wire type and the byte after the tag at `at`; a field that comes twice is refused."""
    tag = payload[at]
    if tag & 0x80 or tag >> 3 in seen:
        raise ValueError("a field that is not known, or comes twice")
    seen.add(tag >> 3)
    return tag >> 3, tag & 7, at + 1


def _varint_end(payload: bytes, at: int) -> int:
    for k in range(at, at + MAX_VARINT_SIZE):
        if not payload[k] & 0x80:
            return k + 1
    raise ValueError("a number that is larger than any of ours")


def _length(payload: bytes, at: int) -> tuple[int, int]:
    """Return end and begin of what a length at `at` precedes."""
    end = _varint_end(payload, at)
    size = sum((byte & 0x7F) << (7 * k) for k, byte in enumerate(payload[at:end]))
    if end + size > len(payload):
        raise ValueError("it is cut off")
    return end + size, end
