"""What is said of a file before it is imported is what its import does, and nothing is stored."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from teachpath.io.readers.contract import ReadOptions
from teachpath.offline.file_report import FileReport, examine_files, examine_upload
from teachpath.offline.import_job import UPLOAD, ImportOrder
from teachpath.offline.track_samples import MotionMarks, PhaseMarks
from teachpath.recorder.recording_work import call_directly
from teachpath.records import Calibration
from tests.unit.offline.batches import ORDER, run_batch, write_files


def examined(file: Path, order: ImportOrder = ORDER) -> FileReport:
    (report,) = examine_files([file], order, call=call_directly)
    return report


def table(folder: Path, positions: np.ndarray, *, header: str = "t,x,y,z") -> Path:
    file = folder / "motion.csv"
    rows = [f"{k * 0.02:.2f},{x:.4f},{y:.4f},{z:.4f}" for k, (x, y, z) in enumerate(positions.tolist())]
    file.write_text("\n".join([header, *rows]))
    return file


def two_motions(folder: Path) -> Path:
    """Write an array of two motions; where the second one takes and puts the object is not sure."""
    file, motions = folder / "motions.npy", [dwelling(dwells=2), dwelling(dwells=1)]
    count = max(map(len, motions))
    at = [np.linspace(0, len(motion) - 1, count) for motion in motions]
    rows = [[np.interp(k, np.arange(len(m)), axis) for axis in m.T] for k, m in zip(at, motions, strict=True)]
    np.save(file, [np.column_stack([0.02 * np.arange(count), *axes]) for axes in rows])
    return file


def two_markers(folder: Path) -> Path:
    """Write a TRC file of two markers that move alike."""
    file, positions = folder / "markers.trc", 1000 * dwelling(dwells=2)
    head = (
        "PathFileType\t4\t(X/Y/Z)\tmarkers.trc",
        "DataRate\tNumMarkers\tUnits",
        "50\t2\tmm",
        "Frame#\tTime\thand\t\t\telbow\t\t",
        "\t\tX1\tY1\tZ1\tX2\tY2\tZ2",
    )
    rows = [
        "\t".join([str(k + 1), f"{0.02 * k:.2f}", *2 * [f"{c:.2f}" for c in place]])
        for k, place in enumerate(positions.tolist())
    ]
    file.write_text("\n".join([*head, *rows]))
    return file


def dwelling(*, dwells: int) -> np.ndarray:
    """Return a motion (n, 3) [m] that rests at so many places on its way."""
    stops = np.linspace(0.0, 0.8, dwells + 2)
    u = np.linspace(0.0, 1.0, 60)
    smooth = u**3 * (10 - 15 * u + 6 * u**2)
    x = np.concatenate([np.r_[a + (b - a) * smooth, [b] * 12] for a, b in pairwise(stops)])
    noise = np.random.default_rng(1).normal(0.0, 1e-4, (len(x), 3))
    return noise + np.column_stack([x, 0.1 * x, np.full_like(x, 0.5)])


def test_a_report_says_what_the_import_does(tmp_path: Path) -> None:
    files = write_files(tmp_path / "files")
    reports = examine_files(files, ORDER, call=call_directly)
    outcomes = run_batch(tmp_path / "data", files)
    for report, outcome in zip(reports, outcomes, strict=True):
        assert report.file == outcome.file
        assert report.understood[: len(outcome.understood)] == outcome.understood
        kept = ("samples", "verdict", "reasons", "grasp", "release")
        assert [[getattr(row, name) for name in kept] for row in report.made] == [
            [getattr(row, name) for name in kept] for row in outcome.made
        ]


def test_the_curve_is_that_of_the_file_in_the_world(tmp_path: Path) -> None:
    positions = dwelling(dwells=2)
    moved = replace(ORDER, calibration=Calibration("lab", offset=(1.0, 0.0, 0.0)))
    report = examined(table(tmp_path, positions), moved)
    assert report.times[0] == 0.0
    assert report.times[-1] == pytest.approx(0.02 * (len(positions) - 1))
    places = np.array([np.interp(report.times, 0.02 * np.arange(len(positions)), axis) for axis in positions.T]).T
    np.testing.assert_allclose(report.positions, places + np.array([1.0, 0.0, 0.0]), atol=1e-4)
    assert "frame: calibration lab" in report.understood


def test_taking_and_putting_are_told_or_asked_for(tmp_path: Path) -> None:
    sure = examined(table(tmp_path, dwelling(dwells=2)))
    assert sure.unsure == ()
    assert sure.grasp is not None
    assert sure.release is not None
    assert 0.0 < sure.grasp < sure.release < sure.times[-1]
    file = table(tmp_path, dwelling(dwells=1))
    unsure = examined(file)
    assert unsure.unsure == (1,)
    assert unsure.dwell_times
    assert [str(row.verdict) for row in unsure.made] == ["reject"]
    marked = examined(file, replace(ORDER, marks=PhaseMarks(0.5, 2.0)))
    assert marked.unsure == ()
    assert (marked.grasp, marked.release) == pytest.approx((0.5, 2.0), abs=0.02)


def test_a_refused_file_says_why_and_what_its_columns_are_called(tmp_path: Path) -> None:
    file = table(tmp_path, dwelling(dwells=2), header="when,a,b,c")
    report = examined(file)
    assert report.columns == ("when", "a", "b", "c")
    assert "no column for t, x, y, z" in report.refusal
    assert report.question
    assert report.question.option == "columns"
    assert "--" not in report.question.problem
    assert (report.times, report.made) == ((), ())
    mapped = examined(file, replace(ORDER, options=ReadOptions(columns="t=1,x=2,y=3,z=4")))
    assert mapped.refusal == ""
    assert mapped.made


def test_each_motion_of_several_is_shown_and_marked_alone(tmp_path: Path) -> None:
    file = two_motions(tmp_path)
    found = examined(file)
    assert (found.motions, found.unsure, found.motion) == (2, (2,), 1)
    assert [str(row.verdict) for row in found.made] == ["clean", "reject"]

    marked = replace(ORDER, folder=tmp_path, name=UPLOAD, motion_marks=(MotionMarks(0.5, 2.0, motion=2),))
    file.rename(tmp_path / UPLOAD)
    shown = examine_upload(marked, 2)
    assert (shown.unsure, shown.motion) == ((), 2)
    assert (shown.grasp, shown.release) == pytest.approx((0.5, 2.0), abs=0.02)
    assert [str(row.verdict) for row in shown.made] == ["clean", "clean"]
    assert shown.made[0].transport == found.made[0].transport
    assert examine_upload(marked, 9).motion == 1
    beyond = examine_upload(replace(marked, motion_marks=(MotionMarks(0.5, 2.0, motion=3),)))
    assert "motion 3 is marked, of 2" in beyond.refusal
    wrong = examine_upload(replace(marked, motion_marks=(MotionMarks(2.0, 0.5, motion=2),)))
    assert "motion 2: the marks 2 and 0.5 s must rise" in wrong.refusal


def test_bodies_to_choose_from_are_named(tmp_path: Path) -> None:
    report = examined(two_markers(tmp_path))
    assert report.question
    assert (report.question.option, report.choices) == ("track", ("hand", "elbow"))
    chosen = examined(two_markers(tmp_path), replace(ORDER, options=ReadOptions(track="elbow")))
    assert (chosen.refusal, chosen.choices) == ("", ("hand", "elbow"))


def test_what_is_read_is_shown_though_it_makes_no_demonstration(tmp_path: Path) -> None:
    report = examined(table(tmp_path, np.full((60, 3), 0.5)))
    assert "carries nothing" in report.refusal
    assert len(report.times) == 60


def test_nothing_is_left_beside_an_upload(tmp_path: Path) -> None:
    (file, *_) = write_files(tmp_path / "files")
    before = sorted(tmp_path.rglob("*"))
    examined(file)
    assert sorted(tmp_path.rglob("*")) == before
