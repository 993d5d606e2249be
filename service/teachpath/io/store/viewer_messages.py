"""Messages in a recording for viewers: the hand as foxglove.PoseInFrame, and the pose of its frame in the world.

Foxglove and Rerun know these messages; nothing here is read back.
"""

from __future__ import annotations

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame

from teachpath.io.store.mcap_file import McapFile, StampedMessage
from teachpath.records import Calibration, Sample

POSE_TOPIC, FRAMES_TOPIC = "hand_pose", "frames"
WORLD, TRACKER = "world", "tracker"  # names of the frames
NS_PER_S = 1_000_000_000


class ViewerMessages:
    """Adds the messages for viewers to the batches of one recording."""

    def __init__(self, file: McapFile, calibration: Calibration) -> None:
        self._poses = file.add_channel(POSE_TOPIC, PoseInFrame)
        self._frames = file.add_channel(FRAMES_TOPIC, FrameTransforms)
        self._calibration = calibration
        self._has_frame = False
        # The fields of one message are set for every sample, at a third of the cost of a new message.
        self._message = PoseInFrame(frame_id=TRACKER)
        pose = self._message.pose
        self._stamp, self._position, self._orientation = self._message.timestamp, pose.position, pose.orientation

    def append(self, sample: Sample, batch: list[StampedMessage]) -> None:
        """Append the messages of one sample to a batch; an untracked sample has no pose to draw."""
        if not self._has_frame:
            self._has_frame = True
            batch.append(_stamped(self._frames, sample, self._frame_message(sample)))
        if not sample.tracked:
            return
        self._stamp.seconds, self._stamp.nanos = divmod(sample.receive_ns, NS_PER_S)
        # A rigid transform has no scale; the pose carries it.
        scale, (x, y, z), p, q = self._calibration.scale, sample.position, self._position, self._orientation
        p.x, p.y, p.z = scale * x, scale * y, scale * z
        q.w, q.x, q.y, q.z = sample.orientation or (1.0, 0.0, 0.0, 0.0)
        batch.append(_stamped(self._poses, sample, self._message.SerializeToString()))

    def _frame_message(self, sample: Sample) -> bytes:
        message = FrameTransforms()
        frame = message.transforms.add(parent_frame_id=WORLD, child_frame_id=TRACKER)
        frame.timestamp.seconds, frame.timestamp.nanos = divmod(sample.receive_ns, NS_PER_S)
        frame.translation.x, frame.translation.y, frame.translation.z = self._calibration.offset
        q = frame.rotation
        q.w, q.x, q.y, q.z = self._calibration.rotation
        return message.SerializeToString()


def _stamped(channel: int, sample: Sample, data: bytes) -> StampedMessage:
    return StampedMessage(channel, 0, sample.receive_ns, sample.device_ns, data)
