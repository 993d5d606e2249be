"""Single keys of the operator's terminal, as they are typed: of a POSIX terminal or a Windows console."""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Protocol, Self

from teachpath_client.errors import ClientError

NO_TERMINAL = "--pedal needs a terminal to read the key from; name a device such as /dev/input/event5"
POLL_PERIOD = 0.01  # [s] between looks at a console, which cannot be waited for


class Terminal(Protocol):
    """Where keys are typed; use it as a context manager. Ctrl-C still ends the program.

    Entering raises ClientError when there is no terminal.
    """

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def read(self, timeout: float) -> bytes:
        """Return the keys that were typed, none after `timeout` [s]; raises EOFError when the terminal has closed."""


def open_terminal() -> Terminal:
    """Return the terminal of this process."""
    if sys.platform == "win32":
        import msvcrt

        return WindowsConsole(msvcrt, is_console=sys.stdin.isatty())
    return PosixTerminal()


class PosixTerminal:
    """A terminal behind a file descriptor."""

    def __init__(self, fd: int = 0) -> None:
        self._fd = fd

    def __enter__(self) -> Self:
        if not os.isatty(self._fd):
            raise ClientError(NO_TERMINAL)
        import termios  # here, because Windows has none
        import tty

        self._before = termios.tcgetattr(self._fd)
        tty.setcbreak(self._fd)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        import termios

        termios.tcsetattr(self._fd, termios.TCSANOW, self._before)

    def read(self, timeout: float) -> bytes:
        """See `Terminal`."""
        if not select.select([self._fd], [], [], timeout)[0]:
            return b""
        try:
            content = os.read(self._fd, 4096)
        except OSError as error:
            raise EOFError(str(error)) from None
        if not content:
            raise EOFError("the terminal has closed")
        return content


class Console(Protocol):
    """What `msvcrt` has of a console."""

    def kbhit(self) -> bool:
        """Tell whether a key waits to be read."""

    def getch(self) -> bytes:
        """Return the next byte of what was typed; of a key without a character two follow one another."""


class WindowsConsole:
    """The console of a Windows process, which gives keys one by one.

    Args:
        console: `msvcrt`.
        is_console: whether standard input is one.
        sleep: waits [s].
        clock: [s] that never runs back.
    """

    def __init__(
        self,
        console: Console,
        *,
        is_console: bool,
        sleep: Callable[[float], None] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._console, self._is_console, self._sleep, self._clock = console, is_console, sleep, clock

    def __enter__(self) -> Self:
        if not self._is_console:
            raise ClientError(NO_TERMINAL)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Do nothing: the console was not changed."""

    def read(self, timeout: float) -> bytes:
        """See `Terminal`."""
        end = self._clock() + timeout
        while not self._console.kbhit():
            if self._clock() >= end:
                return b""
            self._sleep(POLL_PERIOD)
        typed = self._console.getch()
        if typed in (b"\x00", b"\xe0"):  # an arrow or function key: its code comes next, and is no character
            self._console.getch()
            return b""
        return typed
