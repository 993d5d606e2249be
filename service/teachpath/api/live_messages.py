"""The messages of the WebSockets, as JSON: what a station sends, and what it takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal

from teachpath.api.recording import RecordingReport
from teachpath.live.row_status import ExecutionStatus, JobStatus
from teachpath.records import ExecutorStatus

Resource = Literal[
    "arms",
    "calibrations",
    "demonstrations",
    "executions",
    "jobs",
    "journal",
    "paths",
    "plans",
    "revocations",
    "runs",
    "scenes",
    "services",
    "tasks",
]


@dataclass(frozen=True, slots=True)
class ChangeEvent:
    """A resource of the REST API has changed; read it anew.

    Attributes:
        sequence: counts up by one for each change at the station; one that is left out was overtaken.
        topic: what it is one of; most are named as in the REST API.
        id: of what has changed; of a task its name.
        status: how a job or an execution stands; left out of others, and where it could not be read.
    """

    sequence: int
    topic: Resource
    id: str
    status: JobStatus | ExecutionStatus | None = None


@dataclass(frozen=True, slots=True)
class ResyncEvent:
    """Anything may have changed: read everything anew. It comes first, and when a subscriber has fallen behind.

    Attributes:
        sequence: number of the newest change that it stands for.
        topic: all.
        id: empty.
        reason: why it was sent, in words.
    """

    sequence: int
    topic: Literal["all"]
    id: str
    reason: str


@dataclass(frozen=True, slots=True)
class StationState:
    """The station as a whole.

    Attributes:
        version: of the service.
        notes: what needs somebody, in words.
        authority: whether devices can get the certificate of the station's own authority, at /authority.
        documents: whether the documents were built here, and are at /help.
        name: of this station among those on its store; empty where it has none.
        display_name: what people call the station; empty: nobody said.
    """

    version: str
    notes: list[str]
    authority: bool
    documents: bool
    name: str
    display_name: str


@dataclass(frozen=True, slots=True)
class TrackerState:
    """A tracker that is there.

    Attributes:
        announced: whether by a liveliness token; a tracker without one only sends.
        silent: whether it has sent and does not any more.
    """

    announced: bool
    silent: bool


@dataclass(frozen=True, slots=True)
class GuidanceState:
    """What the operator of a task should do next.

    Attributes:
        sentence: in words.
    """

    sentence: str


# What `now` holds, by the topic of an event that carries a state.
STATES: Final[dict[str, Any]] = {
    "station": StationState,
    "executor": ExecutorStatus,
    "trackers": TrackerState,
    "recordings": RecordingReport,
    "guidance": GuidanceState,
}


@dataclass(frozen=True, slots=True)
class JointMessage:
    """What the arm does, and where its execution stands.

    Attributes:
        stamp_ns: when the arm was so [ns since the Unix epoch].
        execution: id of the one whose setpoints it plays; empty: none.
        position: (joints,) of the joints [rad].
        velocity: (joints,) of the joints [rad/s].
        speed: (joints,) largest speed of each joint since the message before, signed [rad/s].
        torque: (joints,) of the joints [N m]; zeros where the arm does not measure it.
        tracking_error: largest over the joints since the message before [rad].
        lateness: of setpoints, the largest since the message before [s]; null: none was sent.
        missed: setpoints that never came since the execution began.
        holding: whether the arm follows a way to rest, or has followed it.
        gripper_closed: whether the gripper is told to be closed.
        gripper_opening: measured between the fingers [m]; null where the arm does not measure it.
        output: name of the output that is on; empty: none.
        enabled: whether the drives are on.
        protective_stop: whether the arm's own controller has stopped it.
        fault: what is wrong with the arm, in words; empty: nothing.
        status: of the executor; null until it has said something.
    """

    stamp_ns: int
    execution: str
    position: list[float]
    velocity: list[float]
    speed: list[float]
    torque: list[float]
    tracking_error: float
    lateness: float | None
    missed: int
    holding: bool
    gripper_closed: bool
    gripper_opening: float | None
    output: str
    enabled: bool
    protective_stop: bool
    fault: str
    status: ExecutorStatus | None


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
