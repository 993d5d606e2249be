"""The log: lines with time, level, part of the station, and the number of the request that they belong to.

Processes beside the service write each line as JSON, on their error stream or into a pipe; the service, which reads it,
writes it with its own, on the error stream and into the file of the settings.
"""

from __future__ import annotations

import json
import logging
import sys
import uuid
from collections.abc import Callable, Sequence
from contextvars import ContextVar
from dataclasses import dataclass
from datetime import UTC, datetime
from logging.handlers import RotatingFileHandler
from typing import Annotated, Any, Final, Literal

from annotated_types import Ge

SERVICE: Final = "service"
_VERBOSE_LOGGERS: Final = ("alembic", "httpx")  # libraries whose routine is no news

_request: ContextVar[str] = ContextVar("request", default="")


@dataclass(frozen=True)
class LogSettings:
    """What the service writes down of what it does."""

    # of a line: text, or a JSON object
    format: Literal["text", "json"] = "text"
    # that lines are written to as well, beside the error stream; empty: none
    file: str = ""
    # bytes of that file; a full one is renamed to FILE.1, and that to FILE.2
    largest_file: Annotated[int, Ge(10_000)] = 10_000_000
    # full files that are kept
    kept_files: Annotated[int, Ge(1)] = 5


def begin_request() -> str:
    """Give what is done from now on, in this task or thread, a number of its own, and return it."""
    number = uuid.uuid4().hex[:12]
    _request.set(number)
    return number


def request_number() -> str:
    """Return the number of the request that is being worked on; empty when there is none."""
    return _request.get()


def continue_request(number: str) -> None:
    """Let what is done from now on, in this task or thread, belong to a request that began elsewhere."""
    _request.set(number)


def log_to_stderr(settings: LogSettings | None = None, *, part: str = SERVICE, attached: bool = False) -> None:
    """Write the log of this process to its error stream, and to the file of the settings.

    Args:
        settings: None: lines of text, and no file.
        part: of the station, that this process is.
        attached: the service reads the error stream, so that lines are JSON and the file is the service's.

    Raises:
        OSError: the file cannot be written.
    """
    settings = LogSettings() if attached or settings is None else settings
    formatter = _JsonFormatter() if attached or settings.format == "json" else _TextFormatter()
    handlers: list[logging.Handler] = [logging.StreamHandler(sys.stderr)]
    if settings.file:
        handlers.append(
            RotatingFileHandler(settings.file, maxBytes=settings.largest_file, backupCount=settings.kept_files)
        )
    _install(handlers, formatter, part)


def log_as_json(send: Callable[[str], None], *, part: str) -> None:
    """Call `send` with each line of the log of this process, a `part` of the station, for the service to relay."""
    _install([_Sending(send)], _JsonFormatter(), part)


def _install(handlers: Sequence[logging.Handler], formatter: logging.Formatter, part: str) -> None:
    root = logging.getLogger()
    root.setLevel(logging.INFO)
    for handler in handlers:
        handler.addFilter(_Context(part))
        handler.setFormatter(formatter)
        root.addHandler(handler)
    for chatty in _VERBOSE_LOGGERS:
        logging.getLogger(chatty).setLevel(logging.WARNING)


def relay(line: str) -> str:
    """Write a line of another process's log with those of this one; return its level, name and text.

    Raises:
        ValueError: the line is of no log.
    """
    try:
        document: dict[str, Any] = json.loads(line)
        moment = datetime.fromisoformat(document["time"]).timestamp()
        level, name, text = document["level"], document["logger"], document["message"]
        number = logging.getLevelNamesMapping()[level]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError("no line of a log") from error
    fields = {"part": document.get("part", ""), "request": document.get("request", "")}
    record = logging.makeLogRecord({"name": name, "levelno": number, "levelname": level, "msg": text} | fields)
    record.created, record.msecs = moment, 1000 * (moment % 1)
    record.exc_text = document.get("exception")
    logging.getLogger(name).handle(record)
    return f"{level} {name}: {text}" + (f"\n{record.exc_text}" if record.exc_text else "")


class _Sending(logging.Handler):
    """Passes every line on."""

    def __init__(self, send: Callable[[str], None]) -> None:
        super().__init__()
        self._send = send

    def emit(self, record: logging.LogRecord) -> None:
        self._send(self.format(record))


class _Context(logging.Filter):
    """Adds part and request to a record that has none."""

    def __init__(self, part: str) -> None:
        super().__init__()
        self._part = part

    def filter(self, record: logging.LogRecord) -> bool:
        record.part = getattr(record, "part", self._part)
        record.request = getattr(record, "request", request_number())
        return True


class _TextFormatter(logging.Formatter):
    def __init__(self) -> None:
        super().__init__("%(time)s %(levelname)s %(part)s%(number)s %(name)s: %(message)s")

    def format(self, record: logging.LogRecord) -> str:
        record.time = _time(record)
        number = getattr(record, "request", "")
        record.number = f" [{number}]" if number else ""
        return super().format(record)

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - the library's name
        # What somebody sent may stand in it, who could begin a line of his own or write into the reader's terminal.
        return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in super().formatMessage(record))


class _JsonFormatter(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        document = {
            "time": _time(record),
            "level": record.levelname,
            "part": getattr(record, "part", ""),
            "request": getattr(record, "request", ""),
            "logger": record.name,
            "message": record.getMessage(),
        }
        exception = record.exc_text or (self.formatException(record.exc_info) if record.exc_info else "")
        return json.dumps(document | ({"exception": exception} if exception else {}), ensure_ascii=False)


def _time(record: logging.LogRecord) -> str:
    return datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
