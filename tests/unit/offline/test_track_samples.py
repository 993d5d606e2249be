"""Motions of files as samples: numbers by the clock, phases by columns, marks or dwells, untracked readings."""

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.offline.file_samples import Source
from teachpath.offline.importing import import_file
from teachpath.offline.track_samples import PhaseMarks
from teachpath.recorder.annotations import Annotations
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Amendment, Array, Calibration, Demonstration, Scene
from tests.unit.recording.test_motion_phases import pick_and_place

SETTINGS, EMPTY_ARGUMENTS = RecordingSettings(), Scene("empty")


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    store = Store(StoreSettings(data_dir=str(tmp_path)))
    yield store
    store.close()


def table(rows: Array, header: str = "t,x,y,z") -> str:
    out = io.StringIO()
    np.savetxt(out, rows, delimiter=",", header=header, comments="", fmt="%.6f")
    return out.getvalue()


def line(count: int = 150) -> Array:
    """Return rows t, x, y, z of a straight motion at 50 Hz."""
    k = np.arange(count)
    return np.column_stack([0.02 * k, 0.3 + 0.002 * k, 0 * k, 0 * k + 0.5])


def imported(store: Store, text: str, options: ReadOptions | None = None, **marks: object) -> Demonstration:
    source = Source("f.csv", text.encode(), "", options or ReadOptions(), PhaseMarks(**marks))  # type: ignore[arg-type]
    ((row, _),) = import_file(
        store,
        SETTINGS,
        source,
        task="t",
        scene=EMPTY_ARGUMENTS,
        calibration=Calibration("identity"),
        limits=ImportSettings(),
    )
    return row


@pytest.mark.parametrize("missing", [5, 45])
def test_missing_rows_are_lost_samples(store: Store, missing: int) -> None:
    random = np.random.default_rng(missing)
    kept = np.sort(np.concatenate([[0, 149], random.choice(np.arange(1, 149), 148 - missing, replace=False)]))
    row = imported(store, table(line()[kept]))
    assert row.statistics.lost == missing
    assert row.verdict == ("reject" if missing > 7 else "repaired")


def test_an_irregular_clock_tells_nothing_of_losses(store: Store) -> None:
    rows = line()
    rows[:, 0] = np.cumsum(np.random.default_rng(1).uniform(0.005, 0.06, 150))
    assert imported(store, table(rows)).statistics.lost == 0


def test_the_numbers_of_the_file_tell_what_is_missing(store: Store) -> None:
    rows = np.column_stack([4 * np.arange(150), line()])
    rows[:, 1] = 0.02 * np.arange(150)
    kept = np.delete(rows, [60, 61], axis=0)
    assert imported(store, table(kept, "frame,t,x,y,z")).statistics.lost == 2


@pytest.mark.parametrize("blank", ["", "nan", "0"])
def test_readings_without_a_place_are_untracked(store: Store, blank: str) -> None:
    lines = table(line()).splitlines()
    for k in (40, 41, 90):
        lines[k] = ",".join([lines[k].split(",")[0], blank, blank, blank])
    row = imported(store, "\n".join(lines) + "\n")
    assert (row.verdict, row.statistics.untracked, row.statistics.lost) == ("repaired", 3, 0)


def test_a_tracked_column_counts(store: Store) -> None:
    seen = np.ones(150)
    seen[50:53] = 0
    assert imported(store, table(np.column_stack([line(), seen]), "t,x,y,z,tracked")).statistics.untracked == 3


def test_rows_out_of_order_are_put_where_their_time_puts_them(store: Store) -> None:
    rows = line()
    rows[[70, 71]] = rows[[71, 70]]
    row = imported(store, table(rows))
    assert (row.statistics.reordered, row.statistics.lost) == (1, 0)


def test_rows_that_come_twice_are_counted_and_rows_of_one_time_are_told(store: Store) -> None:
    assert imported(store, table(np.insert(line(), 70, line()[70], axis=0))).statistics.duplicated == 1
    rows = line()
    rows[71, 0] = rows[70, 0]
    assert "1 rows have the time of the row before" in " ".join(imported(store, table(rows)).statistics.notes)


def shown(seed: int, pause: float = 0.0) -> str:
    positions, _ = pick_and_place(np.random.default_rng([seed, 3]), pause=pause)
    return table(np.column_stack([np.arange(len(positions)) / 100, positions]))


def test_taking_and_putting_are_found_in_the_motion(store: Store) -> None:
    row = imported(store, shown(1))
    assert row.verdict == "clean"
    assert 50 < row.grasp < 120
    assert 200 < row.release < 300


def test_a_motion_that_leaves_it_open_is_rejected_until_it_is_marked(store: Store) -> None:
    row = imported(store, shown(1, pause=0.5))
    assert row.verdict == "reject"
    assert "not sure where the object was taken and put: the hand dwells at 3 places" in row.reasons[0]
    annotations = Annotations(store, SETTINGS, lambda _: EMPTY_ARGUMENTS)
    trimmed = annotations.amend(row.id, Amendment(trim=(80, 250)))
    assert (trimmed.verdict, trimmed.reasons) == ("clean", ())
    assert annotations.amend(row.id, Amendment(trim=(0, 0))).reasons == row.reasons


def test_marks_win(store: Store) -> None:
    for pause in (0.0, 0.5):
        row = imported(store, shown(1, pause=pause), grasp=0.9, release=2.2)
        assert (row.verdict, row.grasp, row.release) == ("clean", 90, 221)
    whole = imported(store, shown(1), whole=True)
    assert (whole.grasp, whole.release) == (0, whole.samples)
    with pytest.raises(UnusableRecording, match=r"marks 2 and 1 s must rise and lie in the motion, 0 to"):
        imported(store, shown(1), grasp=2.0, release=1.0)


def test_a_grasp_column_tells_the_phases(store: Store) -> None:
    closed = np.zeros(150)
    closed[30:120] = 1
    row = imported(store, table(np.column_stack([line(), closed]), "t,x,y,z,grasp"))
    assert (row.grasp, row.release) == (30, 120)


def test_a_hand_that_does_not_move_is_no_demonstration(store: Store) -> None:
    rows = line()
    rows[:, 1:] = rows[0, 1:]
    with pytest.raises(UnusableRecording, match="the hand moves by 0 cm"):
        imported(store, table(rows))


def test_a_reading_that_repeats_at_speed_is_no_leap(store: Store) -> None:
    k = np.arange(60)
    x = 0.025 * k - 0.7
    x[31:] += 0.025  # the reading before took the time of two
    x[30], y = x[29], 0.001 * k
    y[30] = y[29]
    row = imported(store, table(np.column_stack([0.01 * k, x, y, 0 * k + 0.5])), whole=True)
    assert (row.verdict, row.statistics.level_shifts) == ("repaired", 0)
