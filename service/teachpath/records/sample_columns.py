"""Many samples as columns, so that they are checked, counted, written and read by the batch."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import chain
from typing import Any, Self, overload

import numpy as np
from numpy.typing import NDArray

from teachpath.records.arrays import Array, Quaternion, Vector
from teachpath.records.demonstrations import Sample
from teachpath_proto.sample_rules import NOT_MEASURED


@dataclass(frozen=True, eq=False, slots=True)
class SampleColumns(Sequence[Sample]):
    """n samples of one tracker; a sample is made when it is read.

    Attributes:
        sequence, device_ns, receive_ns, tracked, buttons: (n,), see `Sample`.
        position: (n, 3) [m].
        orientation: (n, 4) w, x, y, z; zeros where it is not measured.
        flexions: (n, k), of which each sample has the first `flexion_count`.
        flexion_count: (n,).
        joints: (n, j) [rad], of which each sample has the first that are numbers.
    """

    tracker: str
    sequence: NDArray[np.uint64]
    device_ns: NDArray[np.int64]
    receive_ns: NDArray[np.uint64]
    position: Array
    orientation: Array
    flexions: NDArray[Any]
    flexion_count: NDArray[np.int64]
    tracked: NDArray[np.bool_]
    buttons: NDArray[np.int64]
    joints: Array

    @classmethod
    def of(cls, samples: Sequence[Sample]) -> SampleColumns:
        """Return samples of one tracker as columns."""
        if isinstance(samples, SampleColumns):
            return samples
        if not samples:
            return cls.of_values("", *((),) * 9)
        return cls.of_values(samples[0].tracker, *([getattr(s, name) for s in samples] for name in VALUES))

    @classmethod
    def of_values(
        cls,
        tracker: str,
        sequence: Sequence[int],
        device_ns: Sequence[int],
        receive_ns: Sequence[int],
        position: Sequence[Vector],
        orientation: Sequence[Quaternion | None],
        flexions: Sequence[tuple[float, ...]],
        tracked: Sequence[bool],
        buttons: Sequence[int],
        joints: Sequence[tuple[float, ...]],
    ) -> SampleColumns:
        """Return n samples, of each value of which there are n."""
        n = len(sequence)
        bent, counts = _rows(flexions, 0.0)
        angles, _ = _rows(joints, np.nan)
        return cls(
            tracker,
            np.array(sequence, np.uint64),
            np.array(device_ns, np.int64),
            np.array(receive_ns, np.uint64),
            np.array(position, np.float64).reshape(n, 3),
            np.array([turn or NOT_MEASURED for turn in orientation], np.float64).reshape(n, 4),
            bent,
            counts,
            np.array(tracked, np.bool_),
            np.array(buttons, np.int64),
            angles,
        )

    @classmethod
    def joined(cls, parts: Sequence[SampleColumns]) -> SampleColumns:
        """Return the samples of parts, of which there is at least one, one part after the other."""
        if len(parts) == 1:
            return parts[0]
        values = {name: np.concatenate([getattr(part, name) for part in parts]) for name in COLUMNS - {*FILL_VALUES}}
        values |= {
            name: np.concatenate(_padded([getattr(part, name) for part in parts], lacking))
            for name, lacking in FILL_VALUES.items()
        }
        return cls(parts[0].tracker, **values)

    def select(self, chosen: slice | NDArray[Any], tracker: str = "") -> SampleColumns:
        """Return the samples that a slice, a mask or indices choose, as of another tracker where that is named."""
        return SampleColumns(tracker or self.tracker, *(getattr(self, name)[chosen] for name in COLUMN_NAMES))

    @property
    def is_in_order(self) -> bool:
        """Whether the numbers rise, each once."""
        return bool(np.all(self.sequence[1:] > self.sequence[:-1]))

    def __len__(self) -> int:
        return len(self.sequence)

    def __iter__(self) -> Iterator[Sample]:
        plain = (getattr(self, name).tolist() for name in COLUMN_NAMES)
        for sequence, device_ns, receive_ns, p, q, flexions, count, tracked, buttons, joints in zip(
            *plain, strict=True
        ):
            yield Sample(
                self.tracker,
                sequence,
                device_ns,
                receive_ns,
                tuple(p),
                tuple(q) if any(q) else None,
                tuple(flexions[:count]),
                tracked,
                buttons,
                tuple(angle for angle in joints if angle == angle) if joints else (),
            )

    @overload
    def __getitem__(self, index: int) -> Sample: ...

    @overload
    def __getitem__(self, index: slice) -> Self: ...

    def __getitem__(self, index: int | slice) -> Any:
        if isinstance(index, slice):
            return self.select(index)
        at = range(len(self))[index]
        return next(iter(self.select(slice(at, at + 1))))


COLUMN_NAMES = tuple(field.name for field in fields(SampleColumns))[1:]
COLUMNS = frozenset(COLUMN_NAMES)
VALUES = Sample._fields[1:]
FILL_VALUES = {
    "flexions": 0.0,
    "joints": np.nan,
}  # stands for what the rows of a column may lack


def _rows(values: Sequence[tuple[float, ...]], lacking: float) -> tuple[Array, NDArray[np.int64]]:
    """Return values of n samples as rows of one array (n, k), filled with `lacking`, and how many each has (n,)."""
    counts = np.fromiter(map(len, values), np.int64, len(values))
    rows = np.full((len(values), int(counts.max(initial=0))), lacking)
    rows[np.arange(rows.shape[1]) < counts[:, None]] = np.fromiter(chain.from_iterable(values), np.float64)
    return rows, counts


def _padded(parts: Sequence[NDArray[Any]], lacking: float) -> list[NDArray[Any]]:
    width = max(part.shape[1] for part in parts)
    fill = [width - part.shape[1] for part in parts]
    pairs = zip(parts, fill, strict=True)
    return [np.pad(part, ((0, 0), (0, more)), constant_values=lacking) if more else part for part, more in pairs]
