"""Frames of LeRobot datasets: teachpath's own, and as LeRobot's own writers lay them out."""

import io
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.lerobot import Dataset, Feature, write_dataset
from teachpath.io.readers.contract import FileMotions, OptionNeeded, ReadOptions
from teachpath.io.readers.registry import read_motions, recognized
from tests.unit.io.readers.test_damage import damaged
from tests.unit.io.readers.test_formats import COUNT, POSITIONS, TIMES, WXYZ

NAME = "episode_000000.parquet"
COLUMNS = "x=observation.state.2,y=observation.state.3,z=observation.state.4,grasp=observation.state.1"


def read(content: bytes, **options: str) -> FileMotions:
    return read_motions(content, NAME, "", ReadOptions(**options), ImportSettings())  # type: ignore[arg-type]


def frames(**columns: object) -> bytes:
    """Return frames as LeRobot 2.1 writes them: a grasp and a place in a list without names."""
    state = np.column_stack([np.linspace(0.0, 1.0, COUNT), POSITIONS]).astype(np.float32)
    usual = {
        "observation.state": pa.array(state.tolist(), pa.list_(pa.float32())),
        "timestamp": pa.array(TIMES, pa.float32()),
        "frame_index": pa.array(range(COUNT)),
        "episode_index": pa.array([0] * COUNT),
        "index": pa.array(range(COUNT)),
        "task_index": pa.array([0] * COUNT),
    }
    out = io.BytesIO()
    pq.write_table(pa.table({**usual, **columns}), out)
    return out.getvalue()


def test_a_dataset_of_ours_comes_back_without_a_word(tmp_path: Path) -> None:
    names = ("x", "y", "z", "qw", "qx", "qy", "qz", "closure")
    closure = np.linspace(0.0, 1.0, COUNT)[:, None]
    states = [np.hstack([POSITIONS + 0.1 * k, WXYZ, closure]) for k in range(2)]
    features = {"observation.state": Feature("float32", names, states), "action": Feature("float32", names, states)}
    write_dataset(tmp_path, Dataset("cup", 50, [TIMES, TIMES], features, {"demonstration": ["a", "b"]}))
    content = (tmp_path / "data/chunk-000/file-000.parquet").read_bytes()
    assert recognized(content, "f") == "lerobot"
    found = read(content)
    assert "2 episodes" in found.understood
    for k, track in enumerate(found.tracks):
        assert np.allclose(track.times, TIMES, atol=1e-6)
        assert np.allclose(track.positions, POSITIONS + 0.1 * k, atol=1e-6)
        assert track.orientations is not None
        assert np.allclose(track.orientations, WXYZ, atol=1e-6)
        assert track.closure is not None
        assert np.allclose(track.closure, closure[:, 0], atol=1e-6)


def test_of_frames_without_names_one_says_which_number_is_what() -> None:
    with pytest.raises(OptionNeeded, match=r"no column for x, y, z; its 5 columns are observation.state.1, .*--col"):
        read(frames())
    (track,) = read(frames(), columns=COLUMNS).tracks
    assert np.allclose(track.positions, POSITIONS, atol=1e-6)
    assert track.closure is not None
    assert np.ptp(track.closure) == 1.0


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (frames(timestamp=pa.array(["now"] * COUNT)), "no column for t"),
        (frames(**{"observation.state": pa.array([[1.0]] * (COUNT - 1) + [[1.0, 2.0]])}), "has not 1 numbers in every"),
        (frames()[:-50], "not a whole file of format lerobot"),
    ],
)
def test_frames_that_cannot_be_read_are_said(content: bytes, sentence: str) -> None:
    with pytest.raises(UnusableRecording, match=sentence):
        read(content, columns=COLUMNS)


def test_a_parquet_file_of_something_else_is_said() -> None:
    out = io.BytesIO()
    pq.write_table(pa.table({"a": [1.0]}), out)
    with pytest.raises(UnusableRecording, match=r"no frames of LeRobot: it has no column timestamp; \['a'\]"):
        read(out.getvalue())


def test_damaged_frames_end_in_a_sentence_or_in_a_motion() -> None:
    content, said = frames(), []
    for number in range(100):
        try:
            found = read(damaged(content, np.random.default_rng(number)), columns=COLUMNS)
            assert all(np.isfinite(track.positions).all() for track in found.tracks)
        except UnusableInput as error:
            said.append(str(error))
    assert all(NAME in sentence for sentence in said)
