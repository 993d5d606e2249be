"""What operators say of demonstrations that are stored, over Zenoh queries and directly."""

import time
from dataclasses import replace
from pathlib import Path

import pytest

from teachpath.errors import NotFound, UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import Amendment
from teachpath_proto import tracker_pb2
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import demonstration

SAMPLE_COUNT = 110


@pytest.fixture
def shown(bench: Bench) -> Bench:
    """A bench on which three demonstrations were shown, and the recording is still running."""
    bench.begin()
    bench.send([s for i in range(3) for s in demonstration(1 + i * SAMPLE_COUNT)])
    bench.received(3 * SAMPLE_COUNT)
    return bench


def pick(bench: Bench, key: str, **who: str) -> tracker_pb2.DemonstrationReport:
    answer = bench.bus.ask(key, tracker_pb2.PickDemonstration(**who).SerializeToString())
    return tracker_pb2.DemonstrationReport.FromString(answer)


def test_discarding_goes_back_one_by_one_and_restoring_undoes_it(shown: Bench) -> None:
    before = shown.store.demonstrations("lift")
    assert [pick(shown, KEYS.recorder_discard, tracker="glove").number for _ in range(2)] == [3, 2]
    assert [d.is_usable for d in shown.store.demonstrations("lift")] == [True, False, False]
    assert [pick(shown, KEYS.recorder_restore, task="lift").number for _ in range(2)] == [2, 3]
    assert shown.store.demonstrations("lift") == before
    assert [d.number for d in shown.changed] == [3, 2, 2, 3]
    for row in before:
        assert shown.store.recordings.path(row.recording).exists()


def test_there_may_be_nothing_to_discard_or_to_restore(shown: Bench) -> None:
    with pytest.raises(NotFound, match="no discarded demonstration"):
        pick(shown, KEYS.recorder_restore, task="lift")
    for _ in range(3):
        pick(shown, KEYS.recorder_discard, task="lift")
    with pytest.raises(NotFound, match="no demonstration that could be discarded"):
        pick(shown, KEYS.recorder_discard, task="lift")
    with pytest.raises(NotFound, match="no task 'moon'"):
        pick(shown, KEYS.recorder_discard, task="moon")
    with pytest.raises(NotFound, match="is not being recorded"):
        pick(shown, KEYS.recorder_discard, tracker="other")
    with pytest.raises(UnusableInput, match="name the task"):
        pick(shown, KEYS.recorder_discard)


def test_the_last_is_that_of_this_station_where_several_share_a_store(shown: Bench, tmp_path: Path) -> None:
    row = shown.store.demonstrations("lift")[0]
    one, other = (Store(StoreSettings(data_dir=str(tmp_path / "shared"), station=name)) for name in ("one", "other"))
    one.ensure_task("lift", scene="paper", calibration="identity")
    first, second, newest = (
        store.add_demonstration(replace(row, id=f"{number}" * 12)).id
        for number, store in enumerate((one, one, other), 1)
    )
    annotations = replace(shown.recorder.annotations, store=one)
    assert [annotations.discard_last("lift").id for _ in range(2)] == [second, first]
    with pytest.raises(NotFound, match="discarded of station 'one'"):
        annotations.discard_last("lift")
    assert not one.demonstration(newest).discarded_ns
    other.change_demonstration(newest, discarded_ns=time.time_ns() + 10**9)  # last of all
    assert annotations.restore_last("lift").id == first


def test_a_mark_is_kept_and_a_bad_one_is_not_learned_from(shown: Bench) -> None:
    key = shown.store.demonstrations("lift")[1].id
    request = tracker_pb2.AmendDemonstration(demonstration=key, mark="bad")
    shown.bus.ask(KEYS.recorder_amend, request.SerializeToString())
    assert [d.mark for d in shown.store.demonstrations("lift")] == ["", "bad", ""]
    assert not shown.store.demonstration(key).is_usable
    assert shown.recorder.annotations.amend(key, Amendment(mark="")).is_usable
    with pytest.raises(UnusableInput, match="'so-so' is no mark"):
        shown.recorder.annotations.amend(key, Amendment(mark="so-so"))
    with pytest.raises(NotFound):
        shown.recorder.annotations.amend("moon", Amendment(mark="bad"))


def test_trimming_changes_what_is_learned_and_keeps_what_was_recorded(shown: Bench) -> None:
    row = shown.store.demonstrations("lift")[0]
    whole = shown.recorder.annotations.trajectory(row)
    trim = tracker_pb2.Span(begin=row.grasp + 5, end=row.release - 10)
    request = tracker_pb2.AmendDemonstration(demonstration=row.id, trim=trim)
    answer = tracker_pb2.DemonstrationReport.FromString(shown.bus.ask(KEYS.recorder_amend, request.SerializeToString()))
    assert (answer.transport.begin, answer.transport.end) == (row.grasp + 5, row.release - 10)
    trimmed = shown.store.demonstration(row.id)
    assert (trimmed.grasp, trimmed.release, trimmed.samples) == (row.grasp, row.release, row.samples)
    shorter = shown.recorder.annotations.trajectory(trimmed)
    assert len(shorter) == len(whole) - 15
    assert trimmed.duration == pytest.approx(shorter.times[-1])
    assert shown.recorder.annotations.amend(row.id, Amendment(trim=(0, 0))) == row


@pytest.mark.parametrize("trim", [(-1, 40), (0, 10_000), (40, 20), (10, 15)])
def test_a_trim_that_is_no_transport_phase_is_refused(shown: Bench, trim: tuple[int, int]) -> None:
    row = shown.store.demonstrations("lift")[0]
    with pytest.raises(UnusableInput, match="no transport phase of a recording with"):
        shown.recorder.annotations.amend(row.id, Amendment(trim=trim))
    assert shown.store.demonstration(row.id) == row


def test_what_is_left_of_a_trimmed_demonstration_is_judged(bench: Bench) -> None:
    bench.begin()
    holed = [s for i, s in enumerate(demonstration(transport=60)) if not 60 <= i < 75]
    bench.send(holed)
    bench.end(120)
    (row,) = bench.store.demonstrations("lift")
    assert (row.verdict, row.reasons[-1]) == ("reject", "15 samples lost")
    trimmed = bench.recorder.annotations.amend(row.id, Amendment(trim=(row.grasp, row.grasp + 35)))
    assert trimmed.reasons == ("while returning, outside what is learned: a gap of 0.32 s, 15 samples lost",)
    assert trimmed.is_usable
    assert bench.recorder.annotations.amend(row.id, Amendment(trim=(row.grasp + 5, row.release))).verdict == "reject"
    assert bench.recorder.annotations.amend(row.id, Amendment(trim=(0, 0))) == row


def test_no_trim_forgives_a_tracker_that_went_away(bench: Bench) -> None:
    bench.begin()
    bench.send(demonstration()[:60])
    bench.end(60)
    (row,) = bench.store.demonstrations("lift")
    trimmed = bench.recorder.annotations.amend(row.id, Amendment(trim=(row.grasp, row.grasp + 30)))
    assert (trimmed.verdict, trimmed.reasons) == ("reject", ("the recording ended before the hand let go",))
