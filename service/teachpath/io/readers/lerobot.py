"""Frames of LeRobot datasets: of version 2.1 a parquet file an episode, of version 3.0 several episodes in one."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final

import numpy as np

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.arrays import check_count
from teachpath.io.readers.contract import FileMotions, Reader, ReadOptions
from teachpath.io.readers.tables import read_rows

MAGIC: Final = b"PAR1"
STATE: Final = "observation.state"
COUNTERS: Final = ("frame_index", "index", "task_index")  # that say nothing of a motion
NAMES_KEY: Final = b"teachpath.state"  # metadata of teachpath's own files: names of the numbers of the state
OWN_CLOCK: Final = "device_ns"  # column of teachpath's own files: when a sample was taken
MAX_LIST_LENGTH: Final = 64  # numbers of a list that are columns
DELIMITER: Final = ","


def read_lerobot(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read the episodes of a file of frames; each number of a list is a column, e.g. `observation.state.1`.

    Raises:
        UnusableRecording: the file is damaged or over a limit; OptionNeeded: which number is what.
        UnusableInput: pyarrow is not installed.
    """
    columns, episodes = _columns(content, name, limits)
    if OWN_CLOCK in columns and not options.columns:
        del columns["timestamp"]  # which in version 2.1 is the frame's number over the rate
        columns["timestamp [ns]"] = columns.pop(OWN_CLOCK)
    header = list(columns)
    texts = [[repr(value) for value in values] for values in columns.values()]
    rows = [(number, list(cells)) for number, cells in enumerate(zip(*texts, strict=True), 1)]
    starts = [0, *(np.flatnonzero(np.diff(episodes)) + 1).tolist(), len(rows)]
    check_count(name, len(starts) - 1, len(rows), limits)
    found = [read_rows(rows[begin:end], list(header), DELIMITER, name, options) for begin, end in pairwise(starts)]
    whole = found[0]
    tracks = [track for each in found for track in each.tracks]
    return replace(whole, tracks=tracks, understood=(f"{len(tracks)} episodes", *whole.understood))


def _columns(content: bytes, name: str, limits: ImportSettings) -> tuple[dict[str, list[Any]], Any]:
    """Return the columns of numbers by their names, and the number of each frame's episode."""
    try:
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise UnusableInput(
            f"{name} is a parquet file, which needs pyarrow, which is not installed; install it with: pip install "
            "'teachpath[lerobot]'"
        ) from None
    file = pq.ParquetFile(io.BytesIO(content))
    check_count(name, 1, file.metadata.num_rows, limits)
    size = sum(file.metadata.row_group(k).total_byte_size for k in range(file.metadata.num_row_groups))
    if size > limits.max_expanded_size:
        raise UnusableRecording(
            f"{name}: its frames expand to {size} bytes, limit {limits.max_expanded_size} "
            "(imports.max_expanded_size); split the file"
        )
    schema = file.schema_arrow
    if "timestamp" not in schema.names:
        raise UnusableRecording(f"{name}: no frames of LeRobot: it has no column timestamp; {schema.names[:12]}")
    numeric = [field.name for field in schema if field.name not in COUNTERS and _is_numeric(field.type)]
    table = file.read(columns=numeric)
    if not table.num_rows:
        raise UnusableRecording(f"{name}: there are no frames in it")
    names = json.loads((schema.metadata or {}).get(NAMES_KEY, b"[]"))
    columns: dict[str, list[Any]] = {}
    episodes = np.zeros(table.num_rows)
    for column in numeric:
        if column == "episode_index":
            episodes = table[column].to_numpy()
        else:
            columns.update(_expanded(column, table[column].to_pylist(), names if column == STATE else (), name))
    return columns, episodes


def _expanded(column: str, values: list[Any], names: Any, name: str) -> Iterator[tuple[str, list[Any]]]:
    """Yield the name and the values of each number of a column."""
    if not isinstance(values[0], list):
        yield column, [float(value) if isinstance(value, bool) else value for value in values]
        return
    width = len(values[0])
    if any(value is None or len(value) != width for value in values):
        raise UnusableRecording(f"{name}: {column} has not {width} numbers in every frame")
    for k in range(min(width, MAX_LIST_LENGTH)):
        called = str(names[k]) if len(names) == width else f"{column}.{k + 1}"
        yield called, [value[k] for value in values]


def _is_numeric(kind: Any) -> bool:
    import pyarrow.types as types

    if types.is_list(kind) or types.is_fixed_size_list(kind):
        kind = kind.value_type
    return bool(types.is_floating(kind) or types.is_integer(kind) or types.is_boolean(kind))


LEROBOT = Reader(
    "lerobot",
    "frames of a LeRobot dataset",
    read_lerobot,
    lambda content, name: content.startswith(MAGIC) or name.endswith(".parquet"),
)
