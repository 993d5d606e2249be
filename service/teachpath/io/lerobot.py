"""Demonstrations as a LeRobot dataset, version 3.0: parquet files of frames and episodes, with the true times beside.

Layout after the reader and writer of LeRobot (`lerobot.datasets`, codebase version v3.0): frames in `data/`, and in
`meta/` info.json, stats.json, tasks.parquet and `episodes/`, the parquet files as chunk-000/file-000 with one row group
an episode. LeRobot's reader goes from frame to frame by index and `fps`; `timestamp` is when a sample was taken, not,
as LeRobot's own writer puts it, frame_index / fps: nothing is stamped anew, and a loss shows in it and in `sequence`.

Read by lerobot 0.4.4: frame by frame, in windows (`delta_timestamps`), single episodes; merged with another, split, and
with episodes taken out. Its own writer gives the same frames the same columns, types and statistics, but for quantiles
and small deviations, which it estimates in single precision.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from teachpath.records import Array

VERSION = "v3.0"
LARGEST_FILE = 100 * 2**20  # bytes of frames, before they are compressed
CHUNK = 1000  # files in a folder
STATE, STATE_NAMES = "observation.state", "teachpath.state"  # whose names our own reader finds in the metadata
FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
QUANTILES = (1, 10, 50, 90, 99)  # per cent
KINDS = {"float32": pa.float32(), "float64": pa.float64(), "int64": pa.int64(), "bool": pa.bool_()}


@dataclass(frozen=True, eq=False)
class Feature:
    """One column of the frames: its names, and the values (frames, names) of each episode; dtypes as LeRobot's."""

    dtype: str
    names: tuple[str, ...]
    values: list[NDArray[Any]]


@dataclass(frozen=True, eq=False)
class Dataset:
    """A dataset of one task.

    Attributes:
        task: in words.
        fps: frames a second, as LeRobot counts them.
        times: of each episode's frames [s], from its first one.
        features: columns beside those that LeRobot itself needs.
        episodes: what is said of each episode, beside what LeRobot needs.
    """

    task: str
    fps: int
    times: Sequence[Array]
    features: dict[str, Feature]
    episodes: dict[str, list[str]]

    @property
    def lengths(self) -> list[int]:
        """Return the number of frames of each episode."""
        return [len(times) for times in self.times]


def write_dataset(
    root: Path,
    dataset: Dataset,
    progress: Callable[[float], None] = lambda _: None,
    *,
    largest_file: int = LARGEST_FILE,
) -> None:
    """Write a dataset into the folder `root`, which must be empty; raises OSError."""
    features = all_features(dataset)
    files = _write_frames(root, features, largest_file, progress)
    per_episode = [{name: statistics(f.values[k]) for name, f in features.items()} for k in range(len(dataset.lengths))]
    _write_episodes(root, dataset, files, per_episode)
    _write_tasks(root, dataset.task)
    whole = {name: statistics(np.concatenate(f.values)) for name, f in features.items()}
    write_json(root / "meta" / "stats.json", whole)
    write_json(root / "meta" / "info.json", _info(dataset, features))


def all_features(dataset: Dataset) -> dict[str, Feature]:
    """Return the columns of frames, those that LeRobot itself needs among them."""
    lengths, starts = dataset.lengths, np.cumsum([0, *dataset.lengths])
    frames = [np.arange(n)[:, None] for n in lengths]
    columns = {
        "frame_index": frames,
        "episode_index": [np.full((n, 1), k) for k, n in enumerate(lengths)],
        "index": [f + start for f, start in zip(frames, starts, strict=False)],
        "task_index": [np.zeros((n, 1), dtype=np.int64) for n in lengths],
    }
    times = Feature("float32", (), [times[:, None] for times in dataset.times])
    counters = {name: Feature("int64", (), values) for name, values in columns.items()}
    return dataset.features | {"timestamp": times} | counters


def _write_frames(
    root: Path, features: dict[str, Feature], largest_file: int, progress: Callable[[float], None]
) -> list[int]:
    """Write the frames and return the number of the file that each episode is in."""
    files: list[int] = []
    writer, written, number = None, 0, -1
    count = len(features["index"].values)
    try:
        for k in range(count):
            table = frame_table(features, k)
            if writer is None or written + table.nbytes > largest_file:
                if writer is not None:
                    writer.close()
                number, written = number + 1, 0
                writer = pq.ParquetWriter(made(root / "data" / _file(number)), table.schema, compression="snappy")
            writer.write_table(table)
            written += table.nbytes
            files.append(number)
            progress((k + 1) / count)
    finally:
        if writer is not None:
            writer.close()
    return files


