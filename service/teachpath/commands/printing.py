"""How lists and records are printed: as columns for people, and as the JSON of the REST API for programs."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict, is_dataclass
from datetime import datetime
from typing import Any, Final

PIPE_WIDTH: Final = 200  # characters of a line where the output is no terminal


def print_json(records: Any) -> None:
    """Print a record, a dictionary, or a list of them, as JSON."""
    print(json.dumps(_document(records), indent=2, ensure_ascii=False))


def _document(records: Any) -> Any:
    if isinstance(records, list):
        return [_document(each) for each in records]
    return asdict(records) if is_dataclass(records) and not isinstance(records, type) else records


def print_columns(names: Sequence[str], rows: Iterable[Sequence[object]], *, none: str) -> None:
    """Print rows under the names of their columns; `none` is said on the error stream where there are no rows."""
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    table = Table(*map(escape, names), box=None, pad_edge=False)
    for row in rows:
        table.add_row(*(escape(str(entry)) for entry in row))
    if table.row_count:
        Console(width=None if sys.stdout.isatty() else PIPE_WIDTH, highlight=False).print(table)
    else:
        print(none, file=sys.stderr)


def print_list(
    records: Sequence[object], names: Sequence[str], rows: Iterable[Sequence[object]], *, none: str, json_: bool
) -> None:
    """Print records as JSON, or as rows under the names of their columns."""
    if json_:
        print_json(list(records))
    else:
        print_columns(names, rows, none=none)


def print_answer(record: Any, *sentences: str, json_: bool) -> None:
    """Print what a command did: as JSON, or in sentences."""
    if json_:
        print_json(record)
        return
    for sentence in sentences:
        print(sentence)


def verdict_word(verdict: str) -> str:
    """Return what a sentence says of a demonstration with this verdict."""
    return "rejected" if verdict == "reject" else str(verdict)


def moment(at_ns: int) -> str:
    """Return a time as it is on the clock here; empty for none."""
    return f"{datetime.fromtimestamp(at_ns / 1e9).astimezone():%Y-%m-%d %H:%M:%S}" if at_ns else ""
