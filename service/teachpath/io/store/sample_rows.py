"""Samples that wait, as rows of plain values: Python's garbage collector need not visit them.

It visits every object that lives. With hundreds of takes under way a million samples kept it busy for 0.2 s at a time,
in which no sample could be received.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, overload

from teachpath.records import Quaternion, Sample, SampleColumns, Vector

# No named tuple: the collector passes over tuples of plain values, but not over those of a class of ours.
Row = tuple[int, int, int, Vector, Quaternion | None, tuple[float, ...], bool, int, tuple[float, ...]]


class ValueColumns(NamedTuple):
    """The values of n samples, each (n,); see `Sample`."""

    sequence: tuple[int, ...]
    device_ns: tuple[int, ...]
    receive_ns: tuple[int, ...]
    position: tuple[Vector, ...]
    orientation: tuple[Quaternion | None, ...]
    flexions: tuple[tuple[float, ...], ...]
    tracked: tuple[bool, ...]
    buttons: tuple[int, ...]
    joints: tuple[tuple[float, ...], ...]


class SampleRows(Sequence[Sample]):
    """Samples of one tracker, made anew whenever they are read."""

    def __init__(self) -> None:
        self._tracker = ""
        self._rows: list[Row] = []

    def append(self, sample: Sample) -> None:
        """Add a sample."""
        self._tracker = sample.tracker
        self._rows.append(sample[1:])

    def columns(self) -> ValueColumns:
        """Return the values of all samples, of which there is at least one."""
        return ValueColumns(*zip(*self._rows, strict=True))

    def arrays(self) -> SampleColumns:
        """Return all samples as arrays."""
        if not self._rows:
            return SampleColumns.of(())
        return SampleColumns.of_values(self._tracker, *self.columns())

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> Sample: ...

    @overload
    def __getitem__(self, index: slice) -> list[Sample]: ...

    def __getitem__(self, index: int | slice) -> Sample | list[Sample]:
        if isinstance(index, slice):
            return [Sample(self._tracker, *row) for row in self._rows[index]]
        return Sample(self._tracker, *self._rows[index])
