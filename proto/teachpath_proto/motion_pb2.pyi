from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Setpoint(_message.Message):
    __slots__ = ("cycle", "nominal_ns", "sent_ns", "position", "velocity", "acceleration", "gripper_closed", "execution", "on_path", "way_to_rest", "way_to_rest_velocity", "way_to_rest_acceleration", "from_rest", "output")
    CYCLE_FIELD_NUMBER: _ClassVar[int]
    NOMINAL_NS_FIELD_NUMBER: _ClassVar[int]
    SENT_NS_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_CLOSED_FIELD_NUMBER: _ClassVar[int]
    EXECUTION_FIELD_NUMBER: _ClassVar[int]
    ON_PATH_FIELD_NUMBER: _ClassVar[int]
    WAY_TO_REST_FIELD_NUMBER: _ClassVar[int]
    WAY_TO_REST_VELOCITY_FIELD_NUMBER: _ClassVar[int]
    WAY_TO_REST_ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    FROM_REST_FIELD_NUMBER: _ClassVar[int]
    OUTPUT_FIELD_NUMBER: _ClassVar[int]
    cycle: int
    nominal_ns: int
    sent_ns: int
    position: _containers.RepeatedScalarFieldContainer[float]
    velocity: _containers.RepeatedScalarFieldContainer[float]
    acceleration: _containers.RepeatedScalarFieldContainer[float]
    gripper_closed: bool
    execution: str
    on_path: bool
    way_to_rest: bytes
    way_to_rest_velocity: bytes
    way_to_rest_acceleration: bytes
    from_rest: bool
    output: str
    def __init__(self, cycle: _Optional[int] = ..., nominal_ns: _Optional[int] = ..., sent_ns: _Optional[int] = ..., position: _Optional[_Iterable[float]] = ..., velocity: _Optional[_Iterable[float]] = ..., acceleration: _Optional[_Iterable[float]] = ..., gripper_closed: _Optional[bool] = ..., execution: _Optional[str] = ..., on_path: _Optional[bool] = ..., way_to_rest: _Optional[bytes] = ..., way_to_rest_velocity: _Optional[bytes] = ..., way_to_rest_acceleration: _Optional[bytes] = ..., from_rest: _Optional[bool] = ..., output: _Optional[str] = ...) -> None: ...

class JointState(_message.Message):
    __slots__ = ("stamp_ns", "cycle", "position", "velocity", "torque", "tracking_error", "missed", "holding", "gripper_closed", "object_position", "object_orientation", "execution", "late", "stopped", "enabled", "protective_stop", "fault", "gripper_opening", "output")
    STAMP_NS_FIELD_NUMBER: _ClassVar[int]
    CYCLE_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    TORQUE_FIELD_NUMBER: _ClassVar[int]
    TRACKING_ERROR_FIELD_NUMBER: _ClassVar[int]
    MISSED_FIELD_NUMBER: _ClassVar[int]
    HOLDING_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_CLOSED_FIELD_NUMBER: _ClassVar[int]
    OBJECT_POSITION_FIELD_NUMBER: _ClassVar[int]
    OBJECT_ORIENTATION_FIELD_NUMBER: _ClassVar[int]
    EXECUTION_FIELD_NUMBER: _ClassVar[int]
    LATE_FIELD_NUMBER: _ClassVar[int]
    STOPPED_FIELD_NUMBER: _ClassVar[int]
    ENABLED_FIELD_NUMBER: _ClassVar[int]
    PROTECTIVE_STOP_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    GRIPPER_OPENING_FIELD_NUMBER: _ClassVar[int]
    OUTPUT_FIELD_NUMBER: _ClassVar[int]
    stamp_ns: int
    cycle: int
    position: _containers.RepeatedScalarFieldContainer[float]
    velocity: _containers.RepeatedScalarFieldContainer[float]
    torque: _containers.RepeatedScalarFieldContainer[float]
    tracking_error: float
    missed: int
    holding: bool
    gripper_closed: bool
    object_position: _containers.RepeatedScalarFieldContainer[float]
    object_orientation: _containers.RepeatedScalarFieldContainer[float]
    execution: str
    late: int
    stopped: bool
    enabled: bool
    protective_stop: bool
    fault: str
    gripper_opening: float
    output: str
    def __init__(self, stamp_ns: _Optional[int] = ..., cycle: _Optional[int] = ..., position: _Optional[_Iterable[float]] = ..., velocity: _Optional[_Iterable[float]] = ..., torque: _Optional[_Iterable[float]] = ..., tracking_error: _Optional[float] = ..., missed: _Optional[int] = ..., holding: _Optional[bool] = ..., gripper_closed: _Optional[bool] = ..., object_position: _Optional[_Iterable[float]] = ..., object_orientation: _Optional[_Iterable[float]] = ..., execution: _Optional[str] = ..., late: _Optional[int] = ..., stopped: _Optional[bool] = ..., enabled: _Optional[bool] = ..., protective_stop: _Optional[bool] = ..., fault: _Optional[str] = ..., gripper_opening: _Optional[float] = ..., output: _Optional[str] = ...) -> None: ...

