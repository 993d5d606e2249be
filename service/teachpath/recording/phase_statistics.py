"""Statistics of a take phase by phase: the reach to the object, its transport, which is learned, and the return."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import Sample, StreamStatistics


@dataclass(frozen=True, slots=True)
class PhaseStatistics:
    """Statistics of a take and of its phases.

    Every sample belongs to one phase, and every step from one sample to the next to the phase of the later one.

    Attributes:
        whole: of the take, as the recorder kept them: with refused payloads and outliers of the positions.
        reach: up to the last sample before the grasp.
        transport: from the grasp to the first sample after the release, because the step to that sample ends what is
            learned.
        return_: all later samples.
    """

    whole: StreamStatistics
    reach: StreamStatistics
    transport: StreamStatistics
    return_: StreamStatistics


def phase_statistics(
    samples: Sequence[Sample], cut: TransportSpan, whole: StreamStatistics, settings: RecordingSettings
) -> PhaseStatistics:
    """Return the statistics of each phase of a take.

    A sample of the transport that came only after the release counts as lost there, because the trajectory is learned
    without it. Samples whose loss only the handshake at the end has shown belong behind all others.

    Args:
        samples: in the order received.
        cut: its transport phase.
        whole: the statistics of the take.
    """
    counter = StreamCounter(declared_rate=whole.declared_rate, largest_clock_step=settings.largest_clock_step)
    borders, phases = (cut.grasp, cut.release + 1), []
    for index, sample in enumerate(samples):
        if index in borders:
            phases.append(counter.interval())
            counter.begin_interval(counts_loss_before=True)
        counter.observe(sample)
    unseen = max(whole.lost - counter.statistics().lost, 0)
    last = counter.interval()
    reach, transport, return_ = [*phases, replace(last, lost=last.lost + unseen), StreamStatistics()][:3]
    return PhaseStatistics(whole, reach, transport, return_)
