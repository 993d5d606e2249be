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
    __slots__ = ("sequence", "device_ns", "position", "orientation", "flexions", "tracked", "buttons")
    SEQUENCE_FIELD_NUMBER: _ClassVar[int]
    DEVICE_NS_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    ORIENTATION_FIELD_NUMBER: _ClassVar[int]
    FLEXIONS_FIELD_NUMBER: _ClassVar[int]
    TRACKED_FIELD_NUMBER: _ClassVar[int]
    BUTTONS_FIELD_NUMBER: _ClassVar[int]
    sequence: int
    device_ns: int
    position: Vector3
    orientation: Quaternion
    flexions: _containers.RepeatedScalarFieldContainer[float]
    tracked: bool
    buttons: int
    def __init__(self, sequence: _Optional[int] = ..., device_ns: _Optional[int] = ..., position: _Optional[_Union[Vector3, _Mapping]] = ..., orientation: _Optional[_Union[Quaternion, _Mapping]] = ..., flexions: _Optional[_Iterable[float]] = ..., tracked: _Optional[bool] = ..., buttons: _Optional[int] = ...) -> None: ...

class StartRecording(_message.Message):
    __slots__ = ("task", "tracker", "calibration", "scene")
    TASK_FIELD_NUMBER: _ClassVar[int]
    TRACKER_FIELD_NUMBER: _ClassVar[int]
    CALIBRATION_FIELD_NUMBER: _ClassVar[int]
    SCENE_FIELD_NUMBER: _ClassVar[int]
    task: str
    tracker: str
    calibration: str
    scene: str
    def __init__(self, task: _Optional[str] = ..., tracker: _Optional[str] = ..., calibration: _Optional[str] = ..., scene: _Optional[str] = ...) -> None: ...

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
    __slots__ = ("task", "tracker", "demonstrations", "received", "lost", "duplicated", "reordered", "refused", "untracked", "longest_gap_ns", "notes", "phase", "idle")
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
    def __init__(self, task: _Optional[str] = ..., tracker: _Optional[str] = ..., demonstrations: _Optional[_Iterable[str]] = ..., received: _Optional[int] = ..., lost: _Optional[int] = ..., duplicated: _Optional[int] = ..., reordered: _Optional[int] = ..., refused: _Optional[int] = ..., untracked: _Optional[int] = ..., longest_gap_ns: _Optional[int] = ..., notes: _Optional[_Iterable[str]] = ..., phase: _Optional[str] = ..., idle: _Optional[int] = ...) -> None: ...

class RecorderStatus(_message.Message):
    __slots__ = ("recordings",)
    RECORDINGS_FIELD_NUMBER: _ClassVar[int]
    recordings: _containers.RepeatedCompositeFieldContainer[RecordingReport]
    def __init__(self, recordings: _Optional[_Iterable[_Union[RecordingReport, _Mapping]]] = ...) -> None: ...
