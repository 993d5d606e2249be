"""Setpoints off the wire, and the joint state that a driver answers with."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from teachpath_client.driver.interpolation import Array
from teachpath_client.driver.player import PlayerState, SetpointPlayer
from teachpath_proto.motion_pb2 import JointState
from teachpath_proto.motion_pb2 import Setpoint as SetpointMessage

JOINT_COUNTS: Final = (6, 7)  # that an arm may have


@dataclass(frozen=True, eq=False)
class Setpoint:
    """One control period; joint arrays are (joints,) in rad, rad/s, rad/s^2, `way_to_rest` (n, 3, joints).

    `output` names the output that is on, as long as it is played (see `SetpointPlayer.output`); empty: none.
    """

    cycle: int
    nominal_ns: int
    position: Array
    velocity: Array
    acceleration: Array
    gripper_closed: bool
    execution: str
    way_to_rest: Array
    output: str = ""


def decode_setpoint(payload: bytes) -> Setpoint:
    """Read a setpoint.

    Raises:
        ValueError: it is malformed or not finite; a driver leaves it out.
    """
    try:
        m = SetpointMessage.FromString(payload)
        arrays = [np.array(values, dtype=np.float64) for values in (m.position, m.velocity, m.acceleration)]
        ways = (m.way_to_rest, m.way_to_rest_velocity, m.way_to_rest_acceleration)
        count = len(arrays[0])
        way = np.stack([np.frombuffer(rows, dtype="<f8").reshape(-1, count) for rows in ways], axis=1)
    except Exception as error:
        raise ValueError(f"no setpoint: {error}") from None
    fits = count in JOINT_COUNTS and all(len(array) == count for array in arrays)
    if not fits or not all(np.isfinite(array).all() for array in (*arrays, way)):
        raise ValueError(f"setpoint {m.cycle} needs {needed_joints(count)} finite numbers a joint array")
    position, velocity, acceleration = arrays
    return Setpoint(
        m.cycle, m.nominal_ns, position, velocity, acceleration, m.gripper_closed, m.execution, way, m.output
    )


def needed_joints(count: int) -> str:
    """Return how many joints an arm has, in words: as many as were given, where an arm may have so many."""
    return str(count) if count in JOINT_COUNTS else " or ".join(map(str, JOINT_COUNTS))


def joint_state(
    player: SetpointPlayer,
    position: Sequence[float],
    velocity: Sequence[float],
    *,
    enabled: bool = True,
    protective_stop: bool = False,
    fault: str = "",
    gripper_opening: float | None = None,
) -> bytes:
    """Return the joint state of an arm that plays setpoints and measures neither torques nor an object.

    Args:
        player: what it plays.
        position: (joints,) measured [rad].
        velocity: (joints,) measured [rad/s].
        enabled: whether the drives are on.
        protective_stop: whether the arm's own controller has stopped it.
        fault: what is wrong with the arm, in words; empty: nothing.
        gripper_opening: measured between the fingers [m], by which the executor sees that they hold nothing; None where
            the arm does not measure it.
    """
    newest = player.last_reached
    return JointState(
        stamp_ns=time.time_ns(),
        cycle=newest.cycle if newest else 0,
        execution=newest.execution if newest else "",
        position=position,
        velocity=velocity,
        torque=[0.0] * len(position),
        tracking_error=float(np.abs(player.target.position - np.asarray(position)).max()),
        missed=player.missed,
        late=player.late,
        holding=player.state in (PlayerState.STOPPING, PlayerState.STOPPED),
        stopped=player.state is PlayerState.STOPPED,
        enabled=enabled,
        protective_stop=protective_stop,
        fault=fault,
        gripper_opening=gripper_opening,
        output=player.output,
        gripper_closed=newest.gripper_closed if newest else False,
        object_position=[0.0] * 3,
        object_orientation=[0.0] * 4,
    ).SerializeToString()
