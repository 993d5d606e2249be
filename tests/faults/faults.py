"""Faults of a tracker's stream: each takes a stream and a strength, and returns what arrives; they can be composed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tests.faults.streams import OPEN_FLEXION, PERIOD_NS, RATE, Event, Stream, changed

Change = Callable[[Stream, np.random.Generator, float], Stream]
FAST_SHARE = 0.5  # of the greatest speed; faster parts of the transport are where a freeze can be told from a rest


@dataclass(frozen=True)
class Fault:
    """One kind of fault.

    Attributes:
        unit: of its strength.
        strengths: that are tried, rising from weak to strong.
        limit: a demonstration with a stronger fault is never clean.
        rejected: one with a stronger fault is never learned from; None: how much is tolerated depends on the rest.
        exact: whether every sample can be told to be its own or another's, so that all counts must be right.
        change: makes the fault.
    """

    key: str
    unit: str
    strengths: tuple[float, ...]
    limit: float
    rejected: float | None
    change: Change
    exact: bool = True


def _carried(stream: Stream, *, margin: int = 2) -> list[int]:
    """Return the places of the events of the transport, but for a margin at both ends."""
    first, after = stream.transport
    return [i for i, e in enumerate(stream.events) if first + margin <= e.sample.sequence < after - margin]


def _chosen(stream: Stream, rng: np.random.Generator, count: float) -> set[int]:
    return set(rng.choice(_carried(stream), int(count), replace=False).tolist())


def drop(stream: Stream, rng: np.random.Generator, count: float) -> Stream:
    """Lose single samples of the transport."""
    lost = _chosen(stream, rng, count)
    return changed(stream, [e for i, e in enumerate(stream.events) if i not in lost])


def burst(stream: Stream, rng: np.random.Generator, seconds: float) -> Stream:
    """Lose all samples of a time."""
    length = round(seconds * RATE)
    at = int(rng.choice(_carried(stream)[:-length]))
    return changed(stream, [*stream.events[:at], *stream.events[at + length :]])


def delay(stream: Stream, rng: np.random.Generator, places: float) -> Stream:
    """Let a sample of the reach or the transport arrive later."""
    at = int(rng.integers(1, stream.transport[1] - 2))
    events = list(stream.events)
    moved = events.pop(at)
    return changed(stream, [*events[: at + int(places)], moved, *events[at + int(places) :]])


def swap(stream: Stream, rng: np.random.Generator, count: float) -> Stream:
    """Swap neighbours."""
    events = list(stream.events)
    for i in sorted(_chosen(stream, rng, count)):
        events[i], events[i + 1] = events[i + 1], events[i]
    return changed(stream, events)


def swap_first(stream: Stream, _rng: np.random.Generator, count: float) -> Stream:
    """Let the first samples arrive in reverse order."""
    n = int(count)
    return changed(stream, [*reversed(stream.events[:n]), *stream.events[n:]])


def double(stream: Stream, rng: np.random.Generator, count: float) -> Stream:
    """Let samples arrive twice."""
    twice = _chosen(stream, rng, count)
    return changed(stream, [e for i, e in enumerate(stream.events) for _ in range(1 + (i in twice and not e.refused))])


def refuse(stream: Stream, rng: np.random.Generator, count: float) -> Stream:
    """Send payloads that cannot be used; of half of them not even the number can be read.

    What comes twice is left as it is: of a broken copy nobody can tell whether it was a sample of its own.
    """
    copies = Counter(e.sample.sequence for e in stream.events)
    chosen = {i for i in _chosen(stream, rng, count) if copies[stream.events[i].sample.sequence] == 1}
    return changed(
        stream,
        [
            replace(e, refused=True, readable=bool(rng.integers(2))) if i in chosen else e
            for i, e in enumerate(stream.events)
        ],
    )


def untrack(stream: Stream, rng: np.random.Generator, count: float) -> Stream:
    """Lose sight of the hand."""
    chosen = _chosen(stream, rng, count)
    return _mapped(stream, lambda i, e: replace(e, sample=e.sample._replace(tracked=i not in chosen)))


def freeze(stream: Stream, rng: np.random.Generator, seconds: float) -> Stream:
    """Repeat one pose while the hand carries fast, and all else goes on."""
    length, carried = round(seconds * RATE), _carried(stream)
    places = np.array([stream.events[i].sample.position for i in carried])
    speed = np.convolve(np.linalg.norm(np.diff(places, axis=0), axis=1), np.ones(7) / 7, "same")
    fast = [k for k in np.flatnonzero(speed > FAST_SHARE * speed.max()) if k + length < len(carried)]
    first = carried[int(rng.choice(fast))]
    pose = stream.events[first].sample.position
    return _mapped(
        stream,
        lambda i, e: replace(e, sample=e.sample._replace(position=pose)) if first < i < first + length else e,
    )


def stale(stream: Stream, _rng: np.random.Generator, times: float) -> Stream:
    """Send each pose several times, as from a tracker that measures more rarely."""
    poses = [e.sample.position for e in stream.events]
    return _mapped(
        stream, lambda i, e: replace(e, sample=e.sample._replace(position=poses[i // int(times) * int(times)]))
    )


def share_name(stream: Stream, rng: np.random.Generator, ahead: float) -> Stream:
    """Let a second tracker send under the same name, its numbers `ahead` and its clock a little off."""
    events = []
    for event in stream.events:
        x, y, z = event.sample.position
        stamp = event.sample.device_ns + PERIOD_NS // 2 + int(rng.integers(0, 1000))
        other = event.sample._replace(
            sequence=event.sample.sequence + int(ahead),
            device_ns=stamp,
            receive_ns=event.sample.receive_ns + PERIOD_NS // 2,
            position=(x, y + 0.3, z),
        )
        events += [event, Event(other, own=False)]
    return changed(stream, events)


def mix_hands(stream: Stream, _rng: np.random.Generator, apart: float) -> Stream:
    """Let every second sample be of a hand beside the first one, with the numbers and the clock of one source."""

    def other(i: int, event: Event) -> Event:
        x, y, z = event.sample.position
        return replace(event, sample=event.sample._replace(position=(x, y + apart * (i % 2), z)))

    return _mapped(stream, other)


def step_clock(stream: Stream, rng: np.random.Generator, seconds: float) -> Stream:
    """Set the device's clock while the hand carries."""
    at = int(rng.choice(_carried(stream, margin=12)))
    step = round(seconds * 1e9)
    return _mapped(
        stream,
        lambda i, e: replace(e, sample=e.sample._replace(device_ns=e.sample.device_ns + step)) if i >= at else e,
    )


