from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Vector3(_message.Message):
    __slots__ = ("x", "y", "z")
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    Z_FIELD_NUMBER: _ClassVar[int]
    x: float
    y: float
    z: float
    def __init__(self, x: _Optional[float] = ..., y: _Optional[float] = ..., z: _Optional[float] = ...) -> None: ...

class Quaternion(_message.Message):
    __slots__ = ("w", "x", "y", "z")
    W_FIELD_NUMBER: _ClassVar[int]
    X_FIELD_NUMBER: _ClassVar[int]
    Y_FIELD_NUMBER: _ClassVar[int]
    Z_FIELD_NUMBER: _ClassVar[int]
    w: float
    x: float
    y: float
    z: float
    def __init__(self, w: _Optional[float] = ..., x: _Optional[float] = ..., y: _Optional[float] = ..., z: _Optional[float] = ...) -> None: ...

class HandSample(_message.Message):
    __slots__ = ("sequence", "device_ns", "position", "orientation", "flexions", "tracked", "buttons", "joints")
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    DEVICE_NS_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    ORIENTATION_FIELD_NUMBER: _ClassVar[int]
    FLEXIONS_FIELD_NUMBER: _ClassVar[int]
    TRACKED_FIELD_NUMBER: _ClassVar[int]
    BUTTONS_FIELD_NUMBER: _ClassVar[int]
    JOINTS_FIELD_NUMBER: _ClassVar[int]
    sequence: int
    device_ns: int
    position: Vector3
    orientation: Quaternion
    flexions: _containers.RepeatedScalarFieldContainer[float]
    tracked: bool
    buttons: int
    joints: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, sequence: _Optional[int] = ..., device_ns: _Optional[int] = ..., position: _Optional[_Union[Vector3, _Mapping[str, object]]] = ..., orientation: _Optional[_Union[Quaternion, _Mapping[str, object]]] = ..., flexions: _Optional[_Iterable[float]] = ..., tracked: _Optional[bool] = ..., buttons: _Optional[int] = ..., joints: _Optional[_Iterable[float]] = ...) -> None: ...

class StartRecording(_message.Message):
    __slots__ = ("task", "tracker", "calibration", "scene", "rate", "armed", "countdown", "takes", "one_by_one")
    TASK_FIELD_NUMBER: _ClassVar[int]
    TRACKER_FIELD_NUMBER: _ClassVar[int]
    CALIBRATION_FIELD_NUMBER: _ClassVar[int]
    SCENE_FIELD_NUMBER: _ClassVar[int]
    RATE_FIELD_NUMBER: _ClassVar[int]
    ARMED_FIELD_NUMBER: _ClassVar[int]
    COUNTDOWN_FIELD_NUMBER: _ClassVar[int]
    TAKES_FIELD_NUMBER: _ClassVar[int]
    ONE_BY_ONE_FIELD_NUMBER: _ClassVar[int]
    task: str
    tracker: str
    calibration: str
    scene: str
    rate: float
    armed: bool
    countdown: float
    takes: int
    one_by_one: bool
    def __init__(self, task: _Optional[str] = ..., tracker: _Optional[str] = ..., calibration: _Optional[str] = ..., scene: _Optional[str] = ..., rate: _Optional[float] = ..., armed: _Optional[bool] = ..., countdown: _Optional[float] = ..., takes: _Optional[int] = ..., one_by_one: _Optional[bool] = ...) -> None: ...

class StopRecording(_message.Message):
    __slots__ = ("tracker", "last_sequence", "discard")
    TRACKER_FIELD_NUMBER: _ClassVar[int]
    LAST_SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    DISCARD_FIELD_NUMBER: _ClassVar[int]
    tracker: str
    last_sequence: int
    discard: bool
    def __init__(self, tracker: _Optional[str] = ..., last_sequence: _Optional[int] = ..., discard: _Optional[bool] = ...) -> None: ...