class ExecutorCommand(_message.Message):
    __slots__ = ("verb", "execution", "plan", "override", "length", "nodes", "lease", "who", "plan_id", "reason", "teleop", "id")
    class Verb(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        VERB_UNSPECIFIED: _ClassVar[ExecutorCommand.Verb]
        VERB_START: _ClassVar[ExecutorCommand.Verb]
        VERB_OVERRIDE: _ClassVar[ExecutorCommand.Verb]
        VERB_HOLD: _ClassVar[ExecutorCommand.Verb]
        VERB_RESUME: _ClassVar[ExecutorCommand.Verb]
        VERB_STOP: _ClassVar[ExecutorCommand.Verb]
        VERB_REVERSE: _ClassVar[ExecutorCommand.Verb]
        VERB_STEP: _ClassVar[ExecutorCommand.Verb]
        VERB_REVOKE: _ClassVar[ExecutorCommand.Verb]
        VERB_TELEOPERATE: _ClassVar[ExecutorCommand.Verb]
        VERB_ACKNOWLEDGE: _ClassVar[ExecutorCommand.Verb]
    VERB_UNSPECIFIED: ExecutorCommand.Verb
    VERB_START: ExecutorCommand.Verb
    VERB_OVERRIDE: ExecutorCommand.Verb
    VERB_HOLD: ExecutorCommand.Verb
    VERB_RESUME: ExecutorCommand.Verb
    VERB_STOP: ExecutorCommand.Verb
    VERB_REVERSE: ExecutorCommand.Verb
    VERB_STEP: ExecutorCommand.Verb
    VERB_REVOKE: ExecutorCommand.Verb
    VERB_TELEOPERATE: ExecutorCommand.Verb
    VERB_ACKNOWLEDGE: ExecutorCommand.Verb
    VERB_FIELD_NUMBER: _ClassVar[int]
    EXECUTION_FIELD_NUMBER: _ClassVar[int]
    PLAN_FIELD_NUMBER: _ClassVar[int]
    OVERRIDE_FIELD_NUMBER: _ClassVar[int]
    LENGTH_FIELD_NUMBER: _ClassVar[int]
    NODES_FIELD_NUMBER: _ClassVar[int]
    LEASE_FIELD_NUMBER: _ClassVar[int]
    WHO_FIELD_NUMBER: _ClassVar[int]
    PLAN_ID_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    TELEOP_FIELD_NUMBER: _ClassVar[int]
    ID_FIELD_NUMBER: _ClassVar[int]
    verb: ExecutorCommand.Verb
    execution: str
    plan: bytes
    override: float
    length: float
    nodes: int
    lease: str
    who: str
    plan_id: str
    reason: str
    teleop: bytes
    id: str
    def __init__(self, verb: _Optional[_Union[ExecutorCommand.Verb, str]] = ..., execution: _Optional[str] = ..., plan: _Optional[bytes] = ..., override: _Optional[float] = ..., length: _Optional[float] = ..., nodes: _Optional[int] = ..., lease: _Optional[str] = ..., who: _Optional[str] = ..., plan_id: _Optional[str] = ..., reason: _Optional[str] = ..., teleop: _Optional[bytes] = ..., id: _Optional[str] = ...) -> None: ...

class LeaseRequest(_message.Message):
    __slots__ = ("action", "name", "token", "seconds", "hold_when_lost")
    class Action(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
        __slots__ = ()
        ACTION_UNSPECIFIED: _ClassVar[LeaseRequest.Action]
        ACTION_ACQUIRE: _ClassVar[LeaseRequest.Action]
        ACTION_BEAT: _ClassVar[LeaseRequest.Action]
        ACTION_RELEASE: _ClassVar[LeaseRequest.Action]
        ACTION_ASK: _ClassVar[LeaseRequest.Action]
        ACTION_KEEP: _ClassVar[LeaseRequest.Action]
    ACTION_UNSPECIFIED: LeaseRequest.Action
    ACTION_ACQUIRE: LeaseRequest.Action
    ACTION_BEAT: LeaseRequest.Action
    ACTION_RELEASE: LeaseRequest.Action
    ACTION_ASK: LeaseRequest.Action
    ACTION_KEEP: LeaseRequest.Action
    ACTION_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    TOKEN_FIELD_NUMBER: _ClassVar[int]
    SECONDS_FIELD_NUMBER: _ClassVar[int]
    HOLD_WHEN_LOST_FIELD_NUMBER: _ClassVar[int]
    action: LeaseRequest.Action
    name: str
    token: str
    seconds: float
    hold_when_lost: bool
    def __init__(self, action: _Optional[_Union[LeaseRequest.Action, str]] = ..., name: _Optional[str] = ..., token: _Optional[str] = ..., seconds: _Optional[float] = ..., hold_when_lost: _Optional[bool] = ...) -> None: ...

class Lease(_message.Message):
    __slots__ = ("holder", "expires_in", "hold_when_lost", "asking", "granted_in", "token")
    HOLDER_FIELD_NUMBER: _ClassVar[int]
    EXPIRES_IN_FIELD_NUMBER: _ClassVar[int]
    HOLD_WHEN_LOST_FIELD_NUMBER: _ClassVar[int]
    ASKING_FIELD_NUMBER: _ClassVar[int]
    GRANTED_IN_FIELD_NUMBER: _ClassVar[int]
    TOKEN_FIELD_NUMBER: _ClassVar[int]
    holder: str
    expires_in: float
    hold_when_lost: bool
    asking: str
    granted_in: float
    token: str
    def __init__(self, holder: _Optional[str] = ..., expires_in: _Optional[float] = ..., hold_when_lost: _Optional[bool] = ..., asking: _Optional[str] = ..., granted_in: _Optional[float] = ..., token: _Optional[str] = ...) -> None: ...

class JournalEntry(_message.Message):
    __slots__ = ("at_ns", "who", "verb", "execution", "answer")
    AT_NS_FIELD_NUMBER: _ClassVar[int]
    WHO_FIELD_NUMBER: _ClassVar[int]
    VERB_FIELD_NUMBER: _ClassVar[int]
    EXECUTION_FIELD_NUMBER: _ClassVar[int]
    ANSWER_FIELD_NUMBER: _ClassVar[int]
    at_ns: int
    who: str
    verb: str
    execution: str
    answer: str
    def __init__(self, at_ns: _Optional[int] = ..., who: _Optional[str] = ..., verb: _Optional[str] = ..., execution: _Optional[str] = ..., answer: _Optional[str] = ...) -> None: ...

class ExecutorStatus(_message.Message):
    __slots__ = ("execution", "state", "reason", "progress", "override", "cycles", "late", "missed", "lateness_p50_us", "lateness_p99_us", "lateness_max_us", "limit_use", "tracking_error", "limit_place", "duration", "length", "activity", "operator", "asking", "hand_latency_p50_us", "hand_latency_p99_us", "scheduling", "ending", "unasked_motion", "hand", "hand_scene", "hindrance", "awaits_clutch")
    EXECUTION_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    PROGRESS_FIELD_NUMBER: _ClassVar[int]
    OVERRIDE_FIELD_NUMBER: _ClassVar[int]
    CYCLES_FIELD_NUMBER: _ClassVar[int]
    LATE_FIELD_NUMBER: _ClassVar[int]
    MISSED_FIELD_NUMBER: _ClassVar[int]
    LATENESS_P50_US_FIELD_NUMBER: _ClassVar[int]
    LATENESS_P99_US_FIELD_NUMBER: _ClassVar[int]
    LATENESS_MAX_US_FIELD_NUMBER: _ClassVar[int]
    LIMIT_USE_FIELD_NUMBER: _ClassVar[int]
    TRACKING_ERROR_FIELD_NUMBER: _ClassVar[int]
    LIMIT_PLACE_FIELD_NUMBER: _ClassVar[int]
    DURATION_FIELD_NUMBER: _ClassVar[int]
    LENGTH_FIELD_NUMBER: _ClassVar[int]
    ACTIVITY_FIELD_NUMBER: _ClassVar[int]
    OPERATOR_FIELD_NUMBER: _ClassVar[int]
    ASKING_FIELD_NUMBER: _ClassVar[int]
    HAND_LATENCY_P50_US_FIELD_NUMBER: _ClassVar[int]
    HAND_LATENCY_P99_US_FIELD_NUMBER: _ClassVar[int]
    SCHEDULING_FIELD_NUMBER: _ClassVar[int]
    ENDING_FIELD_NUMBER: _ClassVar[int]
    UNASKED_MOTION_FIELD_NUMBER: _ClassVar[int]
    HAND_FIELD_NUMBER: _ClassVar[int]
    HAND_SCENE_FIELD_NUMBER: _ClassVar[int]
    HINDRANCE_FIELD_NUMBER: _ClassVar[int]
    AWAITS_CLUTCH_FIELD_NUMBER: _ClassVar[int]
    execution: str
    state: str
    reason: str
    progress: float
    override: float
    cycles: int
    late: int
    missed: int
    lateness_p50_us: float
    lateness_p99_us: float
    lateness_max_us: float
    limit_use: float
    tracking_error: float
    limit_place: str
    duration: float
    length: float
    activity: str
    operator: str
    asking: str
    hand_latency_p50_us: float
    hand_latency_p99_us: float
    scheduling: str
    ending: bool
    unasked_motion: str
    hand: str
    hand_scene: str
    hindrance: str
    awaits_clutch: bool
    def __init__(self, execution: _Optional[str] = ..., state: _Optional[str] = ..., reason: _Optional[str] = ..., progress: _Optional[float] = ..., override: _Optional[float] = ..., cycles: _Optional[int] = ..., late: _Optional[int] = ..., missed: _Optional[int] = ..., lateness_p50_us: _Optional[float] = ..., lateness_p99_us: _Optional[float] = ..., lateness_max_us: _Optional[float] = ..., limit_use: _Optional[float] = ..., tracking_error: _Optional[float] = ..., limit_place: _Optional[str] = ..., duration: _Optional[float] = ..., length: _Optional[float] = ..., activity: _Optional[str] = ..., operator: _Optional[str] = ..., asking: _Optional[str] = ..., hand_latency_p50_us: _Optional[float] = ..., hand_latency_p99_us: _Optional[float] = ..., scheduling: _Optional[str] = ..., ending: _Optional[bool] = ..., unasked_motion: _Optional[str] = ..., hand: _Optional[str] = ..., hand_scene: _Optional[str] = ..., hindrance: _Optional[str] = ..., awaits_clutch: _Optional[bool] = ...) -> None: ...
