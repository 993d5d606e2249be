"""What a tracker sends and what of it arrives, so that every count of a recorder can be held against the truth."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from teachpath.records import Array, Sample

RATE = 50.0  # [Hz]
PERIOD_NS = round(1e9 / RATE)
START_NS = 1_700_000_000_000_000_000
TRANSIT_NS = 1_000_000
OBJECT = (0.5, 0.0, 0.5)  # [m]
NOISE = 3e-4  # [m] of the tracker
OPEN_FLEXION, CLOSED_FLEXION = 0.1, 0.9


@dataclass(frozen=True, slots=True)
class Event:
    """One payload that arrives.

    Attributes:
        own: whether the tracker itself sent it; else it is another source's.
        refused: whether it cannot be used.
        readable: whether the number of a refused one can be read.
    """

    sample: Sample
    own: bool = True
    refused: bool = False
    readable: bool = True


@dataclass(frozen=True)
class Stream:
    """What arrives of one demonstration.

    Attributes:
        events: in the order in which they arrive.
        sent: how many samples the tracker sent, numbered from 1.
        transport: numbers of the first sample of the transport, and of the first after it.
    """

    events: tuple[Event, ...]
    sent: int
    transport: tuple[int, int]

    def truth(self) -> dict[str, int]:
        """Return what a recorder has to count; `misplaced` are those that came after newer ones."""
        counts = Counter({"conflicts": sum(not event.own for event in self.events)})
        seen: set[int] = set()
        highest = 0
        for event in self.events:
            number = event.sample.sequence
            if not event.own:
                continue
            if event.refused:
                counts["refused"] += 1
            elif number in seen:
                counts["duplicated"] += 1
            else:
                counts["misplaced"] += number < highest
                counts["untracked"] += not event.sample.tracked
                highest = max(highest, number)
            seen.add(number)
        counts["lost"] = self.sent - len(seen)
        counts["received"] = sum(not event.refused for event in self.events)
        return dict(counts)


@dataclass(frozen=True)
class Hand:
    """How a task is shown.

    Attributes:
        noise: of the tracker [m].
        samples: that carrying takes, least and most.
    """

    noise: float = NOISE
    samples: tuple[int, int] = (90, 130)


def any_hand(rng: np.random.Generator) -> Hand:
    """Return a hand that carries quickly or slowly, with a good or a poor tracker."""
    return Hand(10 ** rng.uniform(-4.0, -3.0), (50, 250))


USUAL_HAND = Hand()


def shown(rng: np.random.Generator, hand: Hand = USUAL_HAND) -> Stream:
    """Show a task without a fault: reach, take, carry along a bow, put, return and rest."""
    x, y, z = OBJECT
    away = rng.uniform(0.25, 0.35)
    places = np.concatenate(
        [
            _move(rng, (x, y + away, z), OBJECT, 50),
            np.tile(OBJECT, (int(rng.integers(8, 20)), 1)),
            _move(rng, OBJECT, (x + 0.4, y, z), int(rng.integers(*hand.samples)), bow=0.15),
            np.tile((x + 0.4, y, z), (int(rng.integers(8, 20)), 1)),
            _move(rng, (x + 0.4, y, z), (x + 0.4, y + away, z), 50),
            np.tile((x + 0.4, y + away, z), (30, 1)),
        ]
    )
    moving = np.flatnonzero(np.linalg.norm(np.diff(places, axis=0), axis=1) > 0.0)
    grasp = int(moving[moving > 50][0]) - 3
    release = int(moving[moving < len(places) - 81][-1]) + 5
    places = places + rng.normal(0.0, hand.noise, places.shape)
    events = []
    for k, place in enumerate(places.tolist()):
        closure = (CLOSED_FLEXION if grasp <= k < release else OPEN_FLEXION) + rng.uniform(-0.05, 0.05)
        stamp = START_NS + (k + 1) * PERIOD_NS
        transit = TRANSIT_NS + int(rng.exponential(2e6))
        events.append(Event(Sample("glove", k + 1, stamp, stamp + transit, tuple(place), None, (closure,) * 22, True)))
    return Stream(tuple(events), len(events), (grasp + 1, release + 1))


def changed(stream: Stream, events: list[Event]) -> Stream:
    """Return a stream of which other events arrive; each is received no earlier than the one before."""
    newest, received = 0, []
    for event in events:
        newest = max(newest, event.sample.receive_ns)
        received.append(replace(event, sample=event.sample._replace(receive_ns=newest)))
    return replace(stream, events=tuple(received))


def _move(
    rng: np.random.Generator, start: tuple[float, ...], goal: tuple[float, ...], count: int, *, bow: float = 0.0
) -> Array:
    """Return a minimum-jerk move (count, 3) [m] (Flash & Hogan 1985) with a bow upwards."""
    u = np.linspace(0.0, 1.0, count)
    s = u**3 * (10 - 15 * u + 6 * u**2)
    path = np.outer(1 - s, start) + np.outer(s, goal)
    path[:, 2] += bow * rng.uniform(0.8, 1.2) * np.sin(np.pi * s) ** 2
    return np.asarray(path)
