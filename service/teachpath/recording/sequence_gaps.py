"""The numbers of a stream that have not come: lost, or still under way."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

MAX_PENDING = 10_000  # numbers of refused samples that are remembered until the stream has passed them

Stretch = tuple[int, int]  # first and last number


class SequenceGaps:
    """Keeps the stretches of numbers that are missing; a number that is late or was refused is taken out.

    Attributes:
        settled: the stretches of before the device counted anew.
        refused: the numbers of refused samples, by stretches, in the order in which they were refused.
    """

    def __init__(self) -> None:
        self._missing: list[Stretch] = []  # rising
        self.settled: list[Stretch] = []
        self.refused: list[Stretch] = []
        self._pending: set[int] = set()  # numbers of refused samples that the stream has not passed yet

    @property
    def all(self) -> list[Stretch]:
        """All stretches that are missing."""
        return self.settled + self._missing

    def since(self, first: int) -> list[Stretch]:
        """Return the missing stretches from number `first` on, cut off there."""
        begin = max(bisect_right(self._missing, (first,)) - 1, 0)
        return [(max(a, first), b) for a, b in self._missing[begin:] if b >= first]

    def pass_over(self, first: int, last: int) -> int:
        """Take note that the stream has passed the numbers from `first` to `last`; return how many are missing."""
        count = 0
        for number in [*sorted(n for n in self._pending if first <= n <= last), last + 1]:
            if number > first:
                self._missing.append((first, number - 1))
                count += number - first
            first = number + 1
        return count

    def reach(self, number: int) -> None:
        """Take note of the newest number that has come."""
        if self._pending:
            self._pending = {n for n in self._pending if n > number}

    def refuse(self, number: int, highest: int) -> bool:
        """Take note that the sample `number` was refused; return whether it was missing until now.

        Args:
            highest: the newest number that has come.
        """
        if self.refused and number == self.refused[-1][1] + 1:
            self.refused[-1] = (self.refused[-1][0], number)
        else:
            self.refused.append((number, number))
        if number > highest and len(self._pending) < MAX_PENDING:
            self._pending.add(number)
        return number <= highest and self.fill(number)

    def stretch_of(self, number: int) -> Stretch | None:
        """Return the missing stretch that a number lies in, or None when the number is not missing."""
        i = self._index(number)
        return None if i is None else self._missing[i]

    def fill(self, number: int) -> bool:
        """Take a number out; return whether it was missing."""
        i = self._index(number)
        if i is None:
            return False
        first, last = self._missing[i]
        self._missing[i : i + 1] = [(a, b) for a, b in [(first, number - 1), (number + 1, last)] if a <= b]
        return True

    def precede(self, first: int, last: int) -> int:
        """Take note that numbers before all that came are missing; return how many."""
        if first > last:
            return 0
        self._missing.insert(0, (first, last))
        return last - first + 1

    def settle(self) -> None:
        """Take note that the device counts anew."""
        self.settled += self._missing
        self._missing.clear()
        self._pending.clear()

    def _index(self, number: int) -> int | None:
        i = bisect_right(self._missing, (number, float("inf"))) - 1
        return i if i >= 0 and number <= self._missing[i][1] else None


def count_numbers(stretches: Iterable[Stretch]) -> int:
    """Return how many numbers lie in stretches that do not overlap."""
    return sum(last - first + 1 for first, last in stretches)
