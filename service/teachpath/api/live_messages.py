"""The messages of the WebSockets of events and joints, as JSON; `sample_messages.py` has those of a tracker."""

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
