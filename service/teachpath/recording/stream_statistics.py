"""Statistics of a sample stream: received, lost, duplicated and late samples, and how the device's clock runs."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

from teachpath.recording.clock import REAL_TIME_TOLERANCE, DeviceClock
from teachpath.recording.message_counter import MessageCounter
from teachpath.records import Sample, StreamStatistics

MAX_SEQUENCE_JUMP = 100_000  # sequence numbers; a larger gap is a restarted device, not loss
MAX_LISTED_GAPS = 20
HISTORY_SIZE = 512  # samples whose device times are remembered, to tell duplicates from conflicts
MAX_CLOCK_RATE = 100.0  # device seconds in one of ours; beyond it the receive times come from a burst
RESTART_THRESHOLD = 10  # older numbers in a row, each with a newer time, that show that the device counts anew


class StreamCounter:
    """Counts the samples of one tracker by their sequence numbers: all of them, and those of the current interval.

    A sample below the highest number seen fills a gap (reordered) or came before (duplicated). A duplicate with
    another device time is in conflict with the first.

    Args:
        declared_rate: [Hz] that the client declares; 0: it declares none.
        largest_clock_step: [s] see RecordingSettings.

    Attributes:
        first: number of the first sample; None: no sample came.
        highest: highest number seen; -1: no sample came.
    """

    def __init__(self, *, declared_rate: float = 0.0, largest_clock_step: float = 0.25) -> None:
        self.first: int | None = None
        self.highest = -1
        self._declared_rate = declared_rate
        self._largest_clock_step_ns = round(largest_clock_step * 1e9)
        self._missing: list[tuple[int, int]] = []  # stretches of missing numbers, rising, first and last of each
        self._settled: list[tuple[int, int]] = []  # the stretches of before the device counted anew
        self._lost = 0
        self._received = 0
        self._duplicated = 0
        self._reordered = 0
        self._refused = 0
        self._untracked = 0
        self._conflicts = 0
        self._clock_jumps = 0
        self._late_in_a_row = 0
        self._recent: list[tuple[int, int]] = [(-1, 0)] * HISTORY_SIZE
        self._last_device_ns = 0
        self._last_receive_ns = 0
        # sums over all steps of the device's clock that were no jumps
        self._steps = 0
        self._device_ns = 0
        self._receive_ns = 0
        self._longest_gap_ns = 0
        self._clock = DeviceClock()
        self._interrupted = False
        self._notes = _new_notes()
        self._refusals = _new_refusals()
        # the current interval
        self._interval_is_empty = True
        self._interval_first = 0  # lowest number that counts in it
        self._interval_longest_gap_ns = 0
        self._interval_notes = _new_notes()
        self._interval_refusals = _new_refusals()
        self._before_interval = self._counts()

    def observe(self, sample: Sample) -> bool:
        """Count one sample; return whether it is newer than all before (neither late nor a duplicate)."""
        self._received += 1
        if self.first is None or (self._interrupted and sample.sequence <= self.highest):
            self._count_anew(sample.sequence)
        self._interrupted = False
        step = sample.sequence - self.highest
        if step <= 0:
            self._observe_late(sample)
            return False
        if step > MAX_SEQUENCE_JUMP:
            self.note(f"the sequence jumps from {self.highest} to {sample.sequence}: was the device restarted?")
        elif step > 1:
            self._miss(self.highest + 1, sample.sequence - 1)
        self.highest = sample.sequence
        self._late_in_a_row = 0
        self._untracked += not sample.tracked
        self._recent[sample.sequence % HISTORY_SIZE] = (sample.sequence, sample.device_ns)
        if self._last_device_ns:
            self._observe_clock(sample, step)
        self._last_device_ns, self._last_receive_ns = sample.device_ns, sample.receive_ns
        self._clock.observe(sample)
        if self._interval_is_empty:
            self._begin_interval_with(sample.sequence)
        return True

    @property
    def received(self) -> int:
        """How many samples came."""
        return self._received

    @property
    def has_restarted(self) -> bool:
        """Whether the device seems to count anew: only older numbers come, with newer times."""
        return self._late_in_a_row >= RESTART_THRESHOLD

    def interrupt(self) -> None:
        """Expect that the device may count anew, because it was away."""
        self._interrupted = True

    def count_refused(self, reason: str) -> None:
        """Count a payload that is no usable sample."""
        self._refused += 1
        self._refusals.add(reason)
        self._interval_refusals.add(reason)

    def count_missing_until(self, last_sequence: int) -> None:
        """Count as lost the samples after the highest number seen that the client says it sent."""
        if self.first is None:
            self.first = last_sequence  # no sample came; how many were sent is not known
            self.note(f"no sample came, though the client says it sent up to number {last_sequence}")
        if 0 < last_sequence - self.highest <= MAX_SEQUENCE_JUMP:
            self._miss(self.highest + 1, last_sequence)
            self.highest = last_sequence

    def note(self, sentence: str) -> None:
        """Keep a sentence for the operator."""
        self._notes.add(sentence)
        self._interval_notes.add(sentence)

    def begin_interval(self, *, counts_loss_before: bool = False, first: Sample | None = None) -> None:
        """Begin another interval.

        Args:
            counts_loss_before: if True, samples lost before the first sample of the interval count in it; otherwise
                in no interval.
            first: the sample observed last, if it is the first of this interval.
        """
        self._interval_is_empty = not counts_loss_before and first is None
        self._interval_first = self.highest + (first is None)
        self._before_interval = self._counts()
        if first is not None:
            self._before_interval["received"] -= 1
            self._before_interval["untracked"] -= not first.tracked
        self._interval_longest_gap_ns = 0
        self._interval_notes = _new_notes()
        self._interval_refusals = _new_refusals()

    def statistics(self) -> StreamStatistics:
        """Return the statistics of all samples so far."""
        notes = self._refusals.messages() + self._notes.messages()
        return self._statistics(self._counts(), self._longest_gap_ns, notes, first=0)

    def interval(self, *, excluding: Sample | None = None) -> StreamStatistics:
        """Return the statistics of the current interval.

        Args:
            excluding: the sample observed last, if it belongs to the next interval.
        """
        counts = {name: max(count - self._before_interval[name], 0) for name, count in self._counts().items()}
        if excluding is not None:
            counts["received"] -= 1
            counts["untracked"] -= not excluding.tracked
        # A late sample of an earlier interval fills a gap there and none here.
        counts |= self._missing_since(self._interval_first)
        notes = self._interval_refusals.messages() + self._interval_notes.messages()
        return self._statistics(counts, self._interval_longest_gap_ns, notes, first=self._interval_first)

    def _counts(self) -> dict[str, int]:
        return {
            "received": self._received,
            "lost": self._lost,
            "duplicated": self._duplicated,
            "reordered": self._reordered,
            "refused": self._refused,
            "untracked": self._untracked,
            "gaps": len(self._settled) + len(self._missing),
            "conflicts": self._conflicts,
            "clock_jumps": self._clock_jumps,
            "steps": self._steps,
            "device_ns": self._device_ns,
        }

    def _missing_since(self, first: int) -> dict[str, int]:
        gaps = [(max(a, first), b) for a, b in self._missing[max(bisect_right(self._missing, (first,)) - 1, 0) :]]
        lost = [b - a + 1 for a, b in gaps if b >= a]
        return {"gaps": len(lost), "lost": sum(lost)}

    def _statistics(
        self, counts: dict[str, int], longest_gap_ns: int, messages: Iterable[str], *, first: int
    ) -> StreamStatistics:
        clock, notes = self._clock.estimate(), tuple(messages)
        if clock is not None and abs(clock.rate - 1.0) > REAL_TIME_TOLERANCE:
            notes = (*notes, f"the device's clock runs {clock.rate:.3g} x ours")
        steps, device_ns = counts.pop("steps"), counts.pop("device_ns")
        missing = self._missing if first else self._settled + self._missing
        return StreamStatistics(
            **counts,
            missing=tuple(stretch for stretch in missing if stretch[1] >= first)[:MAX_LISTED_GAPS],
            longest_gap_ns=longest_gap_ns,
            declared_rate=self._declared_rate,
            seen_rate=1e9 * steps / device_ns if device_ns else 0.0,
            clock=clock,
            notes=notes,
        )

    def _begin_interval_with(self, sequence: int) -> None:
        self._interval_is_empty = False
        self._interval_first = sequence
        now = self._counts()
        self._before_interval |= {name: now[name] for name in ("clock_jumps", "steps", "device_ns")}
        self._interval_longest_gap_ns = 0

    def _count_anew(self, sequence: int) -> None:
        if self.first is not None:
            self.note(f"the device counts anew from number {sequence}")
        self.first, self.highest = sequence, sequence - 1
        self._settled += self._missing
        self._missing.clear()
        self._recent = [(-1, 0)] * HISTORY_SIZE
        self._last_device_ns = 0
        self._late_in_a_row = 0
        self._clock.restart()

    def _observe_late(self, sample: Sample) -> None:
        if self._fills_gap(sample.sequence):
            self._reordered += 1
            self._untracked += not sample.tracked
            self._recent[sample.sequence % HISTORY_SIZE] = (sample.sequence, sample.device_ns)
            return
        self._duplicated += 1
        self._late_in_a_row = self._late_in_a_row + 1 if sample.device_ns > self._last_device_ns else 0
        number, device_ns = self._recent[sample.sequence % HISTORY_SIZE]
        if number == sample.sequence and device_ns != sample.device_ns:
            self._conflicts += 1
            self.note(f"two different samples have the number {number}: do two trackers share this name?")
        elif sample.sequence < (self.first or 0):
            self.note(f"sequence {sample.sequence} is below the first one, {self.first}")

    def _observe_clock(self, sample: Sample, step: int) -> None:
        device, receive = sample.device_ns - self._last_device_ns, sample.receive_ns - self._last_receive_ns
        excess = device - self._largest_clock_step_ns
        if device < 0 or (excess > 0 and not self._is_explained(excess, step, receive)):
            self._clock_jumps += 1
            self.note(f"the device's clock jumps by {device * 1e-9:+.3g} s at sample {sample.sequence}")
            self._clock.restart()
            return
        self._steps += step
        self._device_ns += device
        self._receive_ns += receive
        if device > self._interval_longest_gap_ns:
            self._interval_longest_gap_ns = device
            self._longest_gap_ns = max(self._longest_gap_ns, device)

    def _is_explained(self, device: int, step: int, receive: int) -> bool:
        """Tell whether the numbers explain a step of the device's clock (loss), or our clock does (a pause)."""
        period = 1e9 / self._declared_rate if self._declared_rate else self._device_ns / max(self._steps, 1)
        rate = min(max(self._device_ns / max(self._receive_ns, 1), 1.0), MAX_CLOCK_RATE)
        return device <= max(step * period, receive * rate)

    def _miss(self, first: int, last: int) -> None:
        self._missing.append((first, last))
        self._lost += last - first + 1

    def _fills_gap(self, sequence: int) -> bool:
        i = bisect_right(self._missing, (sequence, MAX_SEQUENCE_JUMP + sequence)) - 1
        if i < 0 or sequence > self._missing[i][1]:
            return False
        first, last = self._missing[i]
        rest = [(first, sequence - 1), (sequence + 1, last)]
        self._missing[i : i + 1] = [(a, b) for a, b in rest if a <= b]
        self._lost -= 1
        return True


def _new_notes() -> MessageCounter:
    return MessageCounter("more happened than can be listed")


def _new_refusals() -> MessageCounter:
    return MessageCounter("samples were refused for other reasons")
