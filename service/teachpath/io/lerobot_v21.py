"""Demonstrations as a LeRobot dataset of version 2.1, which programs read that do not know version 3.0 yet.

A parquet file an episode, and in `meta/` info.json and lines of JSON: tasks, episodes, and statistics of each episode.
Its reader refuses frames that are not 1/fps apart, so `timestamp` is frame_index / fps, as its own writer puts it; when
a sample was taken is in `device_ns`, where our own reader takes it from.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq

from teachpath.io.lerobot import (
    CHUNK,
    Dataset,
    Feature,
    all_features,
    described,
    frame_table,
    made,
    statistics,
    write_json,
)

VERSION = "v2.1"
FILE = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
STATISTICS = ("min", "max", "mean", "std", "count")  # that the version knows


def write_dataset_v21(root: Path, dataset: Dataset, progress: Callable[[float], None] = lambda _: None) -> None:
    """Write a dataset into the folder `root`, which must be empty; raises OSError."""
    even = replace(dataset, times=[np.arange(count) / dataset.fps for count in dataset.lengths])
    features, count = all_features(even), len(dataset.lengths)
    for k in range(count):
        file = root / FILE.format(episode_chunk=k // CHUNK, episode_index=k)
        pq.write_table(frame_table(features, k), made(file), compression="snappy")
        progress((k + 1) / count)
    meta = root / "meta"
    write_json(meta / "info.json", _info(dataset, features))
    _write_lines(meta / "tasks.jsonl", [{"task_index": 0, "task": dataset.task}])
    _write_lines(meta / "episodes.jsonl", (_episode(dataset, k) for k in range(count)))
    _write_lines(meta / "episodes_stats.jsonl", (_statistics(features, k) for k in range(count)))


def _episode(dataset: Dataset, episode: int) -> dict[str, Any]:
    said = {f"teachpath/{name}": values[episode] for name, values in dataset.episodes.items()}
    return {"episode_index": episode, "tasks": [dataset.task], "length": dataset.lengths[episode]} | said


def _statistics(features: dict[str, Feature], episode: int) -> dict[str, Any]:
    found = {name: statistics(feature.values[episode]) for name, feature in features.items()}
    kept = {name: {what: each[what] for what in STATISTICS} for name, each in found.items()}
    return {"episode_index": episode, "stats": kept}


def _info(dataset: Dataset, features: dict[str, Feature]) -> dict[str, Any]:
    count = len(dataset.lengths)
    return {
        "codebase_version": VERSION,
        "robot_type": None,
        "total_episodes": count,
        "total_frames": int(sum(dataset.lengths)),
        "total_tasks": 1,
        "total_videos": 0,
        "total_chunks": -(-count // CHUNK),
        "chunks_size": CHUNK,
        "fps": dataset.fps,
        "splits": {"train": f"0:{count}"},
        "data_path": FILE,
        "video_path": None,
        "features": described(features),
    }


def _write_lines(file: Path, documents: Iterable[dict[str, Any]]) -> None:
    file.write_text("".join(json.dumps(document) + "\n" for document in documents))
