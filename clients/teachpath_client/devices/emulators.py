"""Devices without hardware: a protocol simulator behind a pty that can be made to fail.

It tears records, adds noise, pauses, is unplugged and plugged in again, at the path of a port and at a rate of its own.
A driver cannot tell it from a device on a serial line.
"""

from __future__ import annotations

import os
import pty
import random
import select
import threading
import time
import tty
from collections import deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Self

from teachpath_client.devices.protocol_simulators import ProtocolSimulator
from teachpath_client.reading import HandReading

Corruption = Callable[[bytes], bytes]

JOIN_TIMEOUT = 5.0  # [s] for the emulator's thread to leave
IDLE_WAIT = 0.02  # [s] between looks at an idle line


class Emulator:
    """A simulator on a pty; use it as a context manager.

    Args:
        simulator: the device.
        link: path of the port: a link to the pty, which comes and goes as a real device node does.
        rate: [Hz] of its stream.
        hold: when nothing is left to play, send the last reading again and again; otherwise be silent.
        hand: what it measures instead of what is played: a glove is on the hand that a tracker follows.
        corrupt: changes the bytes of a record on the wire.
        clock: [s] that never runs back.
    """

    def __init__(
        self,
        simulator: ProtocolSimulator,
        link: Path,
        *,
        rate: float,
        hold: bool = False,
        hand: Callable[[], HandReading] | None = None,
        corrupt: Corruption | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.simulator: ProtocolSimulator = simulator
        self._link, self._rate, self._hold = link, rate, hold
        self._hand = hand
        self.corrupt: Corruption | None = corrupt
        self._clock = clock
        self._script: deque[HandReading] = deque()
        self._now = HandReading(0.0, (0.0, 0.0, 0.0), None, (0.0,) * 22)
        self._master = self._slave = -1
        self._over = threading.Event()
        self._thread: threading.Thread | None = None
        self.intact: list[tuple[float, HandReading]] = []  # what went out undamaged, and when
        self.corrupted: int = 0  # records that did not
        self.played: threading.Event = threading.Event()  # all that was to be played went out

    def __enter__(self) -> Self:
        self.plug()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def play(self, readings: Iterable[HandReading]) -> None:
        """Send these next, one a period."""
        self.played.clear()
        self._script.extend(readings)

    def show(self, reading: HandReading) -> None:
        """Measure this from now on: what a polled device answers, and what a stream holds."""
        self._now = reading

    @property
    def now(self) -> HandReading:
        """What it measures now."""
        return self._now if self._hand is None else self._hand()

    def plug(self) -> None:
        """Plug the device in: its path appears, and it has forgotten its settings."""
        self.simulator.power_up()
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self._link.symlink_to(os.ttyname(self._slave))
        self._over.clear()
        self._thread = threading.Thread(target=self._run, name=f"emulate {self._link.name}", daemon=True)
        self._thread.start()

    def unplug(self) -> None:
        """Pull the device out: its path vanishes, and whoever reads it gets an error; a second call does nothing."""
        thread, self._thread = self._thread, None
        if thread is None:
            return
        self._link.unlink()
        self._over.set()
        thread.join(JOIN_TIMEOUT)
        os.close(self._master)
        os.close(self._slave)

    def _run(self) -> None:
        due = self._clock()
        while not self._over.is_set():
            wait = min(IDLE_WAIT, max(0.0, due - self._clock()))
            if select.select([self._master], [], [], wait)[0]:
                self._send(self.simulator.receive(os.read(self._master, 4096), self.now))
            now = self._clock()
            if now < due:
                continue
            due = due + 1.0 / self._rate if now - due < 1.0 / self._rate else now + 1.0 / self._rate
            if self.simulator.streaming:
                self._stream(now)

    def _stream(self, now: float) -> None:
        fresh = bool(self._script)
        if fresh:
            self._now = self._script.popleft()
        elif not self._hold:
            return
        record = self.simulator.record(self.now)
        wire = self.corrupt(record) if self.corrupt else record
        # The books are kept before the bytes go out, so that whoever reads the last record finds it in them.
        intact = record in wire
        if intact:
            self.intact.append((now, self._now))
        if fresh and not self._script:
            self.played.set()
        if not self._send(wire) and intact:
            self.intact.remove((now, self._now))
            intact = False
        self.corrupted += not intact

    def _send(self, content: bytes) -> bool:
        try:
            return os.write(self._master, content) == len(content)
        except BlockingIOError:  # nobody reads: a serial line loses it, too
            return False


class RecordCorrupter:
    """Corruption by chance: tears records and puts noise between them.

    Args:
        seed: same seed, same corruption.
        torn: share of the records of which only a beginning, an end, or neither is sent.
        noise: share of the records with random bytes before them.
    """

    def __init__(self, seed: int, *, torn: float = 0.1, noise: float = 0.1) -> None:
        self._random, self._torn, self._noise = random.Random(seed), torn, noise

    def __call__(self, record: bytes) -> bytes:
        """Return what of a record goes over the wire."""
        wire = record
        if self._random.random() < self._torn:
            start, end = sorted(self._random.sample(range(len(record) + 1), 2))
            wire = record[start : min(end, start + len(record) - 1)]
        if self._random.random() < self._noise:
            wire = self._random.randbytes(self._random.randint(1, 40)) + wire
        return wire
