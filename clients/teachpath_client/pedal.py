"""A foot pedal as the operator's second hand: pedals are keyboards, read from the terminal or from the kernel.

Pressing it sets the pedal's bit in the samples, which tells the recorder to pause or to go on. A key of the terminal
has no release, so it counts as held for a moment; the kernel's device tells both.
"""

from __future__ import annotations

import os
import select
import struct
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Protocol

from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_client.terminal import Terminal, open_terminal

PEDAL_BIT = 2  # of HandSample.buttons
KEY_HOLD_TIME = 0.15  # [s] that a key of the terminal counts as held: some samples must carry it
EVENT = struct.Struct("llHHi")  # struct input_event of linux/input.h: time, type, code, value
KEY_EVENT, KEY_RELEASED, KEY_PRESSED = 0x01, 0, 1  # EV_KEY; value 2 repeats a key that is held
EVIOCGRAB = 0x40044590  # nobody else gets the keys, so that the pedal does not type into the terminal
NAMES = {"space": b" ", "enter": b"\n", "tab": b"\t"}  # of keys that a letter cannot name
KEYS = f"{', '.join(NAMES)}, a letter"
READ_TIMEOUT = 0.1  # [s] between looks whether it is over


class Pedal(Protocol):
    """Something that is pressed and released; use it as a context manager."""

    @property
    def is_down(self) -> bool:
        """Whether it is pressed now."""


def open_pedal(where: str) -> TerminalPedal | EventPedal:
    """Return the pedal at `where`: a device like /dev/input/event5, or a key of the terminal: space, enter, a letter.

    Raises:
        ClientError: it is neither.
    """
    if where.startswith("/"):
        return EventPedal(where)
    return TerminalPedal(where)


class _Pressed(ABC):
    """Listens on a thread of its own while the context is open."""

    def __init__(self) -> None:
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def _listen(self) -> None:
        with suppress(EOFError):
            while not self._ended.is_set():
                if content := self._read():
                    self._take(content)

    @abstractmethod
    def _read(self) -> bytes:
        """Return what came, nothing after a moment; raises EOFError when no more can come."""

    @abstractmethod
    def _take(self, content: bytes) -> None:
        """Take what came."""

    def _start(self) -> None:
        self._ended.clear()
        self._thread = threading.Thread(target=self._listen, name="pedal", daemon=True)
        self._thread.start()

    def _stop(self) -> None:
        self._ended.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None


class TerminalPedal(_Pressed):
    """One key of the terminal; Ctrl-C still ends the program."""

    def __init__(
        self, key: str, *, terminal: Terminal | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__()
        self._key = NAMES.get(key, key.encode())
        if len(self._key) != 1:
            raise ClientError(f"--pedal {key} is no key: name {KEYS}, or a device like /dev/input/event5")
        self._terminal, self._clock = terminal or open_terminal(), clock
        self._until = float("-inf")

    def __enter__(self) -> TerminalPedal:
        self._terminal.__enter__()
        self._start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()
        self._terminal.__exit__(None, None, None)

    @property
    def is_down(self) -> bool:
        """Whether the key came a moment ago."""
        return self._clock() < self._until

    def _read(self) -> bytes:
        return self._terminal.read(READ_TIMEOUT)

    def _take(self, content: bytes) -> None:
        if self._key in content.replace(b"\r", b"\n"):
            self._until = self._clock() + KEY_HOLD_TIME


class EventPedal(_Pressed):
    """A pedal's own device, on Linux; any of its keys counts. Nobody else gets its keys meanwhile."""

    def __init__(self, path: str) -> None:
        super().__init__()
        self._path, self._fd = path, -1
        self._down: set[int] = set()
        self._rest = b""

    def __enter__(self) -> EventPedal:
        try:
            import fcntl
        except ImportError:
            raise ClientError(f"--pedal {self._path}: devices are read on Linux alone; name a key: {KEYS}") from None
        try:
            self._fd = os.open(self._path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError as error:
            raise ClientError(
                f"cannot open the pedal {self._path}: {error.strerror}; is it plugged in, and are you in group input?"
            ) from None
        with suppress(OSError):  # what is no input device cannot be grabbed, and types nowhere
            fcntl.ioctl(self._fd, EVIOCGRAB, 1)
        self._start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()
        os.close(self._fd)

    @property
    def is_down(self) -> bool:
        """Whether one of its keys is pressed."""
        return bool(self._down)

    def _read(self) -> bytes:
        if not select.select([self._fd], [], [], READ_TIMEOUT)[0]:
            return b""
        try:
            content = os.read(self._fd, 4096)
        except BlockingIOError:
            return b""
        except OSError as error:
            self._down.clear()  # it was unplugged: it is not pressed
            raise EOFError(str(error)) from None
        if not content:
            raise EOFError("it has closed")
        return content

    def _take(self, content: bytes) -> None:
        self._rest += content
        whole = len(self._rest) - len(self._rest) % EVENT.size
        for _, _, kind, code, value in EVENT.iter_unpack(self._rest[:whole]):
            if kind == KEY_EVENT and value == KEY_PRESSED:
                self._down.add(code)
            elif kind == KEY_EVENT and value == KEY_RELEASED:
                self._down.discard(code)
        self._rest = self._rest[whole:]


def with_pedal(readings: Iterator[HandReading], pedal: Pedal) -> Iterator[HandReading]:
    """Yield the readings with the pedal's bit as it is pressed; at least one carries every press that lasts one."""
    for reading in readings:
        yield replace(reading, buttons=reading.buttons | PEDAL_BIT) if pedal.is_down else reading


@contextmanager
def pedal_or_none(where: str) -> Iterator[Callable[[Iterator[HandReading]], Iterator[HandReading]]]:
    """Open the pedal at `where`, if one is named; yields what puts its bit into readings."""
    if not where:
        yield lambda readings: readings
        return
    with open_pedal(where) as pedal:
        yield lambda readings: with_pedal(readings, pedal)
