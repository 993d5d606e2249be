"""The rules that a tracker's samples and queries must keep, judged by what it published during one recording.

They are the recorder's own limits (`teachpath_proto.sample_rules`) and, for what a station can set otherwise, its
defaults (section `recording` of the settings).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from google.protobuf.message import DecodeError

from teachpath_client.verdict import Verdict
from teachpath_proto.keys import is_name, name_refusal
from teachpath_proto.sample_rules import GRASP_BUTTON, MAX_SAMPLE_SIZE, sample_fault
from teachpath_proto.tracker_pb2 import HandSample, StartRecording, StopRecording

CLOSE_AT: Final = 0.6  # mean flexion above which an open hand counts as closed
OPEN_AT: Final = 0.4  # and below which a closed one counts as open
MIN_TRANSPORT: Final = 20  # samples from grasp to release
MIN_TRAVEL: Final = 0.01  # [m] of the hand while it is closed
MIN_RATE: Final = 20.0  # [Hz] of readings that differ while it is closed
CLOCK_TOLERANCE: Final = 0.1  # share by which the device's clock may differ from ours in rate
MAX_CLOCK_OFFSET: Final = 86_400.0  # [s] from ours; more is another epoch or unit
MIN_CLOCK_SPAN: Final = 0.5  # [s] a shorter recording says nothing of the clock's rate
NOT_SHOWN: Final = "show the task once: close the hand, carry the object on, open the hand"


@dataclass(frozen=True)
class Received:
    """One payload that came on a key of samples."""

    tracker: str  # as its key names it
    payload: bytes
    receive_ns: int  # our clock [ns since the Unix epoch]
    blocks: bool = True  # published with congestion control "block"


@dataclass
class Observation:
    """What came from a tracker during one recording; the bench fills it.

    Attributes:
        received: the payloads, in the order in which they came.
        announced: names for which liveliness tokens were shown.
        started, stopped: the queries that began and ended the recording; None: there was none.
    """

    received: list[Received] = field(default_factory=list)
    announced: set[str] = field(default_factory=set)
    started: StartRecording | None = None
    stopped: StopRecording | None = None


def verdicts(seen: Observation) -> Iterator[Verdict]:
    """Yield the verdict of every rule; where no sample can be read, of the first rules alone."""
    yield Verdict("publishes under one name that can be a tracker's", _name_fault(seen))
    sound = _sound(seen)
    samples = [sample for _, sample in sound]
    yield Verdict("sends only samples that the recorder takes", _sample_fault(seen, samples))
    if not samples:
        return
    yield Verdict("numbers its samples one by one and loses none", _number_fault(samples))
    yield Verdict("waits where the line is slow (congestion control: block)", _congestion_fault(seen))
    yield Verdict("stamps samples by a clock that counts nanoseconds since the Unix epoch", _clock_fault(sound))
    closed = _closed_span(samples)
    yield Verdict("closes the hand, carries and opens it, as the recorder reads it", _grasp_fault(samples, closed))
    yield Verdict(f"gives at least {MIN_RATE:g} new readings a second while it carries", _rate_fault(closed))
    yield Verdict("announces itself by a liveliness token", _liveliness_fault(seen))
    yield Verdict("ends what it began, and names the last number", _handshake_fault(seen, samples))


def _name_fault(seen: Observation) -> str:
    names = sorted({one.tracker for one in seen.received})
    if not names:
        return "no sample came: publish on <prefix>/trackers/<name>/samples"
    if len(names) > 1:
        return f"samples came under {len(names)} names, {', '.join(names[:5])}: check one tracker at a time"
    return "" if is_name(names[0]) else name_refusal("tracker", names[0])


def _sound(seen: Observation) -> list[tuple[int, HandSample]]:
    """Return the samples that the recorder takes, and when they came [ns]."""
    parsed = ((one.receive_ns, _parsed(one.payload)) for one in seen.received)
    return [(came, sample) for came, sample in parsed if sample is not None and not _values(sample)]


def _parsed(payload: bytes) -> HandSample | None:
    try:
        return HandSample.FromString(payload) if len(payload) <= MAX_SAMPLE_SIZE else None
    except DecodeError:
        return None


def _values(sample: HandSample) -> str:
    p, q = sample.position, sample.orientation
    turn, flexions, joints = (q.w, q.x, q.y, q.z), tuple(sample.flexions), tuple(sample.joints)
    return sample_fault((p.x, p.y, p.z), turn, flexions, sample.device_ns, joints)


def _sample_fault(seen: Observation, samples: Sequence[HandSample]) -> str:
    refused = len(seen.received) - len(samples)
    for place, one in enumerate(seen.received, start=1):
        if len(one.payload) > MAX_SAMPLE_SIZE:
            fault = f"{len(one.payload)} bytes, limit {MAX_SAMPLE_SIZE}"
        elif (sample := _parsed(one.payload)) is None:
            fault = "it is no HandSample of tracker.proto"
        else:
            fault = _values(sample)
        if fault:
            return f"{refused} of {len(seen.received)} samples are refused; the first is sample {place}: {fault}"
    return ""


def _number_fault(samples: Sequence[HandSample]) -> str:
    for before, sample in itertools.pairwise(samples):
        step = sample.sequence - before.sequence
        if step != 1:
            what = f"{step - 1} numbers are missing" if step > 1 else "numbers count up and are used once"
            return f"number {sample.sequence} comes after {before.sequence}: {what}"
    return ""


def _congestion_fault(seen: Observation) -> str:
    dropping = sum(not one.blocks for one in seen.received)
    return f"{dropping} samples may be dropped on the way; declare the publisher with BLOCK" if dropping else ""


def _clock_fault(sound: Sequence[tuple[int, HandSample]]) -> str:
    samples = [sample for _, sample in sound]
    stamps = [sample.device_ns for sample in samples]
    back = next((i for i, (a, b) in enumerate(itertools.pairwise(stamps)) if b <= a), None)
    if back is not None:
        number, step = samples[back + 1].sequence, (stamps[back + 1] - stamps[back]) / 1e9
        return f"the time of number {number} is {-step:g} s before that of the number before; it must go on"
    first = sound[0][0]
    theirs = [(stamp - stamps[0]) / 1e9 for stamp in stamps]
    ours = [(came - first) / 1e9 for came, _ in sound]
    if ours[-1] >= MIN_CLOCK_SPAN:
        span = theirs[-1] * _clock_rate(theirs, ours)
        if abs(theirs[-1] - span) > CLOCK_TOLERANCE * span:
            return f"{theirs[-1]:.4g} s of its clock went by in {span:.4g} s of ours; are the stamps nanoseconds?"
    offset = abs(first - stamps[0]) / 1e9
    if offset > MAX_CLOCK_OFFSET:
        return f"its clock is {offset / 86_400:.0f} days from ours; count from the Unix epoch, not from the start"
    return ""


def _clock_rate(theirs: Sequence[float], ours: Sequence[float]) -> float:
    """Return how many seconds of our clock go by in one of theirs.

    Samples come late or in time, and never too early: a machine that stalls delays some. So the rate is that of the
    line under all of them that is nearest to them (Moon, Skelly and Towsley 1999): the edge of their lower convex hull
    above the mean of their times.

    Args:
        theirs: when samples were taken, by their clock [s]; increasing.
        ours: when they came, by ours [s].
    """
    hull: list[tuple[float, float]] = []
    for x, y in zip(theirs, ours, strict=True):
        while len(hull) > 1 and _is_above(hull[-2], hull[-1], (x, y)):
            hull.pop()
        hull.append((x, y))
    middle = sum(theirs) / len(theirs)
    (x0, y0), (x1, y1) = next((a, b) for a, b in itertools.pairwise(hull) if b[0] >= middle)
    return (y1 - y0) / (x1 - x0)


def _is_above(before: tuple[float, float], point: tuple[float, float], after: tuple[float, float]) -> bool:
    """Tell whether a point lies on or above the line from the one before to the one after it."""
    (x0, y0), (x, y), (x1, y1) = before, point, after
    return (y - y0) * (x1 - x0) >= (y1 - y0) * (x - x0)


def _closed_span(samples: Sequence[HandSample]) -> list[HandSample]:
    """Return the longest stretch of samples in which the hand is closed and after which it opens."""
    longest: list[HandSample] = []
    current: list[HandSample] = []
    for sample in samples:
        if _closure(sample) > (OPEN_AT if current else CLOSE_AT):
            current.append(sample)
        else:
            longest, current = max(longest, current, key=len), []
    return longest


def _closure(sample: HandSample) -> float:
    if sample.buttons & GRASP_BUTTON:
        return 1.0
    return sum(sample.flexions) / len(sample.flexions) if sample.flexions else 0.0


def _grasp_fault(samples: Sequence[HandSample], closed: Sequence[HandSample]) -> str:
    if not closed:
        low, high = min(map(_closure, samples)), max(map(_closure, samples))
        return (
            f"the hand never closed and opened: its closure went from {low:.2f} to {high:.2f}, it closes over "
            f"{CLOSE_AT:g} and opens under {OPEN_AT:g} (mean flexion, or bit 0 of the buttons); {NOT_SHOWN}"
        )
    if len(closed) < MIN_TRANSPORT:
        return f"the hand was closed for {len(closed)} samples, {MIN_TRANSPORT} make a demonstration; {NOT_SHOWN}"
    travel = max(math.dist(_position(sample), _position(closed[0])) for sample in closed)
    if travel < MIN_TRAVEL:
        return f"the closed hand moved {travel:.4f} m, {MIN_TRAVEL:g} m is carrying; {NOT_SHOWN}"
    return ""


def _rate_fault(closed: Sequence[HandSample]) -> str:
    span = (closed[-1].device_ns - closed[0].device_ns) / 1e9 if closed else 0.0
    if not span > 0.0:
        return ""  # the rule on grasping, or on the clock, says why
    new = sum(_position(a) != _position(b) for a, b in itertools.pairwise(closed))
    rate = new / span
    return "" if rate >= MIN_RATE else f"{rate:.1f} a second; a reading that is sent twice is no measurement"


def _position(sample: HandSample) -> tuple[float, float, float]:
    return sample.position.x, sample.position.y, sample.position.z


def _liveliness_fault(seen: Observation) -> str:
    name = seen.received[0].tracker
    if name in seen.announced:
        return ""
    others = f" (shown: {', '.join(sorted(seen.announced))})" if seen.announced else ""
    return f"no token on <prefix>/alive/tracker/{name}{others}: a tracker that dies is missed after 2 s only"


def _handshake_fault(seen: Observation, samples: Sequence[HandSample]) -> str:
    if seen.started is None and seen.stopped is None:
        return ""  # somebody at the page begins and ends its recordings
    if seen.stopped is None:
        return "it asked recorder/start and never recorder/stop: the station waits for more"
    names = {one.tracker for one in (seen.started, seen.stopped) if one is not None} | {seen.received[0].tracker}
    if len(names) > 1:
        return f"samples, start and stop name different trackers: {', '.join(sorted(names))}"
    highest = max(sample.sequence for sample in samples)
    if seen.stopped.last_sequence != highest:
        return (
            f"recorder/stop names {seen.stopped.last_sequence} as the last number; the highest that came is {highest}"
        )
    return ""
