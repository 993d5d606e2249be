"""One reading of a glove and a tracker, in the form that every source yields."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath_proto import tracker_pb2

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class HandReading:
    """A hand at one moment.

    Attributes:
        time: [s] on the device's clock, from the start of the source.
        position: [m], tracker frame.
        orientation: unit quaternion w, x, y, z, or None when not measured.
        flexions: 18 or 22 values from 0 (open) to 1 (closed), or none.
        tracked: False when the pose is a guess of the device.
        buttons: bit 0 = grasp held.
        device_ns: the device's own stamp [ns since the Unix epoch]; None: `time` counts from when the first one came.
        joints: of an arm that shows the task, 6 or 7 in the order of the station's arm [rad], or none.
    """

    time: float
    position: Vector
    orientation: Quaternion | None = None
    flexions: tuple[float, ...] = ()
    tracked: bool = True
    buttons: int = 0
    device_ns: int | None = None
    joints: tuple[float, ...] = ()

    def message(self, sequence: int, start_ns: int) -> tracker_pb2.HandSample:
        """Return the sample on the wire; `start_ns` is the device's clock at time 0, where it has no stamps."""
        w, x, y, z = self.orientation or (0.0, 0.0, 0.0, 0.0)
        return tracker_pb2.HandSample(
            sequence=sequence,
            device_ns=start_ns + round(self.time * 1e9) if self.device_ns is None else self.device_ns,
            position=tracker_pb2.Vector3(x=self.position[0], y=self.position[1], z=self.position[2]),
            orientation=tracker_pb2.Quaternion(w=w, x=x, y=y, z=z),
            flexions=self.flexions,
            tracked=self.tracked,
            buttons=self.buttons,
            joints=self.joints,
        )
