"""Setpoints, joint states and statuses, with every value checked on the way in."""

from __future__ import annotations

from collections.abc import Iterable, Sized
from typing import Final

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.wire.parsing import parse
from teachpath.records import Array, ExecutorStatus, JointState, Setpoint
from teachpath_proto import motion_pb2
from teachpath_proto.control import ExecutorState

JOINT_COUNTS: Final = (6, 7)  # that an arm may have
_WAY_FIELDS: Final = ("way_to_rest", "way_to_rest_velocity", "way_to_rest_acceleration")
MAX_STATE_SIZE: Final = 16_384  # bytes
MAX_OUTPUT_LENGTH: Final = 64  # characters of the name of an output
MAX_FAULT_LENGTH: Final = 300  # characters of a fault, which everybody is shown


def encode_setpoint(setpoint: Setpoint) -> bytes:
    """Return a setpoint's message."""
    return motion_pb2.Setpoint(
        cycle=setpoint.cycle,
        nominal_ns=setpoint.nominal_ns,
        sent_ns=setpoint.sent_ns,
        position=setpoint.position.tolist(),
        velocity=setpoint.velocity.tolist(),
        acceleration=setpoint.acceleration.tolist(),
        gripper_closed=setpoint.gripper_closed,
        execution=setpoint.execution,
        on_path=setpoint.on_path,
        from_rest=setpoint.from_rest,
        output=setpoint.output,
        **dict(zip(_WAY_FIELDS, (_packed(rows) for rows in np.moveaxis(setpoint.way_to_rest, 1, 0)), strict=True)),
    ).SerializeToString()


def decode_setpoint(payload: bytes) -> Setpoint:
    """Check a setpoint; raises UnusableInput when it is malformed or not finite."""
    m = parse(motion_pb2.Setpoint, payload)
    where, count = f"setpoint {m.cycle}", _joint_count(m.position)
    return Setpoint(
        cycle=m.cycle,
        nominal_ns=m.nominal_ns,
        sent_ns=m.sent_ns,
        position=_joints(m.position, count, where),
        velocity=_joints(m.velocity, count, where),
        acceleration=_joints(m.acceleration, count, where),
        gripper_closed=m.gripper_closed,
        execution=m.execution,
        on_path=m.on_path,
        way_to_rest=_way(m, count, where),
        from_rest=m.from_rest,
        output=m.output,
    )


def without_way_to_rest(payload: bytes) -> bytes:
    """Return a setpoint's message as it is kept: without its way to rest, which is a hundred times its size.

    Raises:
        UnusableInput: it is malformed.
    """
    message = parse(motion_pb2.Setpoint, payload)
    for name in _WAY_FIELDS:
        message.ClearField(name)
    return message.SerializeToString()


def encode_state(state: JointState) -> bytes:
    """Return a joint state's message."""
    return motion_pb2.JointState(
        stamp_ns=state.stamp_ns,
        cycle=state.cycle,
        position=state.position.tolist(),
        velocity=state.velocity.tolist(),
        torque=state.torque.tolist(),
        tracking_error=state.tracking_error,
        missed=state.missed,
        holding=state.holding,
        gripper_closed=state.gripper_closed,
        object_position=state.object_position,
        object_orientation=state.object_orientation,
        execution=state.execution,
        late=state.late,
        stopped=state.stopped,
        enabled=state.enabled,
        protective_stop=state.protective_stop,
        fault=state.fault,
        gripper_opening=state.gripper_opening,
        output=state.output,
    ).SerializeToString()


def decode_state(payload: bytes) -> JointState:
    """Check a joint state; raises UnusableInput when it is malformed, too large or not finite."""
    if len(payload) > MAX_STATE_SIZE:
        raise UnusableInput(f"a joint state of {len(payload)} bytes is over the limit of {MAX_STATE_SIZE}")
    m = parse(motion_pb2.JointState, payload)
    where, count = f"joint state after setpoint {m.cycle}", _joint_count(m.position)
    if len(m.object_position) != 3 or len(m.object_orientation) != 4:
        raise UnusableInput("joint state: the object needs a position of 3 numbers and an orientation of 4")
    x, y, z = m.object_position
    w, i, j, k = m.object_orientation
    return JointState(
        stamp_ns=m.stamp_ns,
        cycle=m.cycle,
        position=_joints(m.position, count, where),
        velocity=_joints(m.velocity, count, where),
        torque=_joints(m.torque, count, where),
        tracking_error=m.tracking_error,
        missed=m.missed,
        holding=m.holding,
        gripper_closed=m.gripper_closed,
        object_position=(x, y, z),
        object_orientation=(w, i, j, k),
        execution=m.execution,
        late=m.late,
        stopped=m.stopped,
        enabled=m.enabled,
        protective_stop=m.protective_stop,
        fault="".join(filter(str.isprintable, m.fault))[:MAX_FAULT_LENGTH],
        gripper_opening=m.gripper_opening if m.HasField("gripper_opening") else None,
        output="".join(filter(str.isprintable, m.output))[:MAX_OUTPUT_LENGTH],
    )


def _joint_count(positions: Sized) -> int:
    """Return how many numbers each of a message's joint arrays needs: as many as its positions, as an arm has them."""
    return min(max(len(positions), JOINT_COUNTS[0]), JOINT_COUNTS[-1])


def _joints(values: Iterable[float], count: int, where: str) -> Array:
    joints = np.array(list(values), dtype=np.float64)
    if joints.shape != (count,) or not np.all(np.isfinite(joints)):
        given = f"{len(joints)} numbers" if len(joints) != count else joints.tolist()
        raise UnusableInput(f"{where}: needs {count} finite numbers a joint array, got {given}")
    return joints


def _packed(rows: Array) -> bytes:
    return np.ascontiguousarray(rows, dtype="<f8").tobytes()


def _way(message: motion_pb2.Setpoint, count: int, where: str) -> Array:
    contents = [getattr(message, name) for name in _WAY_FIELDS]
    sizes = [len(content) for content in contents]
    if sizes[0] % (8 * count) or len(set(sizes)) > 1:
        raise UnusableInput(
            f"{where}: positions, velocities and accelerations of its way to rest have {sizes} bytes; each needs "
            f"{8 * count} ({count} 64-bit floats) a row, and all as many rows"
        )
    way = np.stack([np.frombuffer(content, dtype="<f8").reshape(-1, count) for content in contents], axis=1)
    if not np.all(np.isfinite(way)):
        raise UnusableInput(f"{where}: its way to rest is not finite")
    return way


def encode_status(status: ExecutorStatus) -> bytes:
    """Return the message of an executor's status."""
    fields = {name: getattr(status, name) for name in ExecutorStatus.__dataclass_fields__}
    return motion_pb2.ExecutorStatus(**fields).SerializeToString()


def decode_status(payload: bytes) -> ExecutorStatus:
    """Return the executor's status; raises UnusableInput when malformed."""
    m = parse(motion_pb2.ExecutorStatus, payload)
    try:
        state = ExecutorState(m.state)
    except ValueError:
        raise UnusableInput(f"executor status: state {m.state!r} is none of {', '.join(ExecutorState)}") from None
    return ExecutorStatus(**{name: getattr(m, name) for name in ExecutorStatus.__dataclass_fields__} | {"state": state})
