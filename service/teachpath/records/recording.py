"""A running recording: what starts and ends it, what the operator changes later, and its status."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

from teachpath.errors import UnusableInput
from teachpath.records.arrays import Pose, Vector
from teachpath.records.demonstrations import Phase, StreamStatistics
from teachpath.records.motion import ObjectPose, Shape

MAX_COUNTDOWN = 60.0  # [s]


class RecordingState(StrEnum):
    """What a recording does with the samples that come."""

    RECORDING = "recording"
    COUNTDOWN = "countdown"  # recording begins when the countdown has run out
    PAUSING = "pausing"  # the pause begins when the hand has released the object
    PAUSED = "paused"
    LOST = "lost"  # the tracker has gone; recording goes on when it comes back

    @cached_property  # asked for every sample; it costs a microsecond to look members up
    def is_writing(self) -> bool:
        """Whether the samples that come are written into a take."""
        return self in (RecordingState.RECORDING, RecordingState.PAUSING)


class FistCommand(StrEnum):
    """What the operator commands with a fist."""

    TOGGLE = "toggle"  # pause or resume
    DISCARD = "discard"  # discard the last demonstration


@dataclass(frozen=True, slots=True)
class Routine:
    """How an operator wants takes to follow each other; raises UnusableInput for a countdown without an end."""

    armed: bool = False  # begin paused
    countdown: float | None = None  # [s] before each take; None: as the settings say
    takes: int = 0  # pause after so many demonstrations; 0: never
    one_by_one: bool = False  # pause after each demonstration

    def __post_init__(self) -> None:
        if self.countdown is not None and not 0.0 <= self.countdown <= MAX_COUNTDOWN:
            raise UnusableInput(f"a countdown of {self.countdown:g} s is outside 0 to {MAX_COUNTDOWN:g}")


@dataclass(frozen=True, slots=True)
class RecordingRequest:
    """A request to record demonstrations of a task from a tracker."""

    task: str
    tracker: str
    calibration: str = ""  # its name; empty: that of the task
    scene: str = ""  # its name, for a task that does not exist yet; empty: the task must exist
    rate: float = 0.0  # [Hz] that the client declares; 0: it declares none
    routine: Routine = Routine()


@dataclass(frozen=True, slots=True)
class SuspendedRecording:
    """A recording that a stopped service left, for the next one to go on with.

    Attributes:
        request: what is recorded, with the calibration that was in use.
        state: what it did with samples.
        demonstrations: ids of those made so far.
        made: how many of them count in the routine.
        last: number and device time [ns] of the sample that was received last; None: none was.
        take: id of the take in the hand; empty: there is none.
        phase: of that take.
        grasp: where the hand grasped in it, as an index into its samples.
        object_pose: of the object then; None = where the scene has it.
    """

    request: RecordingRequest
    state: RecordingState
    demonstrations: tuple[str, ...] = ()
    made: int = 0
    last: tuple[int, int] | None = None
    take: str = ""
    phase: Phase = Phase.REACH
    grasp: int = 0
    object_pose: ObjectPose | None = None


@dataclass(frozen=True, slots=True)
class SuspendedRecordings:
    """All recordings that a stopped service left."""

    recordings: tuple[SuspendedRecording, ...] = ()


@dataclass(frozen=True, slots=True)
class StopRequest:
    """A request to end the recording of a tracker."""

    tracker: str
    last_sequence: int | None = None  # number of the last sample that the client sent; None: not known
    discard: bool = False  # throw away the demonstration that is still open


@dataclass(frozen=True, slots=True)
class TaskReference:
    """A task, by its name or by a tracker that is recording it."""

    task: str = ""
    tracker: str = ""


@dataclass(frozen=True, slots=True)
class Amendment:
    """What the operator changes of a stored demonstration; None leaves a thing as it is."""

    mark: str | None = None
    discarded: bool | None = None
    trim: tuple[int, int] | None = None  # samples [begin, end); an empty span brings back the recorder's own span


@dataclass(frozen=True, slots=True)
class HandState:
    """The newest state of a tracked hand.

    Attributes:
        position: of the hand [m, world].
        is_closed: whether it is closed enough to grasp.
        received: number of samples so far; a hand for which it does not rise is silent.
        take: 1, 2, ... counting every take that was begun.
        carried_pose: of the object, to world from object, while it is in the hand and can be computed.
    """

    position: Vector
    is_closed: bool
    received: int
    take: int
    carried_pose: Pose | None = None


@dataclass(frozen=True, slots=True)
class RecordingStatus:
    """A snapshot of one recording, for everybody who reports, draws or publishes it.

    Attributes:
        state: None once the recording has ended.
        phase: of the hand; None once the recording has ended.
        demonstrations: ids of those made so far, in order.
        countdown_left: [s] until samples are recorded.
        takes_left: demonstrations until the recording pauses; 0: nobody has said how many.
        pending_command: what the fist that is held now commands when it opens.
        pedal_used: whether the pedal has been pressed in this recording.
        idle: samples that belong to no demonstration.
        carried: the object that the hand is to carry, at its start; None: the scene has none.
        hand: None while the hand is not tracked, and in a snapshot that was taken without it.
        statistics: of all samples; None in a snapshot that was taken without them.
        hint: why the hand has grasped nothing, and what to do.
    """

    task: str
    tracker: str
    state: RecordingState | None
    phase: Phase | None
    demonstrations: tuple[str, ...] = ()
    countdown_left: float = 0.0
    takes_left: int = 0
    pending_command: FistCommand | None = None
    pedal_used: bool = False
    idle: int = 0
    carried: Shape | None = None
    hand: HandState | None = None
    statistics: StreamStatistics | None = None
    hint: str = ""
