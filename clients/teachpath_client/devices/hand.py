"""The hand of the paper: a FASTRAK for its pose and a CyberGlove for its flexions, merged into one stream."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from typing import Self

from teachpath_client.devices.cyberglove import GloveSettings, GloveSource
from teachpath_client.devices.fastrak import FastrakSettings, FastrakSource
from teachpath_client.devices.source import Capabilities, configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading

READ_TIMEOUT = 0.1  # [s] a read waits
MAX_FLEXION_AGE, MAX_FLEXION_PERIODS = (
    0.1,
    3.0,
)  # [s], periods of the glove: how old the flexions of a pose may be at most


def hand(**options: str) -> HandSource:
    """Polhemus FASTRAK and CyberGlove together; fastrak.port=PATH, glove.port=PATH, glove.calibration=FILE."""
    parts: dict[str, dict[str, str]] = {"fastrak": {}, "glove": {}}
    for name, value in options.items():
        device, _, option = name.partition(".")
        if device not in parts or not option:
            raise ClientError(f"there is no option {name}; they begin with fastrak. or glove., e.g. glove.port")
        parts[device][option] = value
    fastrak = configure(FastrakSettings, parts["fastrak"], prefix="fastrak.")
    return HandSource(fastrak, configure(GloveSettings, parts["glove"], prefix="glove."))


class HandSource:
    """A tracker and a glove, live: one reading for each pose, with the flexions measured last before it.

    A pose whose flexions are missing or too old gives no reading: half a hand is not a hand.
    """

    def __init__(
        self, fastrak: FastrakSettings, glove: GloveSettings, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._fastrak = FastrakSource(fastrak, clock=clock)
        self._glove = GloveSource(glove, clock=clock)
        self._oldest = max(MAX_FLEXION_AGE, MAX_FLEXION_PERIODS / glove.rate)
        self._clock = clock
        self._stack = ExitStack()
        self._over = False

    @property
    def capabilities(self) -> Capabilities:
        """Pose and flexions, live, at the rate of the tracker."""
        glove = self._glove.capabilities
        return replace(self._fastrak.capabilities, sensors=glove.sensors, touch=glove.touch)

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stack.enter_context(self._fastrak)
            stack.enter_context(self._glove)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
        self._stack.close()

    def close(self) -> None:
        """End the iteration soon."""
        self._over = True

    def touch(self, holding: bool) -> None:
        """Start the vibration when the hand holds the object, or stop it."""
        self._glove.touch(holding)

    def __iter__(self) -> Iterator[HandReading]:
        pairing, start = Pairing(lambda: self._glove.next_reading(0.0), self._oldest), None
        while not self._over:
            taken = self._fastrak.next_reading(READ_TIMEOUT)
            # While no pose comes, flexions that are too old for the next one are thrown away.
            date = taken[0] if taken else self._clock() - self._oldest
            flexions = pairing.flexions_at(date)
            if taken is None or flexions is None:
                continue
            start = date if start is None else start
            yield replace(taken[1], time=date - start, flexions=flexions)


class Pairing:
    """Finds the flexions that were measured last before a pose.

    Args:
        take: gives the next reading of the glove that waits, with its date [s], or None.
        oldest: [s] how long before the pose they may have been measured.
    """

    def __init__(self, take: Callable[[], tuple[float, HandReading] | None], oldest: float) -> None:
        self._take, self._oldest = take, oldest
        self._newest: tuple[float, HandReading] | None = None  # the last one before the pose
        self._following: tuple[float, HandReading] | None = None  # the first one after it

    def flexions_at(self, date: float) -> tuple[float, ...] | None:
        """Return the flexions for a pose at time `date` [s], which never decreases; None without recent ones."""
        self._following = self._following or self._take()
        while self._following is not None and self._following[0] <= date:
            self._newest, self._following = self._following, self._take()
        if self._newest is None or date - self._newest[0] > self._oldest:
            return None
        return self._newest[1].flexions
