"""Take after take without a hand on the keyboard: countdown, series, one by one, and the signs of a fist."""

import pytest

from teachpath.errors import UnusableInput
from teachpath.records import Sample
from tests.unit.recorder.recorders import Bench
from tests.unit.recording.hands import demonstration, sample

SAMPLE_COUNT = 110  # samples of a demonstration
OTHER_PLACE = (0.2, 0.5, 0.5)


def show(bench: Bench, take: int) -> None:
    bench.send(demonstration(1 + (take - 1) * SAMPLE_COUNT))
    bench.received(take * SAMPLE_COUNT)


def fist(first: int, seconds: float) -> list[Sample]:
    held = round(seconds * 50)
    flexions = [(0.1,) * 22] * 10 + [(0.95,) * 22] * held + [(0.1,) * 22] * 20
    return [sample(first + i, OTHER_PLACE, f) for i, f in enumerate(flexions)]


def test_the_countdown_is_told_and_what_is_shown_meanwhile_is_not_recorded(bench: Bench) -> None:
    bench.begin(countdown=3.0)
    bench.now = 1.0
    show(bench, 1)
    report = bench.until(lambda report: True)
    assert (report.state, report.countdown_left, len(report.demonstrations)) == ("countdown", 2.0, 0)
    bench.now = 3.0
    show(bench, 2)
    report = bench.until(lambda report: len(report.demonstrations) == 1)
    assert (report.state, report.countdown_left) == ("countdown", 3.0)  # of the next take, hands-free
    bench.now = 6.0
    show(bench, 3)
    assert len(bench.end(3 * SAMPLE_COUNT).demonstrations) == 2
    assert [d.verdict for d in bench.store.demonstrations("lift")] == ["clean", "clean"]


def test_a_series_pauses_by_itself_and_resuming_begins_another(bench: Bench) -> None:
    bench.begin(takes=2)
    show(bench, 1)
    assert bench.until(lambda report: True).takes_left == 1
    show(bench, 2)
    show(bench, 3)
    report = bench.until(lambda report: report.state == "paused")
    assert (report.takes_left, len(report.demonstrations)) == (0, 2)
    assert bench.recorder.resume("glove").takes_left == 2
    show(bench, 4)
    assert len(bench.end(4 * SAMPLE_COUNT).demonstrations) == 3


def test_one_by_one_waits_for_the_operator(bench: Bench) -> None:
    bench.begin(one_by_one=True)
    show(bench, 1)
    assert bench.until(lambda report: True).state == "paused"
    bench.recorder.resume("glove")
    show(bench, 2)
    assert len(bench.end(2 * SAMPLE_COUNT).demonstrations) == 2


def test_a_countdown_without_an_end_is_refused(bench: Bench) -> None:
    for countdown in (-1.0, 1e9, float("nan")):
        with pytest.raises(UnusableInput, match=r"countdown (of|should be finite)"):
            bench.begin(countdown=countdown)


def test_a_fist_begins_and_pauses_an_armed_recording(bench: Bench) -> None:
    bench.begin(armed=True)
    sign = fist(1, 1.2)
    bench.send(sign)
    assert bench.received(len(sign)).state == "recording"
    again = [sample(s.sequence + len(sign), s.position, s.flexions) for s in demonstration()]
    bench.send(again)
    after = len(sign) + SAMPLE_COUNT
    assert len(bench.received(after).demonstrations) == 1
    second = fist(after + 1, 1.2)
    bench.send(second[:-20])
    assert bench.received(after + len(second) - 20).pending_command == "toggle"
    bench.send(second[-20:])
    assert bench.received(after + len(second)).state == "paused"
    assert bench.end(after + len(second)).lost == 0


def test_a_fist_held_longer_discards_the_last_demonstration_and_once(bench: Bench) -> None:
    bench.begin()
    show(bench, 1)
    show(bench, 2)
    sign = fist(2 * SAMPLE_COUNT + 1, 3.5)
    bench.send(sign)
    bench.end(2 * SAMPLE_COUNT + len(sign))
    first, second = bench.store.demonstrations("lift")
    assert not first.discarded_ns
    assert second.discarded_ns
    assert bench.changed == [second]
    assert bench.recorder.annotations.restore_last("lift") == first.__class__(
        **{f: getattr(second, f) for f in first.__dataclass_fields__} | {"discarded_ns": 0}
    )