def flap(stream: Stream, rng: np.random.Generator, times: float) -> Stream:
    """Let the glove read open for two samples and closed for two, again and again, while the hand carries."""
    length = 4 * int(times)
    carried = _carried(stream, margin=20)
    at = int(rng.choice(carried[: len(carried) - length]))
    opened = {i for k in range(int(times)) for i in (at + 4 * k, at + 4 * k + 1)}
    return _mapped(
        stream, lambda i, e: replace(e, sample=e.sample._replace(flexions=(OPEN_FLEXION,) * 22)) if i in opened else e
    )


def let_go(stream: Stream, rng: np.random.Generator, seconds: float) -> Stream:
    """Let the glove read open for a time while the hand carries."""
    length, carried = round(seconds * RATE), _carried(stream, margin=25)
    at = int(rng.choice(carried[: len(carried) - length]))
    return _mapped(
        stream,
        lambda i, e: (
            replace(e, sample=e.sample._replace(flexions=(OPEN_FLEXION,) * 22)) if at <= i < at + length else e
        ),
    )


def _mapped(stream: Stream, change: Callable[[int, Event], Event]) -> Stream:
    return changed(stream, [change(i, event) for i, event in enumerate(stream.events)])


FAULTS = (
    Fault("drop", "samples", (1, 3, 20), 0, None, drop),
    Fault("burst", "s", (0.06, 0.2, 0.4), 0, 0.25, burst),
    Fault("delay", "places", (1, 5, 35, 200), 0, None, delay),
    Fault("swap", "pairs", (1, 5), 0, None, swap),
    Fault("swap_first", "samples", (2, 10), 0, None, swap_first),
    Fault("double", "samples", (1, 10), 0, None, double),
    Fault("refuse", "samples", (1, 3, 20), 0, None, refuse),
    Fault("untrack", "samples", (1, 3, 20), 0, None, untrack),
    Fault("freeze", "s", (0.04, 0.12, 0.2, 0.5), 0.1, 0.1, freeze),
    Fault("stale", "readings", (2, 3, 5, 10), 1, 50.0 / 20.0, stale),
    Fault("share_name", "numbers", (7, 500, 100_000_000), float("-inf"), float("-inf"), share_name, False),
    Fault("mix_hands", "m", (0.02, 0.06, 0.1, 0.3), 0.051, 0.051, mix_hands),
    Fault("flap", "times", (1, 2, 4, 8), 0, 2, flap),
    Fault("let_go", "s", (0.04, 0.14, 0.2), 0, 0.1, let_go),
    Fault("step_clock", "s", (-0.5, 0.05, 0.15, 0.5, 60.0), 0.12, 0.12, step_clock),
)
