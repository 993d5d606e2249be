"""Finds the last error in what a process writes on its error stream."""

from __future__ import annotations

import re
from typing import Final

_LEVEL: Final = r"(?:^|\s)(?:{})[\s:]"  # of a log line, near its beginning
_NO_ERROR: Final = re.compile(_LEVEL.format("TRACE|DEBUG|INFO|WARNING|WARN"))
_ERROR: Final = re.compile(_LEVEL.format("ERROR|CRITICAL|FATAL"))
_PREFIX: Final = 80  # characters of a line in which its level stands
_MAX_LENGTH: Final = 300  # characters of an error that are kept


class LastError:
    """Reads lines one by one.

    An error is the first line of the exception under a traceback, a line that is logged as an error, or, without
    these, whatever is written without a lower level, as a library written in C does before it aborts.

    Attributes:
        text: the last error; empty when there was none.
    """

    def __init__(self) -> None:
        self.text: str = ""
        self._in_traceback = False
        self._is_certain = False  # an exception or a logged error was found

    def add(self, line: str) -> None:
        """Read another line."""
        begin = line[:_PREFIX]
        if not line.strip() or _NO_ERROR.search(begin):
            return
        if line.startswith("Traceback (most recent call last)"):
            self._in_traceback = True
        elif self._in_traceback:
            if not line[0].isspace():  # else it is a frame
                self._in_traceback = False
                self._keep(line, certain=True)
        elif _ERROR.search(begin):
            self._keep(line, certain=True)
        elif not self._is_certain:
            self._keep(line, certain=False)

    def _keep(self, line: str, *, certain: bool) -> None:
        self.text, self._is_certain = line.strip()[:_MAX_LENGTH], certain
