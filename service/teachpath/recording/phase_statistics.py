"""Statistics of a take phase by phase: the reach to the object, its transport, which is learned, and the return."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from teachpath.recording.arrival import Arrival
from teachpath.recording.demonstration import NO_END, carried_numbers, place_of
from teachpath.recording.phases import TransportSpan
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.steady_counts import count_steady
from teachpath.recording.stream_statistics import StreamCounter
from teachpath.records import Sample, SampleColumns, StreamStatistics

COUNTED_AS: Final = {
    Arrival.REORDERED: "reordered",
    Arrival.LATE: "late",
    Arrival.DUPLICATED: "duplicated",
    Arrival.CONFLICTING: "conflicts",
}


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

    A sample belongs where its number puts it, whenever it came. Samples whose loss only the handshake at the end has
    shown belong behind all others; refused payloads whose number could not be read belong to the transport.

    Args:
        samples: in the order received.
        cut: its transport phase.
        whole: the statistics of the take.
    """
    columns = placed = SampleColumns.of(samples)
    irregular = []
    if not columns.is_in_order:
        arrivals = tell_arrivals(columns, whole, settings)
        belongs = np.flatnonzero([arrival.belongs for arrival in arrivals])
        placed = columns.select(belongs[np.argsort(columns.sequence[belongs], kind="stable")])
        irregular = [(k, columns[k], how) for k, how in enumerate(arrivals) if how is not Arrival.IN_ORDER]
    grasp, after = carried_numbers(samples, cut)
    end = int(placed.sequence[min(place_of(placed, after), len(placed) - 1)]) if after < NO_END else NO_END
    phases = _phases(placed, (grasp, end + 1), whole, settings)
    unplaced: list[dict[str, Any]] = [dict.fromkeys(COUNTED_AS.values(), 0) for _ in phases]
    for index, sample, arrival in irregular:
        if arrival is Arrival.CONFLICTING:  # its number says nothing about its place
            unplaced[(index >= cut.grasp) + (index > cut.release)]["conflicts"] += 1
        else:
            unplaced[(sample.sequence >= grasp) + (sample.sequence > end)][COUNTED_AS[arrival]] += 1
    refused = [_overlap(whole.refused_numbers, *span) for span in ((0, grasp - 1), (grasp, end), (end + 1, NO_END))]
    refused[1] += max(whole.refused - sum(refused), 0)
    reach, transport, return_ = (
        replace(
            phase,
            received=phase.received + counts["duplicated"] + counts["conflicts"],
            refused=lacking,
            **counts,
        )
        for phase, counts, lacking in zip(phases, unplaced, refused, strict=True)
    )
    difference = whole.lost - (reach.lost + transport.lost + return_.lost)
    if difference > 0 and after < NO_END:
        return_ = replace(return_, lost=return_.lost + difference)
    elif difference > 0:
        transport = replace(transport, lost=transport.lost + difference)
    else:
        transport, reach, return_ = _without(-difference, transport, reach, return_)
    return PhaseStatistics(whole, reach, transport, return_)


def tell_arrivals(samples: Sequence[Sample], whole: StreamStatistics, settings: RecordingSettings) -> Sequence[Arrival]:
    """Tell how each sample of a take came.

    Args:
        samples: in the order received.
        whole: the statistics of the take.
    """
    columns = SampleColumns.of(samples)
    if columns.is_in_order:
        return [Arrival.IN_ORDER] * len(columns)
    counter = _counter(whole, settings)
    return [counter.observe(sample) for sample in columns]


def _counter(whole: StreamStatistics, settings: RecordingSettings) -> StreamCounter:
    counter = StreamCounter(declared_rate=whole.declared_rate, largest_clock_step=settings.largest_clock_step)
    for first, last in whole.refused_numbers:
        for number in range(first, last + 1):
            counter.count_refused("refused", number)
    return counter


def _phases(
    placed: SampleColumns, borders: tuple[int, int], whole: StreamStatistics, settings: RecordingSettings
) -> list[StreamStatistics]:
    """Return the statistics of samples in the order of their numbers, up to each border and after the last."""
    if not whole.refused_numbers:
        steady = count_steady(placed, borders, settings.largest_clock_step)
        if steady is not None:
            return steady
    counter = _counter(whole, settings)
    phases: list[StreamStatistics] = []
    for sample in placed:
        while len(phases) < len(borders) and sample.sequence >= borders[len(phases)]:
            phases.append(counter.interval())
            counter.begin_interval(counts_loss_before=True)
        counter.observe(sample)
    phases.append(counter.interval())
    return (phases + [StreamStatistics()] * 2)[:3]


def _without(explained: int, *phases: StreamStatistics) -> Iterator[StreamStatistics]:
    """Yield phases without the lost samples that refused payloads explain, of the first ones first."""
    for phase in phases:
        fewer = min(explained, phase.lost)
        explained -= fewer
        yield replace(phase, lost=phase.lost - fewer)


def _overlap(stretches: Sequence[tuple[int, int]], first: int, last: int) -> int:
    """Return how many numbers of some stretches lie from `first` to `last`."""
    return sum(max(min(b, last) - max(a, first) + 1, 0) for a, b in stretches)
