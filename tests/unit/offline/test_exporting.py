"""Exports: what is imported again is the same, and what fails leaves nothing."""

import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from teachpath.errors import Conflict, NotFound, TeachpathError, UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.sample_files import read_samples, write_samples
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.exporting import chosen, export_demonstrations
from teachpath.offline.file_samples import Source
from teachpath.offline.importing import import_file
from teachpath.recorder.annotations import Annotations
from teachpath.records import Amendment, Calibration, Demonstration
from tests.unit.offline.takes import EMPTY_SCENE, SETTINGS, TAKES, record, said, trajectory, whole


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(tmp_path / "data")))
    yield store
    store.close()


def exported(store: Store, rows: list[Demonstration], kind: str, into: Path) -> list[Path]:
    return export_demonstrations(store, rows, kind, into, trajectory=trajectory(store))


def imported(store: Store, file: Path, kind: str) -> Demonstration:
    source = Source(file.name, file.read_bytes(), kind)
    ((row, _),) = import_file(
        store,
        SETTINGS,
        source,
        task="again",
        scene=EMPTY_SCENE,
        calibration=Calibration("identity"),
        limits=ImportSettings(),
    )
    return row


@pytest.mark.parametrize("kind", ["csv", "mcap"])
@pytest.mark.parametrize("gone", [False, True])
@pytest.mark.parametrize("take", TAKES)
def test_what_is_imported_again_has_the_same_samples_and_the_same_verdict(
    store: Store, tmp_path: Path, take: str, gone: bool, kind: str
) -> None:
    row = record(store, TAKES[take](), gone=gone)
    (file,) = exported(store, [row], kind, tmp_path / "out")
    again = imported(store, file, kind)
    assert store.recordings.samples(again.recording) == store.recordings.samples(row.recording)
    assert list(said(again)) == list(said(row))
    assert row.verdict == "repaired"  # one payload was refused, at least
    first, second = (trajectory(store)(d) for d in (row, again))
    assert np.array_equal(first.positions, second.positions)
    assert np.array_equal(first.times, second.times)


@pytest.mark.parametrize("kind", ["csv", "mcap"])
@pytest.mark.parametrize("discarded", [False, True])
@pytest.mark.parametrize(("mark", "trim"), [("good", (25, 60)), ("bad", (0, 0)), ("", (40, 70))])
def test_what_an_operator_said_is_said_again(
    store: Store, tmp_path: Path, mark: str, trim: tuple[int, int], discarded: bool, kind: str
) -> None:
    annotations = Annotations(store, SETTINGS, lambda _: EMPTY_SCENE)
    row = annotations.amend(record(store, whole()).id, Amendment(mark=mark, trim=trim, discarded=discarded))
    (file,) = exported(store, [row], kind, tmp_path / "out")
    again = imported(store, file, kind)
    assert list(said(again)) == list(said(row))
    assert (again.mark, again.trim, bool(again.discarded_ns)) == (row.mark, row.trim, discarded)
    assert np.array_equal(annotations.trajectory(again).positions, annotations.trajectory(row).positions)
    (twice,) = exported(store, [again], kind, tmp_path / "twice")
    assert list(said(imported(store, twice, kind))) == list(said(row))


@pytest.mark.parametrize("kind", ["csv", "mcap"])
def test_a_conversion_is_exported_too(store: Store, tmp_path: Path, kind: str) -> None:
    row = record(store, whole())
    moved = store.change_demonstration(row.id, calibration=replace(row.calibration, offset=(0.0, 0.5, 0.0)))
    (file,) = exported(store, [moved], kind, tmp_path / "out")
    assert imported(store, file, kind).calibration == moved.calibration