class RecordingReport(_message.Message):
    __slots__ = ("task", "tracker", "demonstrations", "received", "lost", "duplicated", "reordered", "refused", "untracked", "longest_gap_ns", "notes", "phase", "idle", "gaps", "conflicts", "clock_jumps", "declared_rate", "seen_rate", "clock_offset_ns", "clock_uncertainty_ns", "clock_rate", "state", "pedal_used", "countdown_left", "takes_left", "pending_command", "missing", "late")
    TASK_FIELD_NUMBER: _ClassVar[int]
    TRACKER_FIELD_NUMBER: _ClassVar[int]
    DEMONSTRATIONS_FIELD_NUMBER: _ClassVar[int]
    RECEIVED_FIELD_NUMBER: _ClassVar[int]
    LOST_FIELD_NUMBER: _ClassVar[int]
    DUPLICATED_FIELD_NUMBER: _ClassVar[int]
    REORDERED_FIELD_NUMBER: _ClassVar[int]
    REFUSED_FIELD_NUMBER: _ClassVar[int]
    UNTRACKED_FIELD_NUMBER: _ClassVar[int]
    LONGEST_GAP_NS_FIELD_NUMBER: _ClassVar[int]
    NOTES_FIELD_NUMBER: _ClassVar[int]
    PHASE_FIELD_NUMBER: _ClassVar[int]
    IDLE_FIELD_NUMBER: _ClassVar[int]
    GAPS_FIELD_NUMBER: _ClassVar[int]
    CONFLICTS_FIELD_NUMBER: _ClassVar[int]
    CLOCK_JUMPS_FIELD_NUMBER: _ClassVar[int]
    DECLARED_RATE_FIELD_NUMBER: _ClassVar[int]
    SEEN_RATE_FIELD_NUMBER: _ClassVar[int]
    CLOCK_OFFSET_NS_FIELD_NUMBER: _ClassVar[int]
    CLOCK_UNCERTAINTY_NS_FIELD_NUMBER: _ClassVar[int]
    CLOCK_RATE_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    PEDAL_USED_FIELD_NUMBER: _ClassVar[int]
    COUNTDOWN_LEFT_FIELD_NUMBER: _ClassVar[int]
    TAKES_LEFT_FIELD_NUMBER: _ClassVar[int]
    PENDING_COMMAND_FIELD_NUMBER: _ClassVar[int]
    MISSING_FIELD_NUMBER: _ClassVar[int]
    LATE_FIELD_NUMBER: _ClassVar[int]
    task: str
    tracker: str
    demonstrations: _containers.RepeatedScalarFieldContainer[str]
    received: int
    lost: int
    duplicated: int
    reordered: int
    refused: int
    untracked: int
    longest_gap_ns: int
    notes: _containers.RepeatedScalarFieldContainer[str]
    phase: str
    idle: int
    gaps: int
    conflicts: int
    clock_jumps: int
    declared_rate: float
    seen_rate: float
    clock_offset_ns: int
    clock_uncertainty_ns: int
    clock_rate: float
    state: str
    pedal_used: bool
    countdown_left: float
    takes_left: int
    pending_command: str
    missing: _containers.RepeatedCompositeFieldContainer[SequenceRange]
    late: int
    def __init__(self, task: _Optional[str] = ..., tracker: _Optional[str] = ..., demonstrations: _Optional[_Iterable[str]] = ..., received: _Optional[int] = ..., lost: _Optional[int] = ..., duplicated: _Optional[int] = ..., reordered: _Optional[int] = ..., refused: _Optional[int] = ..., untracked: _Optional[int] = ..., longest_gap_ns: _Optional[int] = ..., notes: _Optional[_Iterable[str]] = ..., phase: _Optional[str] = ..., idle: _Optional[int] = ..., gaps: _Optional[int] = ..., conflicts: _Optional[int] = ..., clock_jumps: _Optional[int] = ..., declared_rate: _Optional[float] = ..., seen_rate: _Optional[float] = ..., clock_offset_ns: _Optional[int] = ..., clock_uncertainty_ns: _Optional[int] = ..., clock_rate: _Optional[float] = ..., state: _Optional[str] = ..., pedal_used: _Optional[bool] = ..., countdown_left: _Optional[float] = ..., takes_left: _Optional[int] = ..., pending_command: _Optional[str] = ..., missing: _Optional[_Iterable[_Union[SequenceRange, _Mapping[str, object]]]] = ..., late: _Optional[int] = ...) -> None: ...

class SequenceRange(_message.Message):
    __slots__ = ("first", "last")
    FIRST_FIELD_NUMBER: _ClassVar[int]
    LAST_FIELD_NUMBER: _ClassVar[int]
    first: int
    last: int
    def __init__(self, first: _Optional[int] = ..., last: _Optional[int] = ...) -> None: ...

class PauseRecording(_message.Message):
    __slots__ = ("tracker",)
    TRACKER_FIELD_NUMBER: _ClassVar[int]
    tracker: str
    def __init__(self, tracker: _Optional[str] = ...) -> None: ...

