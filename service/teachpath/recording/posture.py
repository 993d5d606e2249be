"""The joints of an arm that showed a task, along the way that the object was carried."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

import numpy as np

from teachpath.recording.demonstration import transport_samples
from teachpath.recording.phases import TransportSpan
from teachpath.records import Array, Sample, SampleColumns

COUNT: Final = 101  # configurations that are kept of a demonstration


def joint_count(carried: SampleColumns) -> int:
    """Return how many joints of an arm each of some samples has; 0 where one has none: a hand showed it."""
    return 0 if np.isnan(carried.joints).any() else carried.joints.shape[1]


def shown_joints(samples: Sequence[Sample], cut: TransportSpan, left_out: Collection[int] = ()) -> Array:
    """Return the joints (k, joints) [rad] at even shares of the length of the way from grasp to release.

    Args:
        samples: of a demonstration, in the order received, all with joints from grasp to release.
        cut: its transport phase.
        left_out: numbers of samples that are not learned from.
    """
    carried = transport_samples(samples, cut)
    carried = carried.select(~np.isin(carried.sequence, np.fromiter(left_out, np.uint64, len(left_out))))
    steps = np.linalg.norm(np.diff(carried.position, axis=0), axis=1)
    lengths = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, lengths[-1], COUNT)
    return np.stack([np.interp(wanted, lengths, joint) for joint in carried.joints.T], axis=1)
