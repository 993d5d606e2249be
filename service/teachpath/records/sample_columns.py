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

    @classmethod
    def of(cls, samples: Sequence[Sample]) -> SampleColumns:
        """Return samples of one tracker as columns."""
        if isinstance(samples, SampleColumns):
            return samples
        if not samples:
            return cls.of_values("", *((),) * 8)
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
    ) -> SampleColumns:
        """Return n samples, of each value of which there are n."""
        n = len(sequence)
        counts = np.fromiter(map(len, flexions), np.int64, n)
        bent = np.zeros((n, int(counts.max(initial=0))))
        bent[np.arange(bent.shape[1]) < counts[:, None]] = np.fromiter(chain.from_iterable(flexions), np.float64)
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
        )

    @classmethod
    def joined(cls, parts: Sequence[SampleColumns]) -> SampleColumns:
        """Return the samples of parts, of which there is at least one, one part after the other."""
        if len(parts) == 1:
            return parts[0]
        width = max(part.flexions.shape[1] for part in parts)
        values = {name: np.concatenate([getattr(part, name) for part in parts]) for name in COLUMNS - {"flexions"}}
        return cls(
            parts[0].tracker, flexions=np.concatenate([_padded(part.flexions, width) for part in parts]), **values
        )

    def select(self, chosen: slice | NDArray[Any], tracker: str = "") -> SampleColumns:
        """Return the samples that a slice, a mask or indices choose, as of another tracker where that is named."""
        return SampleColumns(tracker or self.tracker, *(getattr(self, name)[chosen] for name in ORDERED))

    @property
    def is_in_order(self) -> bool:
        """Whether the numbers rise, each once."""
        return bool(np.all(self.sequence[1:] > self.sequence[:-1]))

    def __len__(self) -> int:
        return len(self.sequence)

    def __iter__(self) -> Iterator[Sample]:
        plain = (getattr(self, name).tolist() for name in ORDERED)
        for sequence, device_ns, receive_ns, p, q, flexions, count, tracked, buttons in zip(*plain, strict=True):
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


ORDERED = tuple(field.name for field in fields(SampleColumns))[1:]
COLUMNS = frozenset(ORDERED)
VALUES = Sample._fields[1:]


def _padded(flexions: NDArray[Any], width: int) -> NDArray[Any]:
    lacking = width - flexions.shape[1]
    return np.pad(flexions, ((0, 0), (0, lacking))) if lacking else flexions
