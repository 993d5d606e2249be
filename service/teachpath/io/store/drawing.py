"""What viewers draw of a recording: the hand as foxglove.PoseInFrame, and where its frame stands in the world.

Foxglove and Rerun know these messages; nothing here is read back.
"""

from __future__ import annotations

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame

from teachpath.io.store.mcap_file import McapFile, Stamped
from teachpath.records import Calibration, Sample

POSE, FRAMES = "hand_pose", "frames"
WORLD, TRACKER = "world", "tracker"
BILLION = 1_000_000_000


class Drawing:
    """Draws one recording beside its samples."""

    def __init__(self, file: McapFile, calibration: Calibration) -> None:
        self._poses = file.add_channel(POSE, PoseInFrame)
        self._frames = file.add_channel(FRAMES, FrameTransforms)
        self._calibration = calibration
        self._is_placed = False
        # filled anew for every sample, part by part: a third of the cost of new ones
        self._message = PoseInFrame(frame_id=TRACKER)
        pose = self._message.pose
        self._stamp, self._position, self._orientation = self._message.timestamp, pose.position, pose.orientation

    def draw(self, sample: Sample, onto: list[Stamped]) -> None:
        """Append the messages that draw one sample; an untracked one is not drawn."""
        if not self._is_placed:
            self._is_placed = True
            onto.append(Stamped(self._frames, 0, sample.receive_ns, sample.device_ns, self._placed(sample)))
        if not sample.tracked:
            return
        self._stamp.seconds, self._stamp.nanos = divmod(sample.receive_ns, BILLION)
        # A rigid transform has no scale; the pose carries it.
        scale, (x, y, z), p, q = self._calibration.scale, sample.position, self._position, self._orientation
        p.x, p.y, p.z = scale * x, scale * y, scale * z
        q.w, q.x, q.y, q.z = sample.orientation or (1.0, 0.0, 0.0, 0.0)
        onto.append(Stamped(self._poses, 0, sample.receive_ns, sample.device_ns, self._message.SerializeToString()))

    def _placed(self, sample: Sample) -> bytes:
        message = FrameTransforms()
        frame = message.transforms.add(parent_frame_id=WORLD, child_frame_id=TRACKER)
        frame.timestamp.seconds, frame.timestamp.nanos = divmod(sample.receive_ns, BILLION)
        frame.translation.x, frame.translation.y, frame.translation.z = self._calibration.offset
        q = frame.rotation
        q.w, q.x, q.y, q.z = self._calibration.rotation
        return message.SerializeToString()
