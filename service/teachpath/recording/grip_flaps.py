"""A glove that flaps: it reads open and closed in turn faster than a hand, so that nobody knows when it let go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from teachpath.recording.phases import TransportSpan, hand_closure
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array, Sample, SampleColumns
from teachpath_proto.sample_rules import GRASP_BUTTON

ROUNDING = 1e-9  # a closure so near to a limit is summed as `hand_closure` sums it


@dataclass(frozen=True, slots=True)
class GripFlaps:
    """What a glove read too shortly to be a hand that opens or closes.

    Attributes:
        count: stretches from the grasp on, each closed or open, that are shorter than `RecordingSettings.shortest_grip`
            and end with the contrary.
        first_at_ns: begin of the first of them, since the grasp [ns of the device's clock].
        regrasp_ns: for how long the hand was open when it had let go, if it closed again so soon; 0: it did not.
    """

    count: int = 0
    first_at_ns: int = 0
    regrasp_ns: int = 0


def find_grip_flaps(samples: Sequence[Sample], cut: TransportSpan, settings: RecordingSettings) -> GripFlaps:
    """Find where the hand of a take opened or closed for a shorter time than a hand can.

    A glitch of one reading that does not cross both limits, `open_at` and `close_at`, is none.

    Args:
        samples: in the order received.
        cut: their transport phase.
        settings: limits of the recording.
    """
    columns = SampleColumns.of(samples)
    begin_ns = int(columns.device_ns[cut.grasp])
    changes = _changes(columns[cut.grasp :], settings)
    limit_ns = settings.shortest_grip * 1e9
    short = [(a, b) for a, b in pairwise(changes) if 0 <= b - a < limit_ns]
    let_go_ns = int(columns.device_ns[cut.release]) if cut.release < len(columns) else -1
    return GripFlaps(
        count=len(short),
        first_at_ns=short[0][0] - begin_ns if short else 0,
        regrasp_ns=next((b - a for a, b in short if a == let_go_ns), 0),
    )


def _changes(samples: SampleColumns, settings: RecordingSettings) -> list[int]:
    """Return when the hand closed or opened [ns of the device's clock]; it is closed at the first sample."""
    closure = _closures(samples, settings)
    decided = np.flatnonzero((closure > settings.close_at) | (closure <= settings.open_at))
    closed = np.concatenate([[True], closure[decided] > settings.close_at])
    return [int(ns) for ns in samples.device_ns[decided[closed[1:] != closed[:-1]]].tolist()]


def _closures(samples: SampleColumns, settings: RecordingSettings) -> Array:
    """Return `hand_closure` of each sample (n,); next to a limit to the last bit."""
    closure = samples.flexions.sum(axis=1, dtype=np.float64) / np.maximum(samples.flexion_count, 1)
    closure[samples.buttons & GRASP_BUTTON > 0] = 1.0
    limits = np.array([settings.open_at, settings.close_at])
    for k in np.flatnonzero((np.abs(closure[:, None] - limits) <= ROUNDING).any(axis=1)).tolist():
        closure[k] = hand_closure(samples[k])
    return np.asarray(closure)