def frame_table(features: dict[str, Feature], episode: int) -> Any:
    """Return the frames of an episode as a table."""
    table = pa.table({name: _column(feature, episode) for name, feature in features.items()})
    return table.replace_schema_metadata({STATE_NAMES: json.dumps(features[STATE].names)})


def _column(feature: Feature, episode: int) -> Any:
    values, kind = feature.values[episode], KINDS[feature.dtype]
    flat = pa.array(values.reshape(-1), type=kind)
    return flat if len(feature.names) < 2 else pa.FixedSizeListArray.from_arrays(flat, len(feature.names))


def _write_episodes(root: Path, dataset: Dataset, files: list[int], stats: list[dict[str, dict[str, Any]]]) -> None:
    ends = np.cumsum(dataset.lengths)
    count = len(ends)
    columns: dict[str, Any] = {
        "episode_index": list(range(count)),
        "tasks": [[dataset.task]] * count,
        "length": dataset.lengths,
        "dataset_from_index": (ends - np.array(dataset.lengths)).tolist(),
        "dataset_to_index": ends.tolist(),
        "data/chunk_index": [number // CHUNK for number in files],
        "data/file_index": [number % CHUNK for number in files],
        "meta/episodes/chunk_index": [0] * count,
        "meta/episodes/file_index": [0] * count,
    }
    columns |= {f"teachpath/{name}": said for name, said in dataset.episodes.items()}
    for feature, values in stats[0].items():
        columns |= {f"stats/{feature}/{what}": [episode[feature][what] for episode in stats] for what in values}
    pq.write_table(pa.table(columns), made(root / "meta" / "episodes" / _file(0)))


def _write_tasks(root: Path, task: str) -> None:
    """Write the tasks as pandas would whose index they are: LeRobot finds a task by its row's name."""
    index = {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": None}
    number = {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64"}
    column_index = {"name": None, "field_name": None, "pandas_type": "unicode", "numpy_type": "object"}
    column_index["metadata"] = {"encoding": "UTF-8"}  # type: ignore[assignment]
    pandas = {
        "index_columns": ["task"],
        "column_indexes": [column_index],
        "columns": [number | {"metadata": None}, index],
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": "2.0.0",
    }
    table = pa.table({"task_index": pa.array([0], pa.int64()), "task": pa.array([task], pa.string())})
    schema = {"pandas": json.dumps(pandas)}
    pq.write_table(table.replace_schema_metadata(schema), made(root / "meta" / "tasks.parquet"))


def _info(dataset: Dataset, features: dict[str, Feature]) -> dict[str, Any]:
    return {
        "codebase_version": VERSION,
        "robot_type": None,
        "total_episodes": len(dataset.lengths),
        "total_frames": int(sum(dataset.lengths)),
        "total_tasks": 1,
        "chunks_size": CHUNK,
        "data_files_size_in_mb": LARGEST_FILE // 2**20,
        "video_files_size_in_mb": 200,
        "fps": dataset.fps,
        "splits": {"train": f"0:{len(dataset.lengths)}"},
        "data_path": f"data/{FILE}",
        "video_path": None,
        "features": described(features),
    }


def described(features: dict[str, Feature]) -> dict[str, Any]:
    """Return what info.json says of the columns."""
    return {
        name: {"dtype": f.dtype, "shape": [max(len(f.names), 1)], "names": list(f.names) or None}
        for name, f in features.items()
    }


def statistics(values: NDArray[Any]) -> dict[str, list[float]]:
    """Return what LeRobot normalises by, lists of d numbers of (n, d) values; least and greatest are of their type."""
    numbers = values.astype(np.float64)
    found = {
        "min": values.min(axis=0).tolist(),
        "max": values.max(axis=0).tolist(),
        "mean": numbers.mean(axis=0).tolist(),
        "std": numbers.std(axis=0).tolist(),
        "count": [len(numbers)],
    }
    return found | {f"q{q:02d}": np.percentile(numbers, q, axis=0).tolist() for q in QUANTILES}


def _file(number: int) -> str:
    return FILE.format(chunk_index=number // CHUNK, file_index=number % CHUNK)


def made(file: Path) -> Path:
    """Return a file after its folder was made."""
    file.parent.mkdir(parents=True, exist_ok=True)
    return file


def write_json(file: Path, document: dict[str, Any]) -> None:
    """Write a document into a file, whose folder is made when it is missing."""
    made(file).write_text(json.dumps(document, indent=4) + "\n")
