"""The messages of the WebSocket of a tracker, as JSON: samples, and what the station answers."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.api.recording import RecordingReport


@dataclass(frozen=True, slots=True)
class SamplePosition:
    """Where a hand is, in the tracker's frame.

    Attributes:
        x: along the first axis [m].
        y: along the second axis [m].
        z: along the third axis [m].
    """

    x: float
    y: float
    z: float


@dataclass(frozen=True, slots=True)
class SampleOrientation:
    """How a hand is turned: a unit quaternion to tracker from hand; all zero: not measured.

    Attributes:
        w: its real part.
        x: its first imaginary part.
        y: its second imaginary part.
        z: its third imaginary part.
    """

    w: float
    x: float
    y: float
    z: float


@dataclass(frozen=True, slots=True)
class SampleFields:
    """A `HandSample` (teachpath/v1/tracker.proto) by the names of its fields; a field that is left out is zero.

    Attributes:
        sequence: one more than that of the sample sent before.
        device_ns: when it was read, device clock [ns since the Unix epoch]; as text where numbers have less than 64
            bits.
        position: of the hand.
        orientation: of the hand.
        flexions: of a glove, 0 (open) to 1 (closed); 18, 22 or none.
        tracked: whether the device saw the hand; else the pose is a guess.
        buttons: bit 0 grasp (of a hand without a glove), bit 1 pedal, bit 2 clutch of a live arm.
        joints: of an arm that shows the task, in the order of the station's arm [rad]; 6, 7 or none.
    """

    sequence: int
    device_ns: int | str
    position: SamplePosition
    tracked: bool
    orientation: SampleOrientation | None = None
    flexions: list[float] | None = None
    buttons: int = 0
    joints: list[float] | None = None


@dataclass(frozen=True, slots=True)
class SampleMessage:
    """One sample of a hand, where protobuf is not at hand.

    Attributes:
        sample: the reading of glove and tracker.
    """

    sample: SampleFields


@dataclass(frozen=True, slots=True)
class PingMessage:
    """A question whether the station is there.

    Attributes:
        ping: any number; the answer has it again.
    """

    ping: float


@dataclass(frozen=True, slots=True)
class EndMessage:
    """The end of the recording.

    Attributes:
        end: number of the last sample that was sent.
        discard: whether the demonstration that is still open is thrown away.
    """

    end: int
    discard: bool = False


@dataclass(frozen=True, slots=True)
class SampleCounts:
    """What became of the samples of a connection.

    Attributes:
        passed: how many were passed on.
        refused: how many could not be used.
    """

    passed: int
    refused: int


@dataclass(frozen=True, slots=True)
class PongMessage:
    """The answer to a ping.

    Attributes:
        pong: the number of the ping.
        service_ns: the station's clock [ns since the Unix epoch].
        samples: what became of those sent so far.
    """

    pong: float
    service_ns: int
    samples: SampleCounts


@dataclass(frozen=True, slots=True)
class ReportMessage:
    """The answer to an end.

    Attributes:
        report: the account of the recording.
    """

    report: RecordingReport


@dataclass(frozen=True, slots=True)
class RefusedMessage:
    """Why a message could not be used.

    Attributes:
        refused: a sentence for the operator.
    """

    refused: str