@pytest.mark.parametrize("trim", [(-5, 40), (30, 10**6), (40, 20), (50, 52)])
def test_a_trim_that_cannot_be_is_left_out_and_an_unknown_mark_refused(
    store: Store, tmp_path: Path, trim: tuple[int, int]
) -> None:
    row = replace(record(store, whole()), trim=trim)
    content = write_samples(row, store.recordings.samples(row.recording))
    (tmp_path / "trimmed.csv").write_bytes(content)
    assert imported(store, tmp_path / "trimmed.csv", "csv").trim is None
    (tmp_path / "cut.csv").write_bytes(content.replace(b'"release":', b'"release":1', 1))
    with pytest.raises(UnusableRecording, match=r"cut\.csv: it says that the object was carried from sample \d+ to 1"):
        imported(store, tmp_path / "cut.csv", "csv")
    (tmp_path / "marked.csv").write_bytes(content.replace(b'"mark":""', b'"mark":"evil"', 1))
    with pytest.raises(UnusableRecording, match=r"marked\.csv: .*'evil' is none of '', 'good', 'bad'"):
        imported(store, tmp_path / "marked.csv", "csv")
    assert len(store.demonstrations("again")) == 1


def test_a_recording_is_exported_as_it_is_until_something_is_said_of_it(store: Store, tmp_path: Path) -> None:
    row = record(store, whole())
    recording = store.recordings.path(row.recording).read_bytes()
    (file,) = exported(store, [row], "mcap", tmp_path / "first")
    assert file.read_bytes() == recording
    (file,) = exported(store, [store.change_demonstration(row.id, mark="good")], "mcap", tmp_path / "second")
    assert store.recordings.path(row.recording).read_bytes() == recording
    before, after = (make_reader(io.BytesIO(each), validate_crcs=True) for each in (recording, file.read_bytes()))
    assert [m for _, _, m in after.iter_messages()] == [m for _, _, m in before.iter_messages()]
    first, second = before.get_summary(), after.get_summary()
    assert (first, second) != (None, None)
    assert (second.statistics.message_count, second.chunk_indexes, second.channels) == (
        first.statistics.message_count,
        first.chunk_indexes,
        first.channels,
    )
    facts = [m.metadata for m in after.iter_metadata() if m.name == "facts"]
    assert facts[0] == next(m.metadata for m in before.iter_metadata() if m.name == "facts")
    assert ['"mark":"good"' in each["demonstration"] for each in facts] == [False, True]


def test_the_objects_trajectory_is_exported_and_imported(store: Store, tmp_path: Path) -> None:
    row = record(store, whole())
    (file,) = exported(store, [row], "trajectory", tmp_path)
    again = trajectory(store)(imported(store, file, "csv"))
    true = trajectory(store)(row)
    assert np.allclose(again.times, true.times, atol=1e-9)
    assert np.array_equal(again.positions, true.positions)
    assert np.allclose(again.orientations, true.orientations, atol=1e-12)


def test_a_motion_comes_from_an_array_with_its_own_clock(store: Store, tmp_path: Path) -> None:
    times = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.03, 60))
    motion = np.column_stack([times, np.linspace(0.3, 0.6, 60), np.zeros(60), np.full(60, 0.5)])
    np.save(tmp_path / "one.npy", motion)
    way = trajectory(store)(imported(store, tmp_path / "one.npy", "npy"))
    assert np.allclose(way.times, times - times[0], atol=1e-9)
    assert np.array_equal(way.positions, motion[:, 1:])


def test_progress_is_told_and_the_files_are_named_by_task_and_number(store: Store, tmp_path: Path) -> None:
    rows = [record(store, whole()) for _ in range(2)]
    told: list[float] = []
    files = export_demonstrations(
        store, rows, "csv", tmp_path / "out", trajectory=trajectory(store), progress=lambda f, _: told.append(f)
    )
    assert [file.name for file in files] == ["lift-001.csv", "lift-002.csv"]
    assert (told[0], told[-1], told) == (0.0, 1.0, sorted(told))


@pytest.mark.parametrize("kind", ["csv", "mcap", "lerobot"])
def test_a_recording_that_is_missing_leaves_nothing_of_its_file(store: Store, tmp_path: Path, kind: str) -> None:
    rows = [record(store, whole()) for _ in range(2)]
    store.recordings.path(rows[1].recording).unlink()
    with pytest.raises(NotFound, match="is missing"):
        exported(store, rows, kind, tmp_path / "out")
    left = [] if kind == "lerobot" else [f"lift-001.{kind}"]
    assert [file.name for file in (tmp_path / "out").iterdir()] == left


