"""Messages in a recording for viewers: the hand as foxglove.PoseInFrame, and the pose of its frame in the world.

Foxglove and Rerun know these messages; nothing here is read back.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Final

import numpy as np
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from numpy.typing import NDArray

from teachpath.io.store.mcap_file import McapFile
from teachpath.io.store.mcap_messages import Bytes, MessageBatch
from teachpath.records import Array, Calibration, SampleColumns

POSE_TOPIC, FRAMES_TOPIC = "hand_pose", "frames"
WORLD, TRACKER = "world", "tracker"  # names of the frames
NS_PER_S = 1_000_000_000
VARINT_SIZE: Final = 5  # bytes of a number from 2**28 to 2**35 - 1; a shorter one can be written in as many
VARINT_SHIFTS: Final = 7 * np.arange(VARINT_SIZE)
SECONDS_MARK, NANOS_MARK = 2**34 + 1, 2**30 + 1  # numbers of that size, for which others are put in
NOT_TURNED: Final = (1.0, 0.0, 0.0, 0.0)

Integers = NDArray[np.uint64] | NDArray[np.int64]


class ViewerMessages:
    """Makes the messages for viewers of one recording."""

    def __init__(self, file: McapFile, calibration: Calibration) -> None:
        self._poses = file.add_channel(POSE_TOPIC, PoseInFrame)
        self._frames = file.add_channel(FRAMES_TOPIC, FrameTransforms)
        self._calibration = calibration
        self._has_frame = False

    def batches(self, samples: SampleColumns) -> list[MessageBatch]:
        """Return the messages of the next samples; an untracked sample has no pose to draw."""
        batches = []
        if not self._has_frame:
            self._has_frame = True
            frame = self._frame_message(int(samples.receive_ns[0]))
            batches.append(message_batch(self._frames, [frame], samples.receive_ns[:1], samples.device_ns[:1]))
        tracked = samples.tracked
        receive_ns, device_ns = samples.receive_ns[tracked], samples.device_ns[tracked]
        turns = samples.orientation[tracked]
        turns[~turns.any(axis=1)] = NOT_TURNED
        # A rigid transform has no scale; the pose carries it.
        positions = self._calibration.scale * samples.position[tracked]
        poses = LAYOUT.messages(receive_ns.astype(np.int64), positions, turns)
        return [*batches, message_batch(self._poses, poses, receive_ns, device_ns)]

    def _frame_message(self, receive_ns: int) -> bytes:
        message = FrameTransforms()
        frame = message.transforms.add(parent_frame_id=WORLD, child_frame_id=TRACKER)
        frame.timestamp.seconds, frame.timestamp.nanos = divmod(receive_ns, NS_PER_S)
        frame.translation.x, frame.translation.y, frame.translation.z = self._calibration.offset
        q = frame.rotation
        q.w, q.x, q.y, q.z = self._calibration.rotation
        return message.SerializeToString()


def message_batch(
    channel: int,
    data: Sequence[bytes] | Bytes,
    receive_ns: Integers,
    device_ns: Integers,
    sequences: NDArray[np.uint64] | None = None,
) -> MessageBatch:
    """Return n messages with the times (n,) of their samples; without `sequences` (n,) they have none."""
    numbers = np.zeros(len(data), np.uint64) if sequences is None else sequences
    return MessageBatch(channel, numbers, receive_ns.astype(np.uint64), device_ns.astype(np.uint64), data)


class _PoseLayout:
    """Where the numbers of a pose lie in its message, so that many are laid out at once, at a tenth of the cost."""

    def __init__(self) -> None:
        message, marks = PoseInFrame(frame_id=TRACKER), [1.0 + i for i in range(7)]
        message.timestamp.seconds, message.timestamp.nanos = SECONDS_MARK, NANOS_MARK
        p, q = message.pose.position, message.pose.orientation
        p.x, p.y, p.z, q.w, q.x, q.y, q.z = marks
        content = message.SerializeToString()
        self._template = np.frombuffer(content, np.uint8)
        self._doubles = [content.index(struct.pack("<d", mark)) for mark in marks]
        self._stamps = [content.index(_varints(np.array([mark])).tobytes()) for mark in (SECONDS_MARK, NANOS_MARK)]

    def messages(self, stamps_ns: NDArray[np.int64], positions: Array, turns: Array) -> Bytes:
        """Return n messages (n, size).

        Args:
            stamps_ns: (n,) since the Unix epoch.
            positions: (n, 3) [m].
            turns: (n, 4) w, x, y, z.
        """
        rows = np.empty((len(stamps_ns), len(self._template)), np.uint8)
        rows[:] = self._template
        for values, starts in ((positions, self._doubles[:3]), (turns, self._doubles[3:])):
            laid_out = values.astype("<f8").view(np.uint8)
            for i, start in enumerate(starts):
                rows[:, start : start + 8] = laid_out[:, 8 * i : 8 * (i + 1)]
        for stamps, start in zip(np.divmod(stamps_ns, NS_PER_S), self._stamps, strict=True):
            rows[:, start : start + VARINT_SIZE] = _varints(stamps)
        return rows


def _varints(numbers: NDArray[np.int64]) -> Bytes:
    """Return (..., VARINT_SIZE) bytes: protobuf's encoding of each number, seven bits a byte, the lowest first."""
    parts = ((numbers[..., None] >> VARINT_SHIFTS) & 0x7F).astype(np.uint8)
    parts[..., :-1] |= 0x80  # another byte follows
    return parts


LAYOUT: Final = _PoseLayout()
