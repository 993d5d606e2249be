"""The phases of a demonstration, from the glove: reach, transport (grasp to release), return."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from teachpath.recording.settings import RecordingSettings
from teachpath.records import Phase, Sample, Vector

GRASP_BUTTON = 1  # held
TOGGLE_BUTTON = 2  # pressed: pause or resume


@dataclass(frozen=True, slots=True)
class Cut:
    """Where a demonstration lies in its stream, as indices into the samples since the last cut."""

    grasp: int  # first sample of the transport phase
    release: int  # first sample after it
    open_ended: bool = False  # the stream ended while the hand was closed


class Segmenter:
    """Follows one hand and says when a demonstration is complete.

    The hand closes when its closure (mean flexion, or the grasp button) rises over `close_at`, opens when it falls
    under `open_at`; between the two it stays as it is. It grasps only within `grasp_radius` of the object. A
    demonstration is complete when the hand, open again, rests, or after `longest_return`, or with the next grasp.
    """

    def __init__(self, settings: RecordingSettings, carried: Vector | None, *, closed: bool = False) -> None:
        """Begin to follow a hand.

        Args:
            carried: start of the object's centre [m, world], or None: the hand grasps anywhere.
            closed: the hand may be closed already, so that it must open before it can grasp.
        """
        self._settings, self._carried = settings, carried
        self._closed = closed
        self._restart()

    def _restart(self) -> None:
        self.phase = Phase.REACH
        self._count = 0
        self._grasp = self._release = 0
        self._release_ns = 0
        self._recent: deque[tuple[int, Vector]] = deque()

    def push(self, sample: Sample, position: Vector) -> Cut | None:
        """Take the next sample and its hand position [m, world]; return the cut that it completes.

        The sample that completes a cut is the last one of it.
        """
        index, self._count = self._count, self._count + 1
        was_closed = self._closed
        self._closed = self._closes(sample)
        if self.phase is Phase.REACH and self._closed and not was_closed and self._near(position):
            self.phase, self._grasp = Phase.TRANSPORT, index
        elif self.phase is Phase.TRANSPORT and not self._closed:
            self.phase, self._release, self._release_ns = Phase.RETURN, index, sample.device_ns
            self._recent.clear()
        elif self.phase is Phase.RETURN and self._returned(sample, position, was_closed):
            return self._complete()
        return None

    def pass_over(self) -> None:
        """Count a sample that says nothing about the phase: a late one or a duplicate."""
        self._count += 1

    def finish(self) -> Cut | None:
        """Return the cut that the end of the stream completes, or None when nothing was grasped."""
        if self.phase is Phase.REACH:
            return None
        if self.phase is Phase.TRANSPORT:
            self._release = self._count
            return self._complete(open_ended=True)
        return self._complete()

    def _complete(self, *, open_ended: bool = False) -> Cut:
        cut = Cut(self._grasp, self._release, open_ended)
        self._restart()
        return cut

    def _closes(self, sample: Sample) -> bool:
        if sample.buttons & GRASP_BUTTON:
            return True
        if not sample.flexions:
            return False
        closure = sum(sample.flexions) / len(sample.flexions)
        return closure > (self._settings.open_at if self._closed else self._settings.close_at)

    def _near(self, position: Vector) -> bool:
        if self._carried is None:
            return True
        return math.dist(position, self._carried) <= self._settings.grasp_radius

    def _returned(self, sample: Sample, position: Vector, was_closed: bool) -> bool:
        self._recent.append((sample.device_ns, position))
        rest_ns = int(self._settings.rest_time * 1e9)
        while sample.device_ns - self._recent[0][0] > rest_ns:
            self._recent.popleft()
        whole = sample.device_ns - self._release_ns >= rest_ns
        spread = max(max(axis) - min(axis) for axis in zip(*(p for _, p in self._recent), strict=True))
        rests = whole and spread <= self._settings.rest_motion
        late = sample.device_ns - self._release_ns > self._settings.longest_return * 1e9
        return rests or late or (self._closed and not was_closed)