class PickDemonstration(_message.Message):
    __slots__ = ("tracker", "task")
    TRACKER_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    tracker: str
    task: str
    def __init__(self, tracker: _Optional[str] = ..., task: _Optional[str] = ...) -> None: ...

class AmendDemonstration(_message.Message):
    __slots__ = ("demonstration", "mark", "discarded", "trim")
    DEMONSTRATION_FIELD_NUMBER: _ClassVar[int]
    MARK_FIELD_NUMBER: _ClassVar[int]
    DISCARDED_FIELD_NUMBER: _ClassVar[int]
    TRIM_FIELD_NUMBER: _ClassVar[int]
    demonstration: str
    mark: str
    discarded: bool
    trim: Span
    def __init__(self, demonstration: _Optional[str] = ..., mark: _Optional[str] = ..., discarded: _Optional[bool] = ..., trim: _Optional[_Union[Span, _Mapping[str, object]]] = ...) -> None: ...

class Span(_message.Message):
    __slots__ = ("begin", "end")
    BEGIN_FIELD_NUMBER: _ClassVar[int]
    END_FIELD_NUMBER: _ClassVar[int]
    begin: int
    end: int
    def __init__(self, begin: _Optional[int] = ..., end: _Optional[int] = ...) -> None: ...

class DemonstrationReport(_message.Message):
    __slots__ = ("demonstration", "task", "number", "verdict", "reasons", "mark", "discarded", "transport", "advice")
    DEMONSTRATION_FIELD_NUMBER: _ClassVar[int]
    TASK_FIELD_NUMBER: _ClassVar[int]
    NUMBER_FIELD_NUMBER: _ClassVar[int]
    VERDICT_FIELD_NUMBER: _ClassVar[int]
    REASONS_FIELD_NUMBER: _ClassVar[int]
    MARK_FIELD_NUMBER: _ClassVar[int]
    DISCARDED_FIELD_NUMBER: _ClassVar[int]
    TRANSPORT_FIELD_NUMBER: _ClassVar[int]
    ADVICE_FIELD_NUMBER: _ClassVar[int]
    demonstration: str
    task: str
    number: int
    verdict: str
    reasons: _containers.RepeatedScalarFieldContainer[str]
    mark: str
    discarded: bool
    transport: Span
    advice: str
    def __init__(self, demonstration: _Optional[str] = ..., task: _Optional[str] = ..., number: _Optional[int] = ..., verdict: _Optional[str] = ..., reasons: _Optional[_Iterable[str]] = ..., mark: _Optional[str] = ..., discarded: _Optional[bool] = ..., transport: _Optional[_Union[Span, _Mapping[str, object]]] = ..., advice: _Optional[str] = ...) -> None: ...

class RecorderStatus(_message.Message):
    __slots__ = ("recordings",)
    RECORDINGS_FIELD_NUMBER: _ClassVar[int]
    recordings: _containers.RepeatedCompositeFieldContainer[RecordingReport]
    def __init__(self, recordings: _Optional[_Iterable[_Union[RecordingReport, _Mapping[str, object]]]] = ...) -> None: ...

class HandFeedback(_message.Message):
    __slots__ = ("task", "phase", "state", "holding", "countdown_left", "takes_left", "takes", "newest", "pending_command", "hint")
    TASK_FIELD_NUMBER: _ClassVar[int]
    PHASE_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    HOLDING_FIELD_NUMBER: _ClassVar[int]
    COUNTDOWN_LEFT_FIELD_NUMBER: _ClassVar[int]
    TAKES_LEFT_FIELD_NUMBER: _ClassVar[int]
    TAKES_FIELD_NUMBER: _ClassVar[int]
    NEWEST_FIELD_NUMBER: _ClassVar[int]
    PENDING_COMMAND_FIELD_NUMBER: _ClassVar[int]
    HINT_FIELD_NUMBER: _ClassVar[int]
    task: str
    phase: str
    state: str
    holding: bool
    countdown_left: float
    takes_left: int
    takes: int
    newest: DemonstrationReport
    pending_command: str
    hint: str
    def __init__(self, task: _Optional[str] = ..., phase: _Optional[str] = ..., state: _Optional[str] = ..., holding: _Optional[bool] = ..., countdown_left: _Optional[float] = ..., takes_left: _Optional[int] = ..., takes: _Optional[int] = ..., newest: _Optional[_Union[DemonstrationReport, _Mapping[str, object]]] = ..., pending_command: _Optional[str] = ..., hint: _Optional[str] = ...) -> None: ...
