"""The phases of a demonstration, told from the glove: reach, grasp, transport, release, return."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from teachpath.recording.settings import RecordingSettings
from teachpath.records import Phase, Sample, Vector
from teachpath_proto.sample_rules import GRASP_BUTTON

HALF_CLOSED_TIME = 0.5  # [s] after which a hand at the object that is neither open nor closed is told so
FAR_AWAY = 0.5  # [m] from the object; a hand that closes there may be mapped to the wrong place
TOGGLE_BUTTON = 2  # bit of Sample.buttons; pressed to pause or resume


@dataclass(frozen=True, slots=True)
class TransportSpan:
    """The transport phase of a take, as indices into its samples."""

    grasp: int  # first sample with the object in the hand
    release: int  # first sample after that
    open_ended: bool = False  # the stream ended while the hand was closed


def hand_closure(sample: Sample) -> float:
    """Return how far a hand is closed, 0 (open) to 1: the mean of its flexions, or the grasp button."""
    if sample.buttons & GRASP_BUTTON:
        return 1.0
    return sum(sample.flexions) / len(sample.flexions) if sample.flexions else 0.0


class Segmenter:
    """Follows the phases of one hand and cuts the stream of its samples into takes.

    The hand closes when its closure rises over `close_at`, and opens when it falls under `open_at`. A hand that closes
    within `grasp_radius` of the object grasps it.

    - reach: until the hand grasps the object.
    - grasp: until the hand has moved the object by `lift`; if it opens before, it reaches again.
    - transport: until the hand opens.
    - release: until the hand has been open for `release_time`; if it closes before, the transport goes on.
    - return: until the open hand rests, at most for `longest_return`, or until it grasps the object, which is back in
      its place, again. Then the take is complete.
    """

    def __init__(self, settings: RecordingSettings, carried: Vector | None, *, closed: bool = False) -> None:
        """Begin to follow a hand.

        Args:
            carried: start of the object's centre [m, world], or None: the hand grasps anywhere. Set it anew when the
                object lies elsewhere.
            closed: the hand may be closed already; it must open before it can grasp.
        """
        self._settings = settings
        self.carried: Vector | None = carried
        self._closed = closed
        self._release_ns = round(settings.release_time * 1e9)
        self._rest_ns = round(settings.rest_time * 1e9)
        self._restart()

    def _restart(self) -> None:
        self.phase: Phase = Phase.REACH
        self._count = 0
        self._grasp = self._release = 0
        self._opened_ns = 0
        self._place: Vector = (0.0, 0.0, 0.0)  # where the hand closed
        self._half_closed_ns = 0  # since when it is neither open nor closed at the object; 0: it is not
        self.hint: str = ""  # why the hand has grasped nothing, and what to do
        self._recent: deque[tuple[int, Vector]] = deque()

    @property
    def grasp(self) -> int:
        """Where the hand grasped the object, as an index into the samples of the take; 0 while it reaches."""
        return self._grasp

    def push(self, sample: Sample, position: Vector) -> TransportSpan | None:
        """Add the next sample and its hand position [m, world]; return the span of the take that it completes.

        The sample that completes a take is its last one, except for a grasp, which is the first of the next take.
        """
        index, self._count = self._count, self._count + 1
        was_closed = self._closed
        closure = hand_closure(sample)
        self._closed = closure > (self._settings.open_at if was_closed else self._settings.close_at)
        grasps = self._closed and not was_closed and self._near(position)
        if self.phase is Phase.REACH:
            self._advise(sample, position, closure, closes=self._closed and not was_closed)
            if grasps:
                self._take_hold(index, position)
        elif self.phase is Phase.GRASP:
            self._follow_grasp(position)
        elif self.phase is Phase.TRANSPORT:
            if not self._closed:
                self.phase, self._release, self._opened_ns = Phase.RELEASE, index, sample.device_ns
                self._recent.clear()
                self._recent.append((sample.device_ns, position))
        elif self.phase is Phase.RELEASE and self._closed:
            self.phase = Phase.TRANSPORT
        else:
            return self._follow_return(sample, position, grasps)
        return None

    def push_unchanged(
        self, grip: int, device_ns: Sequence[int], places: range, position: Callable[[int], Vector]
    ) -> int:
        """Add the next samples, as many as change neither phase nor hint; return how many.

        Args:
            grip: where the closures of all of them lie: 0: under `open_at`, 1: under `close_at`, 2 or more: over that.
            device_ns: by place.
            places: of the samples.
            position: returns that at a place [m, world].
        """
        count = self._count_unchanged(grip, device_ns, places, position)
        self._count += count
        return count

    def _count_unchanged(
        self, grip: int, device_ns: Sequence[int], places: range, position: Callable[[int], Vector]
    ) -> int:
        if self.phase is Phase.REACH:
            if (grip < 2) if self._closed else grip:
                return 0
            self._half_closed_ns = 0
            return len(places)
        if self.phase is Phase.TRANSPORT:
            return len(places) if grip else 0
        if self.phase is not Phase.GRASP:
            return 0 if grip else self._follow_open(device_ns, places, position)
        if not grip:
            return 0
        lifted = (k for k, at in enumerate(places) if math.dist(position(at), self._place) > self._settings.lift)
        return next(lifted, len(places))

    def _follow_open(self, device_ns: Sequence[int], places: range, position: Callable[[int], Vector]) -> int:
        """Follow an open hand after its release, as `_follow_return`, until phase or take end; return how far."""
        returns = self.phase is Phase.RETURN
        limit_ns = self._settings.longest_return * 1e9 if returns else self._release_ns - 1
        for count, at in enumerate(places):
            now_ns = device_ns[at]
            since = now_ns - self._opened_ns
            if since > limit_ns:
                return count
            self._recent.append((now_ns, position(at)))
            if returns and since >= self._rest_ns and self._rests(now_ns):
                self._recent.pop()
                return count
            self._closed = False
        return len(places)

    def skip(self) -> None:
        """Count a sample that is not used for the phase: a late one or a duplicate."""
        self._count += 1

    def finish(self) -> TransportSpan | None:
        """Return the span of the take that the end of the stream completes, or None if nothing was grasped."""
        if self.phase is Phase.REACH:
            return None
        if self.phase.is_hand_closed:
            self._release = self._count
            return self._complete(open_ended=True)
        return self._complete()

    def _take_hold(self, index: int, position: Vector) -> None:
        self.phase, self._grasp, self._place, self.hint = Phase.GRASP, index, position, ""

    def _advise(self, sample: Sample, position: Vector, closure: float, *, closes: bool) -> None:
        """Say why the hand grasps nothing: too far from the object, or not closed enough."""
        if closes and self.carried is not None:
            distance, limit = math.dist(position, self.carried), self._settings.grasp_radius
            self.hint = (
                f"the hand closed {100 * distance:.3g} cm from the object, limit {100 * limit:.3g} cm: close it there"
            )
            if distance > FAR_AWAY:
                self.hint += "; if it was there, measure the calibration anew or mend the object's place in the scene"
        if not (self._settings.open_at < closure <= self._settings.close_at and self._near(position)):
            self._half_closed_ns = 0
        elif not self._half_closed_ns:
            self._half_closed_ns = sample.device_ns
        elif sample.device_ns - self._half_closed_ns >= HALF_CLOSED_TIME * 1e9:
            self.hint = (
                f"the glove reads {closure:.2f} at the object and counts as closed over {self._settings.close_at:g}: "
                "close the hand further, or calibrate the glove"
            )

    def _follow_grasp(self, position: Vector) -> None:
        if not self._closed:
            self.phase = Phase.REACH
        elif math.dist(position, self._place) > self._settings.lift:
            self.phase = Phase.TRANSPORT

    def _follow_return(self, sample: Sample, position: Vector, grasps: bool) -> TransportSpan | None:
        self._recent.append((sample.device_ns, position))
        since = sample.device_ns - self._opened_ns
        if self.phase is Phase.RELEASE:
            if since >= self._release_ns:
                self.phase = Phase.RETURN
            return None
        if grasps:
            cut = self._complete()
            self._count = 1
            self._take_hold(0, position)
            return cut
        rests = since >= self._rest_ns and self._rests(sample.device_ns)
        return self._complete() if rests or since > self._settings.longest_return * 1e9 else None

    def _complete(self, *, open_ended: bool = False) -> TransportSpan:
        cut = TransportSpan(self._grasp, self._release, open_ended)
        self._restart()
        return cut

    def _near(self, position: Vector) -> bool:
        if self.carried is None:
            return True
        return math.dist(position, self.carried) <= self._settings.grasp_radius

    def _rests(self, now_ns: int) -> bool:
        while now_ns - self._recent[0][0] > self._rest_ns:
            self._recent.popleft()
        (_, first), (_, last) = self._recent[0], self._recent[-1]
        if max(abs(a - b) for a, b in zip(first, last, strict=True)) > self._settings.rest_motion:
            return False  # a hand that is on its way needs no look at all its places
        spread: float = max(max(axis) - min(axis) for axis in zip(*(p for _, p in self._recent), strict=True))
        return spread <= self._settings.rest_motion
