"""What viewers draw of a recording: the hand as foxglove.PoseInFrame, and where its frame stands in the world.

Foxglove and Rerun know these messages; nothing here is read back.
"""

from __future__ import annotations

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema

from teachpath.records import Calibration, Sample

POSE, FRAMES = "hand_pose", "frames"
WORLD, TRACKER = "world", "tracker"
BILLION = 1_000_000_000


class Drawing:
    """Writes the drawing of one recording beside its samples."""

    def __init__(self, writer: Writer, calibration: Calibration) -> None:
        self._writer, self._calibration = writer, calibration
        self._poses = self._channel(POSE, PoseInFrame)
        self._frames = self._channel(FRAMES, FrameTransforms)
        self._is_placed = False
        self._message = PoseInFrame(frame_id=TRACKER)  # filled anew for every sample: half the cost

    def write(self, sample: Sample) -> None:
        """Draw one sample; an untracked one is not drawn."""
        if not self._is_placed:
            self._is_placed = True
            self._place(sample)
        if not sample.tracked:
            return
        m, pose = self._message, self._message.pose
        m.timestamp.seconds, m.timestamp.nanos = divmod(sample.receive_ns, BILLION)
        # A rigid transform has no scale; the pose carries it.
        scale, (x, y, z) = self._calibration.scale, sample.position
        pose.position.x, pose.position.y, pose.position.z = scale * x, scale * y, scale * z
        w, x, y, z = sample.orientation or (1.0, 0.0, 0.0, 0.0)
        q = pose.orientation
        q.w, q.x, q.y, q.z = w, x, y, z
        self._writer.add_message(self._poses, sample.receive_ns, m.SerializeToString(), sample.device_ns)

    def _place(self, sample: Sample) -> None:
        message = FrameTransforms()
        frame = message.transforms.add(parent_frame_id=WORLD, child_frame_id=TRACKER)
        frame.timestamp.seconds, frame.timestamp.nanos = divmod(sample.receive_ns, BILLION)
        frame.translation.x, frame.translation.y, frame.translation.z = self._calibration.offset
        q = frame.rotation
        q.w, q.x, q.y, q.z = self._calibration.rotation
        self._writer.add_message(self._frames, sample.receive_ns, message.SerializeToString(), sample.device_ns)

    def _channel(self, topic: str, kind: type[PoseInFrame] | type[FrameTransforms]) -> int:
        schema = register_schema(self._writer, kind)
        return self._writer.register_channel(topic=topic, message_encoding="protobuf", schema_id=schema)
