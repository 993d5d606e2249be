"""How plans are executed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le


@dataclass(frozen=True)
class ExecutorSettings:
    """How plans are executed."""

    # [Hz] setpoints a second
    rate: Annotated[float, Ge(125), Le(500)] = 250.0
    # [Hz] statuses a second while something is under way; 4 at most while nothing is
    status_rate: Annotated[float, Gt(0), Le(50)] = 10.0
    # [s] that the gripper takes to close or open
    dwell: Annotated[float, Ge(0), Le(10)] = 0.5
    # [s] without a joint state after which the arm is held
    silence: Annotated[float, Gt(0), Le(5)] = 0.2
    # [s] without a joint state after which the execution that was held for it ends as faulted
    silence_timeout: Annotated[float, Gt(0), Le(600)] = 10.0
    # [s] for which an arm that speaks may take up no setpoint before it is held; a driver plays them up to 0.05 s late
    setpoint_timeout: Annotated[float, Ge(0.1), Le(5)] = 0.5
    # [s] without a tracked sample after which a live hand is lost, or who presses its clutch
    hand_silence: Annotated[float, Gt(0), Le(5)] = 0.15
    # [s] within which a lost hand that is back where it was, or one whose arm was late, is followed again by itself
    hand_return_timeout: Annotated[float, Ge(0), Le(60)] = 1.0
    # the only scene in which a live hand leads the arm: the one that stands around it; empty: any that the station has
    hand_scene: str = ""
    # [rad] tracking error of a joint at which the execution is given up
    largest_error: Annotated[float, Gt(0), Le(0.5)] = 0.05
    # [rad/s] that the arm may still move when an execution starts or has ended
    rest_speed: Annotated[float, Gt(0), Le(0.5)] = 0.05
    # [s] from the last setpoint of a motion, in which the arm comes to rest; else its execution ends as faulted
    rest_timeout: Annotated[float, Gt(0), Le(30)] = 2.0
    # [rad] that the arm may be off its setpoint when a held execution goes on; farther off it is brought back first
    regain: Annotated[float, Gt(0), Le(0.5)] = 0.02
    # [rad] that a joint may move while nothing is under way; farther is reported, and nothing starts before somebody
    # acknowledges it
    unasked_motion: Annotated[float, Gt(0), Le(0.5)] = 0.02
    # what a gripper ends in that is measured to close on nothing, or to lose its object: `fault`, or `hold`, where
    # resume goes on as it is
    failed_grasp: Literal["fault", "hold"] = "fault"
    # whether to ask for real-time scheduling; nice -10 where it is refused
    realtime: bool = True
