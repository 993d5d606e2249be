"""Samples that wait, in columns: Python's garbage collector need not visit them.

It visits every object that lives. With hundreds of takes under way a million samples kept it busy for 0.2 s at a time,
in which no sample could be received.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, overload

from teachpath.records import Sample, SampleColumns

PIECE_SIZE: Final = 200  # samples that are put together at once


class SampleRows(Sequence[Sample]):
    """Samples of one tracker, added one by one or as columns; they are made anew when they are read."""

    def __init__(self) -> None:
        self._whole: list[SampleColumns] = []  # of at least PIECE_SIZE samples each
        self._parts: list[SampleColumns] = []  # that wait to be put together
        self._single: list[Sample] = []  # behind them
        self._count = self._waiting = 0

    def append(self, sample: Sample) -> None:
        """Add a sample."""
        self._single.append(sample)
        self._add(1)

    def extend(self, samples: SampleColumns) -> None:
        """Add samples, which may be a part of larger columns."""
        self._take_singles()
        self._parts.append(samples)
        self._add(len(samples))

    def arrays(self) -> SampleColumns:
        """Return all samples as arrays."""
        self._put_together()
        if not self._whole:
            return SampleColumns.of(())
        if len(self._whole) > 1:
            self._whole = [SampleColumns.joined(self._whole)]
        return self._whole[0]

    def _add(self, count: int) -> None:
        self._count += count
        self._waiting += count
        if self._waiting >= PIECE_SIZE:
            self._put_together()

    def _take_singles(self) -> None:
        if self._single:
            self._parts.append(SampleColumns.of(self._single))
            self._single = []

    def _put_together(self) -> None:
        self._take_singles()
        if self._parts:
            # Parts of larger columns are copied, so that what came with them from other trackers is not kept.
            self._whole.append(SampleColumns.joined(self._parts))
            self._parts, self._waiting = [], 0

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Sample: ...

    @overload
    def __getitem__(self, index: slice) -> SampleColumns: ...

    def __getitem__(self, index: int | slice) -> Sample | SampleColumns:
        if isinstance(index, slice):
            return self.arrays()[index]
        at = range(self._count)[index]
        for piece in (*self._whole, *self._parts, self._single):
            if at < len(piece):
                return piece[at]
            at -= len(piece)
        raise IndexError(index)
