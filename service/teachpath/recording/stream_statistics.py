"""Statistics of a sample stream: received, lost, duplicated and late samples, and how the device's clock runs."""

from __future__ import annotations

from collections.abc import Iterable

from teachpath.recording.arrival import Arrival
from teachpath.recording.clock import rate_notes
from teachpath.recording.message_counter import IntervalMessages
from teachpath.recording.sample_history import SampleHistory
from teachpath.recording.sample_runs import SampleBlock
from teachpath.recording.sequence_gaps import SequenceGaps, count_numbers
from teachpath.recording.stream_clock import StreamClock
from teachpath.records import Sample, StreamStatistics

MAX_SEQUENCE_JUMP = 100_000  # sequence numbers; a larger gap is a restarted device, not loss
MAX_LISTED_GAPS = 20
RESTART_THRESHOLD = 10  # older numbers in a row, each with a newer time, that show that the device counts anew
# refused payloads without a number explain as many lost numbers
COUNTERS = ("received", "lost", "reordered", "late", "duplicated", "conflicts", "refused", "unnumbered", "untracked")


class StreamCounter:
    """Counts the samples of one tracker by their numbers and clock: all of them, and those of the current interval.

    Every sample received is in order, reordered, late, duplicated or conflicting; every number that was sent was
    received so, refused or lost.

    Args:
        declared_rate: [Hz] that the client declares; 0: it declares none.
        largest_clock_step: [s] see RecordingSettings.

    Attributes:
        first: number of the first sample; None: no sample came.
        highest: highest number seen; -1: no sample came.
    """

    def __init__(self, *, declared_rate: float = 0.0, largest_clock_step: float = 0.1) -> None:
        self.first: int | None = None
        self.highest: int = -1
        self._declared_rate = declared_rate
        self._gaps = SequenceGaps()
        self._counts = dict.fromkeys(COUNTERS, 0)
        self._late_in_a_row = 0
        self._first_device_ns = 0
        self._newest_device_ns = 0
        self._history = SampleHistory()
        self._clock = StreamClock(declared_rate, largest_clock_step)
        self._interrupted = False
        self._notes = IntervalMessages("more happened than can be listed")
        self._refusals = IntervalMessages("samples were refused for other reasons")
        # the current interval
        self._interval_is_empty = True
        self._interval_first = 0  # lowest number that counts in it
        self._before_interval = self._totals()

    def observe(self, sample: Sample) -> Arrival:
        """Count one sample and tell how it came."""
        self._counts["received"] += 1
        if self.first is None or (self._interrupted and sample.sequence <= self.highest):
            self._count_anew(sample)
        self._interrupted = False
        step = sample.sequence - self.highest
        if step <= 0:
            return self._observe_late(sample)
        if step > MAX_SEQUENCE_JUMP:
            self.note(f"the sequence jumps from {self.highest} to {sample.sequence}: was the device restarted?")
            self._gaps.settle()
            self.first, self._first_device_ns = sample.sequence, sample.device_ns
        elif step > 1:
            self._counts["lost"] += self._gaps.pass_over(self.highest + 1, sample.sequence - 1)
        self.highest = sample.sequence
        self._gaps.reach(sample.sequence)
        self._late_in_a_row = 0
        self._newest_device_ns = sample.device_ns
        self._keep(sample)
        if jump := self._clock.observe(sample, step):
            self.note(jump)
        if self._interval_is_empty:
            self._begin_interval_with(sample.sequence)
        return Arrival.IN_ORDER

    def continues(self, sequence: int, device_ns: int) -> bool:
        """Tell whether a sample that comes next is the next number of the interval, by a clock that runs as it did."""
        expected = not (self._interrupted or self._interval_is_empty) and sequence == self.highest + 1
        return expected and self._clock.steps.continues(device_ns)

    def observe_run(self, block: SampleBlock, begin: int, end: int) -> None:
        """Count the samples of a steady run that continues the newest one."""
        self.highest, self._newest_device_ns = block.sequence[end - 1], block.device_ns[end - 1]
        self._counts["received"] += end - begin
        self._counts["untracked"] += block.tracked[begin:end].count(False)
        self._gaps.reach(self.highest)
        self._late_in_a_row = 0
        self._history.keep_run(block.columns, begin, end)
        self._clock.observe_run(block, begin, end)

    @property
    def received(self) -> int:
        """How many samples came."""
        return self._counts["received"]

    @property
    def has_restarted(self) -> bool:
        """Whether the device seems to count anew: only older numbers come, with newer times."""
        return self._late_in_a_row >= RESTART_THRESHOLD

    def is_before_interval(self, sequence: int) -> bool:
        """Whether a number belongs to an earlier interval than the current one."""
        return self._interval_is_empty or sequence < self._interval_first

    def interrupt(self) -> None:
        """Expect that the device may count anew, because it was away."""
        self._interrupted = True

    def count_refused(self, reason: str, sequence: int | None = None) -> None:
        """Count a payload that is no usable sample.

        Args:
            sequence: its number, which is not lost then; None: it cannot be read, and explains any number.
        """
        self._counts["refused"] += 1
        if sequence is None:
            self._counts["unnumbered"] += 1
        elif self._gaps.refuse(sequence, self.highest):
            self._counts["lost"] -= 1
        self._refusals.add(reason)

    def count_missing_until(self, last_sequence: int) -> None:
        """Count as lost the samples after the highest number seen that the client says it sent."""
        if self.first is None:
            self.first = last_sequence  # no sample came; how many were sent is not known
            self.note(f"no sample came, though the client says it sent up to number {last_sequence}")
        if 0 < last_sequence - self.highest <= MAX_SEQUENCE_JUMP:
            self._counts["lost"] += self._gaps.pass_over(self.highest + 1, last_sequence)
            self.highest = last_sequence
            self._gaps.reach(last_sequence)

    def note(self, sentence: str, *, in_interval: bool = True) -> None:
        """Keep a sentence for the operator; with `in_interval` it is of the current interval too."""
        self._notes.add(sentence, in_interval=in_interval)

    def begin_interval(self, *, counts_loss_before: bool = False, first: Sample | None = None) -> None:
        """Begin another interval.

        Args:
            counts_loss_before: if True, samples lost before the first sample of the interval count in it; otherwise
                in no interval.
            first: the sample observed last, if it is the first of this interval.
        """
        self._interval_is_empty = not counts_loss_before and first is None
        self._interval_first = self.highest + (first is None)
        self._before_interval = self._totals()
        if first is not None:
            self._before_interval["received"] -= 1
            self._before_interval["untracked"] -= not first.tracked
        self._clock.begin_interval()
        self._notes.begin_interval()
        self._refusals.begin_interval()

    def statistics(self) -> StreamStatistics:
        """Return the statistics of all samples so far."""
        notes = self._refusals.all.messages() + self._notes.all.messages()
        return self._statistics(self._totals(), self._clock.longest_gap_ns, notes, first=0)

    def interval(self, *, excluding: Sample | None = None) -> StreamStatistics:
        """Return the statistics of the current interval.

        Args:
            excluding: the sample observed last, if it belongs to the next interval.
        """
        counts = {name: max(count - self._before_interval[name], 0) for name, count in self._totals().items()}
        if excluding is not None:
            counts["received"] -= 1
            counts["untracked"] -= not excluding.tracked
        missing = self._gaps.since(self._interval_first)
        counts |= {"gaps": len(missing), "lost": count_numbers(missing)}
        notes = self._refusals.interval.messages() + self._notes.interval.messages()
        return self._statistics(counts, self._clock.interval_longest_gap_ns, notes, first=self._interval_first)

    def _totals(self) -> dict[str, int]:
        clock = self._clock.steps
        return {
            **self._counts,
            "gaps": len(self._gaps.all),
            "clock_jumps": clock.clock_jumps,
            "steps": clock.steps,
            "device_ns": clock.device_ns,
        }

    def _statistics(
        self, counts: dict[str, int], longest_gap_ns: int, messages: Iterable[str], *, first: int
    ) -> StreamStatistics:
        clock = self._clock.estimate()
        steps, device_ns = counts.pop("steps"), counts.pop("device_ns")
        counts["lost"] = max(counts["lost"] - counts.pop("unnumbered"), 0)
        missing = self._gaps.since(first) if first else self._gaps.all
        return StreamStatistics(
            **counts,
            missing=tuple(missing[:MAX_LISTED_GAPS]),
            refused_numbers=tuple(each for each in self._gaps.refused if each[1] >= first)[:MAX_LISTED_GAPS],
            longest_gap_ns=longest_gap_ns,
            declared_rate=self._declared_rate,
            seen_rate=1e9 * steps / device_ns if device_ns else 0.0,
            clock=clock,
            notes=(*messages, *rate_notes(clock)),
            dwell_times=(),
        )

    def _begin_interval_with(self, sequence: int) -> None:
        self._interval_is_empty = False
        self._interval_first = sequence
        now = self._totals()
        self._before_interval |= {name: now[name] for name in ("clock_jumps", "steps", "device_ns")}
        self._clock.begin_interval()

    def _count_anew(self, sample: Sample) -> None:
        if self.first is not None:
            self.note(f"the device counts anew from number {sample.sequence}")
            self._gaps.settle()
        self.first, self.highest = sample.sequence, sample.sequence - 1
        self._first_device_ns = sample.device_ns
        self._history = SampleHistory()
        self._late_in_a_row = 0
        self._clock.restart()

    def _observe_late(self, sample: Sample) -> Arrival:
        if self._fits(sample):
            before = self.is_before_interval(sample.sequence) and not self._precedes(sample.sequence)
            self._take_place(sample)
            if before:
                self.note(f"sample {sample.sequence} came after its part of the recording was cut; it changes nothing")
                self._count_before_interval("late", "received")
                self._before_interval["untracked"] += not sample.tracked
                return Arrival.LATE
            self._counts["reordered"] += 1
            return Arrival.REORDERED
        is_newer = sample.device_ns > self._newest_device_ns
        self._late_in_a_row = self._late_in_a_row + 1 if is_newer else 0
        known = self._history.knows(sample.sequence)
        if self._history.holds(sample) if known else self._was_seen(sample, is_newer):
            if self.is_before_interval(sample.sequence):
                self._count_before_interval("duplicated", "received")
            else:
                self._counts["duplicated"] += 1
            return Arrival.DUPLICATED
        self._counts["conflicts"] += 1
        what = "two different samples have" if known else "a sample whose time does not fit has"
        self.note(f"{what} the number {sample.sequence}: do two trackers share this name?")
        return Arrival.CONFLICTING

    def _fits(self, sample: Sample) -> bool:
        """Tell whether a sample's number is missing, and its time suits its neighbours'."""
        stretch = self._gaps.stretch_of(sample.sequence)
        if stretch is None:
            return self._fits_before(sample)
        for neighbour in (stretch[0] - 1, stretch[1] + 1):
            device_ns, numbers = self._history.device_ns(neighbour), sample.sequence - neighbour
            if device_ns is None:
                continue
            after = sample.device_ns - device_ns if numbers > 0 else device_ns - sample.device_ns
            if not self._clock.steps.explains(after, abs(numbers)):
                return False
        return True

    def _fits_before(self, sample: Sample) -> bool:
        """Tell whether a sample belongs before the first one, by its number and its time."""
        numbers = (self.first or 0) - sample.sequence
        if not 0 < numbers <= MAX_SEQUENCE_JUMP:
            return False
        return self._clock.steps.explains(self._first_device_ns - sample.device_ns, numbers)

    def _precedes(self, sequence: int) -> bool:
        """Tell whether a number lies before the first one, and the interval began with that."""
        return not self._interval_is_empty and sequence < (self.first or 0) == self._interval_first

    def _was_seen(self, sample: Sample, is_newer: bool) -> bool:
        """Tell whether a sample came before, as far as that is remembered."""
        return sample.sequence >= (self.first or 0) and not is_newer and self._gaps.stretch_of(sample.sequence) is None

    def _take_place(self, sample: Sample) -> None:
        if sample.sequence < (self.first or 0):
            if self._precedes(sample.sequence):
                self._interval_first = sample.sequence
            self._counts["lost"] += self._gaps.precede(sample.sequence + 1, (self.first or 0) - 1)
            self.first, self._first_device_ns = sample.sequence, sample.device_ns
        else:
            self._gaps.fill(sample.sequence)
            self._counts["lost"] -= 1
        self._keep(sample)

    def _keep(self, sample: Sample) -> None:
        self._counts["untracked"] += not sample.tracked
        self._history.keep(sample)

    def _count_before_interval(self, *names: str) -> None:
        """Count what belongs to an interval that has ended, so that the current one does not count it."""
        for name in names:
            self._before_interval[name] += 1
            self._counts[name] += name != "received"
