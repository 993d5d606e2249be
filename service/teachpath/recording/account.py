"""The account of a sample stream: what came, what did not, what came twice or late."""

from __future__ import annotations

from collections import deque

from teachpath.records import Account, Sample

LARGEST_JUMP = 100_000  # sequence numbers; a larger gap is a restarted device, not loss
REMEMBERED_NOTES = 20


class StreamAccount:
    """Counts the samples of one tracker by their sequence numbers.

    A sample below the highest number seen fills a gap (reordered) or was there before (duplicated).
    """

    def __init__(self) -> None:
        self.first: int | None = None
        self.highest = -1
        self._missing: set[int] = set()
        self._received = self._duplicated = self._reordered = self._refused = self._untracked = 0
        self._last_device_ns = 0
        self._longest_gap_ns = 0
        self._notes: deque[str] = deque(maxlen=REMEMBERED_NOTES)

    def observe(self, sample: Sample) -> bool:
        """Count one sample; return whether it is newer than all before (neither late nor a duplicate)."""
        self._received += 1
        if self.first is None:
            self.first, self.highest = sample.sequence, sample.sequence - 1
        if sample.sequence <= self.highest:
            self._observe_late(sample)
            return False
        if sample.sequence - self.highest > LARGEST_JUMP:
            self.note(f"the sequence jumps from {self.highest} to {sample.sequence}: was the device restarted?")
        else:
            self._missing.update(range(self.highest + 1, sample.sequence))
        self.highest = sample.sequence
        self._untracked += not sample.tracked
        if self._last_device_ns:
            self._longest_gap_ns = max(self._longest_gap_ns, sample.device_ns - self._last_device_ns)
        self._last_device_ns = max(self._last_device_ns, sample.device_ns)
        return True

    def _observe_late(self, sample: Sample) -> None:
        if sample.sequence in self._missing:
            self._missing.discard(sample.sequence)
            self._reordered += 1
            self._untracked += not sample.tracked
            return
        self._duplicated += 1
        if sample.sequence < (self.first or 0):
            self.note(f"sequence {sample.sequence} is below the first one, {self.first}")

    def refuse(self, reason: str) -> None:
        """Count a payload that is no usable sample."""
        self._refused += 1
        self.note(reason)

    def expect(self, last_sequence: int) -> None:
        """Count as lost what the client says it sent after the highest number seen."""
        if self.first is None:
            self.first = last_sequence  # nothing came at all; how many were sent is not known
            self.note(f"no sample came, though the client says it sent up to number {last_sequence}")
        if 0 < last_sequence - self.highest <= LARGEST_JUMP:
            self._missing.update(range(self.highest + 1, last_sequence + 1))
            self.highest = last_sequence

    def note(self, sentence: str) -> None:
        """Keep a sentence for the operator; the newest few are kept."""
        if sentence not in self._notes:
            self._notes.append(sentence)

    def account(self) -> Account:
        """Return the counts so far."""
        return Account(
            received=self._received,
            lost=len(self._missing),
            duplicated=self._duplicated,
            reordered=self._reordered,
            refused=self._refused,
            untracked=self._untracked,
            longest_gap_ns=self._longest_gap_ns,
            notes=tuple(self._notes),
        )
