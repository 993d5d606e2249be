"""What an arm was sent in an execution, at even instants."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from teachpath.errors import UnusableRecording
from teachpath.records import SampledMotion, Setpoint

MIN_SETPOINTS = 4


def sample_setpoints(
    setpoints: Sequence[Setpoint], rate: float, name: str, notes: tuple[str, ...], joint_names: tuple[str, ...]
) -> SampledMotion:
    """Return the motion through recorded setpoints, at `rate` instants a second [Hz].

    At the instants of setpoints the joints and their speeds are those of the setpoints.

    Args:
        setpoints: in the order in which they were sent.
        rate: instants a second [Hz].
        name: of the execution.
        notes: what a reader must know of it.
        joint_names: of the arm that was sent them.

    Raises:
        UnusableRecording: there are hardly any setpoints.
    """
    if len(setpoints) < MIN_SETPOINTS:
        raise UnusableRecording(
            f"{name} has {len(setpoints)} recorded setpoints, needs {MIN_SETPOINTS}; it was stopped before it moved"
        )
    begin_ns = setpoints[0].nominal_ns
    due, first = np.unique([(s.nominal_ns - begin_ns) / 1e9 for s in setpoints], return_index=True)
    rows = [setpoints[i] for i in first]
    path = scipy.interpolate.CubicHermiteSpline(
        due, np.array([s.position for s in rows]), np.array([s.velocity for s in rows])
    )
    count = int(np.ceil(float(due[-1]) * rate)) + 1
    times = np.arange(count) / rate
    at = np.minimum(times, due[-1])
    commanded = np.array([s.acceleration for s in rows])
    accelerations = np.column_stack([np.interp(at, due, joint) for joint in commanded.T])
    return SampledMotion(name, begin_ns, notes, joint_names, rate, times, path(at), path(at, 1), accelerations)


def recorded_duration(setpoints: Sequence[Setpoint]) -> float:
    """Return the time from the first setpoint to the last [s]."""
    return (setpoints[-1].nominal_ns - setpoints[0].nominal_ns) / 1e9 if setpoints else 0.0
