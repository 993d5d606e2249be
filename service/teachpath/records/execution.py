"""An execution as it runs: setpoints, joint states, and the executor's status."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from teachpath.records.arrays import Array, Quaternion, Vector
from teachpath_proto.control import ExecutorState


@dataclass(frozen=True, eq=False)
class Setpoint:
    """What the arm should do in one control period; joint arrays are (joints,) in rad, rad/s, rad/s^2.

    `output` names the output of the arm that is on; empty: none is.
    """

    cycle: int
    nominal_ns: int
    sent_ns: int
    position: Array
    velocity: Array
    acceleration: Array
    gripper_closed: bool
    execution: str
    on_path: bool = False
    # (n, 3, joints) position, velocity, acceleration, one control period apart, the first one period behind this
    # setpoint; checked against all limits
    way_to_rest: Array = field(default_factory=lambda: np.empty((0, 3, 6)))
    from_rest: bool = (
        False  # the motion begins anew, where the arm rests: what was sent before was not played to its end
    )
    output: str = ""


@dataclass(frozen=True, eq=False)
class JointState:
    """What the arm does; joint arrays are (joints,), `tracking_error` is the largest over the joints [rad].

    An arm that is `holding` follows the way to rest of setpoint `cycle`; once it is `stopped`, it rests at its end.

    Attributes:
        enabled: whether the drives are on.
        protective_stop: whether the arm's own controller has stopped it.
        fault: what is wrong with the arm, in words; empty: nothing.
        gripper_opening: measured between the fingers [m]; None where the arm does not measure it.
        output: name of the output that is on; empty: none is.
    """

    stamp_ns: int
    cycle: int
    position: Array
    velocity: Array
    torque: Array
    tracking_error: float
    missed: int
    holding: bool
    gripper_closed: bool
    object_position: Vector
    object_orientation: Quaternion
    execution: str = ""
    late: int = 0
    stopped: bool = False
    enabled: bool = True
    protective_stop: bool = False
    fault: str = ""
    gripper_opening: float | None = None
    output: str = ""

    @property
    def inability(self) -> str:
        """Why the arm can follow no setpoint, and the way out, in words; empty when it can."""
        if self.fault:
            return f"the arm reports a fault: {self.fault}; clear it at the arm"
        if self.protective_stop:
            return "the arm's own controller has stopped it (protective stop): see why, and release it at the arm"
        return "" if self.enabled else "the arm's drives are off: switch them on at the arm"


@dataclass(frozen=True, slots=True)
class ExecutorStatus:
    """Where an execution stands; see teachpath/v1/motion.proto for the fields.

    Attributes:
        execution: id of the newest execution; empty: there was none.
        state: what it does: idle, approaching, following, held, stopping, ended or faulted.
        reason: why it is held, stopped or faulted, in words; empty otherwise.
        progress: share of the path's length, 0 to 1.
        override: share of the planned speed that is asked for, 0 to 1.
        cycles: control periods of the loop so far.
        late: cycles that woke later than half a period.
        missed: cycles left out because the one before took too long.
        lateness_p50_us: median lateness of a cycle [us].
        lateness_p99_us: 99th percentile of the lateness of a cycle [us].
        lateness_max_us: largest lateness of a cycle [us].
        limit_use: largest share of a joint limit used by the setpoints sent.
        tracking_error: farthest that the arm was off its setpoints, or by its own account off what it wanted [rad].
        limit_place: where limit_use was reached, in words.
        duration: from the first setpoint to the newest [s].
        length: how far along the path the tool is [m].
        activity: what the arm does, in words, e.g. on the path, closing the gripper.
        operator: who holds control; empty: nobody.
        asking: who asks for control; empty: nobody.
        scheduling: whether the loop runs before all other processes, in words.
        hand_latency_p50_us: with a live hand, median from a sample's coming to the setpoint that answers it [us].
        hand_latency_p99_us: with a live hand, 99th percentile of the same [us].
        ending: whether it is over as soon as the arm rests, because it was stopped or given up.
        unasked_motion: that the arm moves although nothing is under way, in words; nothing starts before somebody
            acknowledges it.
        hand: the tracker whose live hand is followed; empty: a plan is.
        hand_scene: the scene in which it is followed.
        hindrance: what keeps the tool from where the hand is, in words; empty: nothing.
        awaits_clutch: whether the arm rests until the clutch is pressed, and nothing else keeps it.
    """

    execution: str = ""
    state: ExecutorState = ExecutorState.IDLE
    reason: str = ""
    progress: float = 0.0
    override: float = 1.0
    cycles: int = 0
    late: int = 0
    missed: int = 0
    lateness_p50_us: float = 0.0
    lateness_p99_us: float = 0.0
    lateness_max_us: float = 0.0
    limit_use: float = 0.0
    tracking_error: float = 0.0
    limit_place: str = ""
    duration: float = 0.0
    length: float = 0.0
    activity: str = ""
    operator: str = ""
    asking: str = ""
    scheduling: str = ""
    hand_latency_p50_us: float = 0.0
    hand_latency_p99_us: float = 0.0
    ending: bool = False
    unasked_motion: str = ""
    hand: str = ""
    hand_scene: str = ""
    hindrance: str = ""
    awaits_clutch: bool = False
