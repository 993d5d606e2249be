"""A glove that flaps: it reads open and closed in turn faster than a hand, so that nobody knows when it let go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from teachpath.recording.phases import TransportSpan, hand_closure
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Sample


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
    begin_ns = samples[cut.grasp].device_ns
    changes = _changes(samples[cut.grasp :], settings)
    limit_ns = settings.shortest_grip * 1e9
    short = [(a, b) for a, b in pairwise(changes) if 0 <= b - a < limit_ns]
    let_go_ns = samples[cut.release].device_ns if cut.release < len(samples) else -1
    return GripFlaps(
        count=len(short),
        first_at_ns=short[0][0] - begin_ns if short else 0,
        regrasp_ns=next((b - a for a, b in short if a == let_go_ns), 0),
    )


def _changes(samples: Sequence[Sample], settings: RecordingSettings) -> list[int]:
    """Return when the hand closed or opened [ns of the device's clock]; it is closed at the first sample."""
    changes, closed = [], True
    for sample in samples:
        if (hand_closure(sample) > (settings.open_at if closed else settings.close_at)) != closed:
            closed = not closed
            changes.append(sample.device_ns)
    return changes
