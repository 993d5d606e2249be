"""A LeRobot dataset, read back with pyarrow: every sample is a frame, with its true times."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from teachpath.io import lerobot
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.readers.registry import read_motions
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.exporting import export_demonstrations
from teachpath.recording.demonstration import to_world
from teachpath.records import Demonstration, Sample
from tests.unit.offline.takes import LAB, TAKES, bare, lossy, record, trajectory, whole

COUNTERS = ["timestamp", "frame_index", "episode_index", "index", "task_index"]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(tmp_path / "data")))
    yield store
    store.close()


def exported(store: Store, rows: list[Demonstration], into: Path, kind: str = "lerobot") -> Path:
    (root,) = export_demonstrations(store, rows, kind, into, trajectory=trajectory(store))
    return root


def frames(root: Path) -> dict[str, list[Any]]:
    """Return the columns of all data files, in order."""
    files = sorted((root / "data").glob("*/*.parquet"))
    tables = [pq.read_table(file).to_pydict() for file in files]
    return {name: [value for table in tables for value in table[name]] for name in tables[0]}


def once(samples: list[Sample]) -> list[Sample]:
    return [{s.sequence: s for s in reversed(samples)}[number] for number in sorted({s.sequence for s in samples})]


@pytest.mark.parametrize("take", TAKES)
def test_every_sample_is_a_frame_with_all_that_was_measured(store: Store, tmp_path: Path, take: str) -> None:
    row = record(store, TAKES[take]())
    read = frames(exported(store, [row], tmp_path))
    true = once(store.recordings.samples(row.recording))
    for name in ("sequence", "device_ns", "receive_ns", "tracked", "buttons"):
        assert read[name] == [getattr(s, name) for s in true]
    assert [tuple(p) for p in read["tracker.position"]] == [s.position for s in true]
    assert ("observation.joints" in read) is (take == "led")
    if take == "led":
        assert [tuple(row) for row in read["observation.joints"]] == [s.joints for s in true]
    if take in ("bare", "led"):
        assert "tracker.orientation" not in read
        assert "observation.flexions" not in read
    else:
        assert [tuple(q) for q in read["tracker.orientation"]] == [s.orientation for s in true]
        assert [tuple(f) for f in read["observation.flexions"]] == [s.flexions for s in true]
    world = to_world(LAB, np.array([s.position for s in true]))
    states = np.array(read["observation.state"])
    assert np.allclose(states[:, :3], world, atol=1e-6)
    assert np.array_equal(np.array(read["action"])[:-1], states[1:])
    carried = {s.sequence for s in store.recordings.samples(row.recording)[slice(*row.transport)]}
    assert read["transport"] == [s.sequence in carried for s in true]


def test_the_layout_is_that_of_version_3(store: Store, tmp_path: Path) -> None:
    rows = [record(store, whole()), record(store, lossy())]
    root = exported(store, rows, tmp_path)
    lengths = [len(once(store.recordings.samples(row.recording))) for row in rows]
    info = json.loads((root / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["total_episodes"]) == ("v3.0", 50, 2)
    assert (info["total_frames"], info["splits"]) == (sum(lengths), {"train": "0:2"})
    assert set(COUNTERS) <= set(info["features"])
    data = root / info["data_path"].format(chunk_index=0, file_index=0)
    assert pq.read_metadata(data).num_row_groups == 2
    schema = pq.read_schema(data)
    assert set(schema.names) == set(info["features"])
    for name, feature in info["features"].items():
        (size,) = feature["shape"]
        kind = {"float32": "float", "float64": "double"}.get(feature["dtype"], feature["dtype"])
        listed = f"fixed_size_list<element: {kind}>[{size}]"
        assert str(schema.field(name).type) == (listed if size > 1 else kind)
        assert feature["names"] is None or len(feature["names"]) == size

    read = frames(root)
    assert read["index"] == list(range(sum(lengths)))
    assert read["episode_index"] == [0] * lengths[0] + [1] * lengths[1]
    assert read["frame_index"] == [*range(lengths[0]), *range(lengths[1])]
    true = [[s.device_ns for s in once(store.recordings.samples(row.recording))] for row in rows]
    since = [(ns - stamps[0]) * 1e-9 for stamps in true for ns in stamps]
    assert read["timestamp"] == pytest.approx(since, abs=1e-6)
    assert max(np.diff(since)) == pytest.approx(0.04)  # where a sample is lost

    (episodes,) = (root / "meta" / "episodes").glob("chunk-000/file-000.parquet")
    said = pq.read_table(episodes).to_pydict()
    assert said["length"] == lengths
    assert (said["dataset_from_index"], said["dataset_to_index"]) == ([0, lengths[0]], [lengths[0], sum(lengths)])
    assert said["tasks"] == [["lift"]] * 2
    assert said["teachpath/demonstration"] == [row.id for row in rows]
    assert said["teachpath/verdict"] == ["repaired", "repaired"]
    tasks = pq.read_table(root / "meta" / "tasks.parquet")
    assert tasks.to_pydict() == {"task_index": [0], "task": ["lift"]}
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["task"]


def test_the_layout_is_that_of_version_2_1(store: Store, tmp_path: Path) -> None:
    rows = [record(store, whole()), record(store, lossy())]
    root = exported(store, rows, tmp_path, "lerobot-2.1")
    takes = [once(store.recordings.samples(row.recording)) for row in rows]
    info = json.loads((root / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"], info["total_chunks"], info["total_videos"]) == ("v2.1", 50, 1, 0)
    assert (info["total_episodes"], info["total_frames"]) == (2, sum(map(len, takes)))

    def lines(name: str) -> list[Any]:
        return [json.loads(line) for line in (root / "meta" / f"{name}.jsonl").read_text().splitlines()]

    assert lines("tasks") == [{"task_index": 0, "task": "lift"}]
    for k, (row, take) in enumerate(zip(rows, takes, strict=True)):
        read = pq.read_table(root / info["data_path"].format(episode_chunk=0, episode_index=k)).to_pydict()
        assert set(read) == set(info["features"])
        assert read["timestamp"] == pytest.approx([i / 50 for i in range(len(take))])  # its reader refuses others
        assert read["device_ns"] == [sample.device_ns for sample in take]
        episode, stats = lines("episodes")[k], lines("episodes_stats")[k]
        assert (episode["length"], episode["teachpath/demonstration"]) == (len(take), row.id)
        assert (episode["episode_index"], stats["episode_index"]) == (k, k)
        assert set(stats["stats"]) == set(read)
        for name in ("device_ns", "tracked"):
            assert stats["stats"][name]["max"] == [max(read[name])]
            assert set(stats["stats"][name]) == {"min", "max", "mean", "std", "count"}


@pytest.mark.parametrize("kind", ["lerobot", "lerobot-2.1"])
def test_what_is_exported_is_read_back_with_its_own_clock(store: Store, tmp_path: Path, kind: str) -> None:
    rows = [record(store, whole()), record(store, lossy())]
    root = exported(store, rows, tmp_path, kind)
    tracks = [
        track
        for file in sorted((root / "data").glob("*/*.parquet"))
        for track in read_motions(file.read_bytes(), file.name, "", ReadOptions(), ImportSettings()).tracks
    ]
    for row, track in zip(rows, tracks, strict=True):
        true = once(store.recordings.samples(row.recording))
        assert track.stamps_ns.tolist() == [sample.device_ns for sample in true]
        assert track.orientations is not None
        assert track.closure is not None
        seen = np.array([sample.tracked for sample in true])
        assert (np.ones(len(true), np.bool_) if track.tracked is None else track.tracked).tolist() == seen.tolist()
        world = to_world(LAB, np.array([sample.position for sample in true]))
        assert np.allclose(track.positions[seen], world[seen], atol=1e-6)


def test_the_statistics_are_those_of_the_frames(store: Store, tmp_path: Path) -> None:
    root = exported(store, [record(store, whole()), record(store, bare())], tmp_path)
    stats, read = json.loads((root / "meta" / "stats.json").read_text()), frames(root)
    assert set(stats) == set(read)
    for name in ("observation.state", "timestamp", "tracked"):
        values = np.array(read[name], dtype=np.float64).reshape(len(read[name]), -1)
        assert stats[name]["mean"] == pytest.approx(values.mean(axis=0).tolist(), abs=1e-6)
        assert stats[name]["std"] == pytest.approx(values.std(axis=0).tolist(), abs=1e-6)
        assert stats[name]["max"] == pytest.approx(values.max(axis=0).tolist(), abs=1e-6)
    for name in ("device_ns", "sequence", "tracked"):  # nanoseconds since 1970 do not fit a float
        assert (stats[name]["min"], stats[name]["max"]) == ([min(read[name])], [max(read[name])])
        assert stats[name]["count"] == [len(values)]


def test_a_large_dataset_goes_on_in_another_file(tmp_path: Path) -> None:
    lengths = [5, 7, 3]
    values = lerobot.Feature("float32", ("x", "y"), [np.full((n, 2), float(n)) for n in lengths])
    times = [np.arange(n) / 50 for n in lengths]
    dataset = lerobot.Dataset("lift", 50, times, {"observation.state": values}, {})
    lerobot.write_dataset(tmp_path, dataset, largest_file=1)
    assert len(list((tmp_path / "data").glob("chunk-000/file-*.parquet"))) == 3
    said = pq.read_table(tmp_path / "meta" / "episodes" / "chunk-000" / "file-000.parquet").to_pydict()
    assert (said["data/chunk_index"], said["data/file_index"]) == ([0, 0, 0], [0, 1, 2])
    assert frames(tmp_path)["observation.state"] == [[float(n)] * 2 for n in lengths for _ in range(n)]
