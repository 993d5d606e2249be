"""Work on whole recordings, as functions that can be called in another process.

A long recording has hundreds of thousands of samples; while one process reads it, its other threads are slow to answer.
So the service passes a `Call` that does the work in a process of its own; tools without a service call it directly.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from teachpath.io.documents import encode
from teachpath.io.store.recordings import Recordings
from teachpath.recorder.take_completion import reassess
from teachpath.recording.demonstration import object_trajectory, point_to_world
from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Demonstration, Trajectory, Vector

# `call(function, *arguments)` returns what the function returns; function and arguments can be pickled.
Call = Callable[..., Any]


def call_directly(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function in this process, on this thread."""
    return function(*arguments)


def read_trajectory(recordings: Recordings, demonstration: Demonstration, carried: Vector | None) -> Trajectory:
    """Return the object's trajectory of a demonstration.

    Args:
        carried: start of the object's centre [m, world], or None.

    Raises:
        NotFound: its recording is missing.
        UnusableRecording: its recording is damaged.
    """
    return object_trajectory(
        recordings.columns(demonstration.recording, demonstration.digest),
        TransportSpan(*demonstration.transport),
        demonstration.calibration,
        carried,
        left_out=demonstration.left_out,
    )


def encode_trajectory(
    recordings: Recordings,
    demonstration: Demonstration,
    carried: Vector | None,
    max_points: int,
    decimals: int | None = None,
) -> bytes:
    """Return the JSON of a trajectory with at most so many points and decimals; as `read_trajectory`."""
    trajectory = read_trajectory(recordings, demonstration, carried).thinned(max_points)
    return encode(trajectory if decimals is None else trajectory.rounded(decimals))


def reassess_recording(
    recordings: Recordings,
    settings: RecordingSettings,
    before: Demonstration,
    after: Demonstration,
    carried: Vector | None,
    object_at_grasp: bool = False,
) -> dict[str, Any]:
    """Return what else changes in the row of a demonstration whose calibration or trim changes: quality, duration.

    Args:
        before: as it is stored.
        after: as it will be.
        carried: start of the object's centre [m, world], or None.
        object_at_grasp: the object lies where the hand grasps.
    """
    samples = recordings.columns(before.recording, before.digest)
    changes = reassess(before, after, samples, settings)
    span, left_out = TransportSpan(*after.transport), changes["left_out"]
    if object_at_grasp and before.object_pose is not None:
        carried = point_to_world(after.calibration)(samples[span.grasp].position)
        changes["object_pose"] = replace(before.object_pose, position=carried)
    trajectory = object_trajectory(samples, span, after.calibration, carried, left_out=left_out)
    return {**changes, "duration": float(trajectory.times[-1])}