@pytest.mark.parametrize("kind", ["csv", "lerobot"])
def test_nothing_is_overwritten(store: Store, tmp_path: Path, kind: str) -> None:
    rows = [record(store, whole())]
    (made,) = exported(store, rows, kind, tmp_path)
    with pytest.raises(Conflict, match="is there already"):
        exported(store, rows, kind, tmp_path)
    assert made.exists()
    assert not list(tmp_path.glob(".*"))


def test_a_place_that_cannot_be_written_and_an_unknown_format_are_said(store: Store, tmp_path: Path) -> None:
    rows = [record(store, whole())]
    (tmp_path / "file").write_text("")
    for kind in ("csv", "lerobot"):
        with pytest.raises(UnusableInput, match=r"cannot write into .*file: "):
            exported(store, rows, kind, tmp_path / "file")
    with pytest.raises(UnusableInput, match="format 'xls' is unknown; known: csv, mcap, lerobot"):
        exported(store, rows, "xls", tmp_path)


def test_only_usable_ones_are_chosen_unless_all_or_some_are_wanted(store: Store) -> None:
    rows = [record(store, whole()) for _ in range(3)]
    store.change_demonstration(rows[1].id, mark="bad")
    assert [d.number for d in chosen(store, "lift")] == [1, 3]
    assert [d.number for d in chosen(store, "lift", all_=True)] == [1, 2, 3]
    assert [d.number for d in chosen(store, "lift", numbers=[2])] == [2]
    with pytest.raises(NotFound, match="no demonstration 9; it has 3"):
        chosen(store, "lift", numbers=[1, 9])
    with pytest.raises(NotFound, match="task 'moon'"):
        chosen(store, "moon")


# files of samples that are damaged


def test_a_torn_file_of_samples_is_refused_wherever_it_is_torn(store: Store) -> None:
    row = record(store, whole())
    content = write_samples(row, store.recordings.samples(row.recording))
    assert read_samples(content, "x.csv", ImportSettings())[0] == row
    for keep in np.random.default_rng(1).integers(len("# teachpath "), len(content) - 1, 200).tolist():
        with pytest.raises(UnusableRecording, match=r"x\.csv"):
            read_samples(content[:keep], "x.csv", ImportSettings())


def cell(content: bytes, line: int, column: int, text: str) -> bytes:
    lines = content.decode().split("\n")
    cells = lines[line].split(",")
    cells[column] = text
    lines[line] = ",".join(cells)
    return "\n".join(lines).encode()


@pytest.mark.parametrize(
    ("column", "text"),
    [
        *((0, "-1"), (0, "1.5"), (0, '"'), (1, "0"), (1, "9" * 40), (2, "-5"), (3, "nan"), (4, "1e9")),
        *((6, "2"), (6, ""), (9, "x"), (10, "2"), (11, "-1"), (12, "1.5"), (13, "")),
    ],
)
def test_a_sample_that_cannot_be_is_named_with_its_line(store: Store, column: int, text: str) -> None:
    row = record(store, whole())
    content = cell(write_samples(row, store.recordings.samples(row.recording)), 11, column, text)
    with pytest.raises(TeachpathError, match=r"x\.csv"):
        read_samples(content, "x.csv", ImportSettings())


def test_a_header_that_states_something_else_is_refused(store: Store) -> None:
    row: Any = record(store, whole())
    content = write_samples(row, store.recordings.samples(row.recording))
    for broken, sentence in (
        (content.replace(b'"source"', b'"sauce"', 1), "not the samples of a demonstration"),
        (content.replace(b"sequence,device_ns", b"device_ns,sequence", 1), "line 2: the columns must be"),
        (content.replace(b'"samples":', b'"samples":1', 1), "stated in the first line"),
    ):
        with pytest.raises(UnusableRecording, match=sentence):
            read_samples(broken, "x.csv", ImportSettings())
