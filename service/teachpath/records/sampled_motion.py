"""A motion of the joints at even instants, as other programs take it."""

from __future__ import annotations

from dataclasses import dataclass

from teachpath.records.arrays import Array, Matrix


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """The motion of an arm at even instants, from rest to rest.

    Attributes:
        name: id of the plan or the execution.
        stamp_ns: when it was planned, or began [ns since the Unix epoch].
        notes: what a reader must know of it, one sentence each: arm, limits, certificate, and what it does not cover.
        joint_names: in the order of the columns, as the arm calls them.
        rate: instants a second [Hz].
        times: (n,) [s], from 0.
        positions: (n, joints) of the joints [rad].
        velocities: (n, joints) [rad/s].
        accelerations: (n, joints) [rad/s^2].
    """

    name: str
    stamp_ns: int
    notes: tuple[str, ...]
    joint_names: tuple[str, ...]
    rate: float
    times: Array
    positions: Matrix
    velocities: Matrix
    accelerations: Matrix
