"""The account of a take, part by part: what is learned of it, and the hand's ways to the object and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import Sample, StreamStatistics


@dataclass(frozen=True, slots=True)
class PhaseStatistics:
    """A take and its parts; every sample is in one of them, and every step to a sample belongs to its part.

    Attributes:
        whole: of the take, as the recorder kept it: with what was refused, and the faults of the positions.
        reach: up to the last sample before the grasp.
        carried: from the grasp to the first sample after the release: what is learned, and how it began and ended.
        back: what came after that.
    """

    whole: StreamStatistics
    reach: StreamStatistics
    transport: StreamStatistics
    return_: StreamStatistics


def phase_statistics(
    samples: Sequence[Sample], cut: TransportSpan, whole: StreamStatistics, settings: RecordingSettings
) -> PhaseStatistics:
    """Return the parts of a take.

    A sample that came only after the release is lost of what is learned, which is without it. What only the handshake
    told to be lost comes after all samples.

    Args:
        samples: in the order received.
        cut: its transport phase.
        whole: the account of the take.
    """
    stream = StreamCounter(declared_rate=whole.declared_rate, largest_clock_step=settings.largest_clock_step)
    borders, parts = (cut.grasp, cut.release + 1), []
    for index, sample in enumerate(samples):
        if index in borders:
            parts.append(stream.interval())
            stream.begin_interval(joined=True)
        stream.observe(sample)
    unseen = max(whole.lost - stream.statistics().lost, 0)
    last = stream.interval()
    reach, transport, return_ = [*parts, replace(last, lost=last.lost + unseen), StreamStatistics()][:3]
    return PhaseStatistics(whole, reach, transport, return_)
