"""Runs of samples that came one after the other, in which nothing changes that could begin or end a phase.

The samples of a run are counted and kept at once. Most samples lie in long runs: a hand that reaches, or carries.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from teachpath.recording.phases import TOGGLE_BUTTON
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Array, SampleColumns, Vector
from teachpath_proto.sample_rules import GRASP_BUTTON

ROUNDING = 1e-9  # a closure so near to a limit is decided on by `hand_closure` alone


class Grip(IntEnum):
    """How far a hand is closed, between the limits of `RecordingSettings`."""

    OPEN = 0  # not over `open_at`
    BETWEEN = 1
    CLOSED = 2  # over `close_at`
    FIST = 3  # over `fist_at`


class SampleRun(NamedTuple):
    """Samples of a block, from `begin` to before `end`.

    Attributes:
        is_steady: consecutive numbers, a clock that rises in small steps, one grip; False: nothing is known of the
            samples, and they are added one by one.
        grip: of all of them.
        has_flexions: whether the glove says them.
        pedal: whether it is pressed in all of them.
    """

    begin: int
    end: int
    is_steady: bool
    grip: int
    has_flexions: bool
    pedal: bool


class SampleBlock:
    """Samples in the order received, those of each tracker together, and their runs.

    Args:
        columns: of all samples.
        usable: (n,) which of them are decoded.
        starts: index of the first sample of each tracker.
        settings: limits of the recording.

    Attributes:
        sequence, device_ns, receive_ns, tracked, buttons: of the samples, as plain values.
        transit_ns: receive_ns less device_ns.
        step_ns: device_ns less that of the sample before; of no meaning where a tracker begins.
    """

    def __init__(
        self, columns: SampleColumns, usable: NDArray[np.bool_], starts: Sequence[int], settings: RecordingSettings
    ) -> None:
        self.columns: SampleColumns = columns
        self._positions: list[list[float]] = []  # made when somebody asks
        steps = np.diff(columns.device_ns, prepend=columns.device_ns[:1])
        self.sequence: list[int] = columns.sequence.tolist()
        self.device_ns: list[int] = columns.device_ns.tolist()
        self.receive_ns: list[int] = columns.receive_ns.tolist()
        self.tracked: list[bool] = columns.tracked.tolist()
        self.buttons: list[int] = columns.buttons.tolist()
        self.step_ns: list[int] = steps.tolist()
        self.transit_ns: list[int] = (columns.receive_ns.astype(np.int64) - columns.device_ns).tolist()
        self._runs = iter(self._find_runs(columns, usable, steps, starts, settings))

    def position(self, at: int) -> Vector:
        """Return the position of a sample [m, tracker]."""
        if not self._positions:
            self._positions = self.columns.position.tolist()
        x, y, z = self._positions[at]
        return x, y, z

    def next_runs(self, end: int) -> Iterator[SampleRun]:
        """Yield the runs of the next tracker, whose samples end before `end`."""
        for run in self._runs:
            yield run
            if run.end == end:
                return

    @staticmethod
    def _find_runs(
        columns: SampleColumns,
        usable: NDArray[np.bool_],
        steps: NDArray[np.int64],
        starts: Sequence[int],
        settings: RecordingSettings,
    ) -> list[SampleRun]:
        closure, certain = closures(columns, settings)
        grips = (closure > settings.open_at).astype(np.int64)
        grips += closure > settings.close_at
        grips += closure > settings.fist_at
        steady = usable & certain
        flexions = columns.flexion_count > 0
        pedal = columns.buttons & TOGGLE_BUTTON
        kinds = ((grips * 2 + flexions) * 2 + (pedal > 0)) * 2 + steady
        follows = columns.sequence[1:] == columns.sequence[:-1] + np.uint64(1)
        follows &= (steps[1:] > 0) & (steps[1:] <= round(settings.largest_clock_step * 1e9))
        follows &= kinds[1:] == kinds[:-1]
        begins = np.concatenate([[True], ~follows])
        begins[np.asarray(starts, np.int64)] = True
        firsts = np.flatnonzero(begins)
        ends = [*firsts[1:].tolist(), len(columns)]
        values = (each[firsts].tolist() for each in (steady, grips, flexions, pedal > 0))
        return [SampleRun(*run) for run in zip(firsts.tolist(), ends, *values, strict=True)]


def closures(columns: SampleColumns, settings: RecordingSettings) -> tuple[Array, NDArray[np.bool_]]:
    """Return how far the hand is closed in each sample (n,), and (n,) whether it is certainly under or over limits."""
    counts = np.maximum(columns.flexion_count, 1)
    closure = columns.flexions.sum(axis=1, dtype=np.float64) / counts
    closure[columns.buttons & GRASP_BUTTON > 0] = 1.0
    limits = np.array([settings.open_at, settings.close_at, settings.fist_at])
    exact = columns.buttons & GRASP_BUTTON > 0
    return closure, exact | (np.abs(closure[:, None] - limits) > ROUNDING).all(axis=1)
