import threading

import pytest

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.records import RecordingRequest, StopRequest
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import PERIOD_NS, START_NS, demonstration, sample


def test_a_stream_becomes_demonstrations_with_every_sample_in_order(bench: Bench) -> None:
    bench.begin()
    stream = [s for i in range(3) for s in demonstration(1 + 110 * i)]
    bench.send(stream)
    report = bench.end(330)
    assert (report.received, report.lost, len(report.demonstrations)) == (330, 0, 3)
    rows = bench.store.demonstrations("lift")
    assert [row.number for row in rows] == [1, 2, 3]
    assert [row.id for row in rows] == list(report.demonstrations) == [d.id for d, _ in bench.recorded]
    stored = [s for row in rows for s in bench.store.recordings.samples(row.recording)]
    assert [s.sequence for s in stored] == [s.sequence for s in stream[: len(stored)]]
    assert len(stored) + report.idle == len(stream)
    assert all(row.verdict == "clean" for row in rows)


def test_the_handshake_counts_what_never_came(bench: Bench) -> None:
    bench.begin()
    stream = demonstration()
    bench.send(stream[:40] + stream[42:])
    report = bench.end(115)
    assert report.lost == 2 + 5
    assert bench.store.demonstrations("lift")[0].statistics.lost == 2
    assert bench.store.demonstrations("lift")[0].verdict == "repaired"


@pytest.mark.parametrize(("hole", "way"), [(range(2, 18), "reaching"), (range(73, 90), "returning")])
def test_a_hole_on_the_way_is_said_and_the_take_and_the_next_one_are_learned_from(
    bench: Bench, hole: range, way: str
) -> None:
    bench.begin()
    stream = [s for i in range(2) for s in demonstration(1 + 110 * i)]
    bench.send([s for i, s in enumerate(stream) if i not in hole])
    assert bench.end(220).lost == len(hole)
    holed, whole = bench.store.demonstrations("lift")
    assert (holed.verdict, holed.statistics.lost, whole.verdict) == ("repaired", len(hole), "clean")
    seconds = (len(hole) + 1) * PERIOD_NS * 1e-9
    said = f"a gap of {seconds:.2f} s, {len(hole)} samples lost"
    assert holed.reasons == (f"while {way}, outside what is learned: {said}",)
    assert holed.is_usable


def test_rubbish_is_counted_and_harms_nothing(bench: Bench) -> None:
    bench.begin()
    stream = demonstration()
    bench.send(stream[:30])
    for payload in (b"rubbish", b"", bytes(100_000)):
        bench.bus.publish(KEYS.samples("glove"), payload)
    bench.send([sample(31, (float("nan"), 0.0, 0.0))])
    bench.send(stream[31:])
    report = bench.end(110)
    assert report.refused == 4
    assert report.lost == 0  # number 31 was refused, not lost
    assert any("not finite" in note for note in report.notes)
    assert len(report.demonstrations) == 1


def test_sequence_numbers_that_go_back_are_told_apart(bench: Bench) -> None:
    bench.begin()
    stream = demonstration()
    bench.send([*stream[:50], stream[51], stream[50], stream[51], stream[10], *stream[52:]])
    report = bench.end(110)
    assert (report.reordered, report.duplicated, report.lost) == (1, 2, 0)
    row = bench.store.demonstrations("lift")[0]
    assert row.verdict == "repaired"
    assert len(bench.store.recordings.samples(row.recording)) == row.samples == 110 + 2 - report.idle


def test_two_trackers_do_not_mix(bench: Bench) -> None:
    bench.begin("left", "a")
    bench.begin("right", "b")
    for one, other in zip(demonstration(), demonstration(), strict=True):
        bench.send([one], "left")
        bench.send([other], "right")
    assert bench.end(110, "left").received == bench.end(110, "right").received == 110
    assert len(bench.store.demonstrations("a")) == len(bench.store.demonstrations("b")) == 1


def test_a_grasp_that_is_let_go_at_once_is_no_demonstration(bench: Bench) -> None:
    bench.begin()
    bench.send(demonstration(transport=8))
    report = bench.end(68)
    assert not report.demonstrations
    assert any("let go at once" in note for note in report.notes)
    assert bench.store.recordings.unfinished() == []


def test_ending_while_the_glove_is_closed_is_a_reject_and_discard_throws_it_away(bench: Bench) -> None:
    bench.begin()
    bench.send(demonstration()[:60])
    bench.end(60)
    assert [d.verdict for d in bench.store.demonstrations("lift")] == ["reject"]
    bench.begin()
    bench.send(demonstration()[:60])
    assert not bench.end(60, discard=True).demonstrations
    assert len(bench.store.demonstrations("lift")) == 1
    assert bench.store.recordings.unfinished() == []


@pytest.mark.parametrize("name", ["", "a/b", "../etc", "a..b", "x" * 65, "a b", "-a", "ü", "a\x00"])
def test_names_that_could_leave_the_folder_are_refused(bench: Bench, name: str) -> None:
    with pytest.raises(UnusableInput, match="cannot name a task"):
        bench.begin(task=name)
    with pytest.raises(UnusableInput, match="cannot name a tracker"):
        bench.begin(tracker=name)


def test_refusals_say_what_is_running(bench: Bench) -> None:
    bench.begin()
    with pytest.raises(Conflict, match="already recording lift"):
        bench.begin()
    with pytest.raises(NotFound, match=r"running: \['glove'\]"):
        bench.recorder.end(StopRequest("other"))
    with pytest.raises(NotFound, match="no task"):
        bench.recorder.begin(RecordingRequest("unknown", "other"))
    with pytest.raises(UnusableInput, match="not a StartRecording"):
        bench.bus.ask(KEYS.recorder_start, b"\xff\xff")


def test_a_folder_that_cannot_be_written_is_said_and_the_next_take_is_tried_again(bench: Bench) -> None:
    folder = bench.store.recordings.folder("lift")
    folder.parent.mkdir(parents=True)
    folder.write_text("a file where the folder should be")
    bench.begin()
    bench.send(demonstration())
    report = bench.end(110)
    assert report.received == 110
    assert not report.demonstrations
    assert any("cannot be written" in note for note in report.notes)
    folder.unlink()
    bench.begin()
    bench.send(demonstration())
    assert len(bench.end(110).demonstrations) == 1


def test_commands_from_several_threads_leave_one_recording(bench: Bench) -> None:
    outcomes: list[str] = []

    def try_begin() -> None:
        try:
            bench.begin()
            outcomes.append("began")
        except Conflict:
            outcomes.append("conflict")

    threads = [threading.Thread(target=try_begin) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcomes) == ["began"] + ["conflict"] * 7


def test_an_endless_reach_does_not_fill_the_disk(bench: Bench) -> None:
    bench.begin()
    resting = [sample(i, (0.0, 0.5, 0.5)) for i in range(1, 61_000_000_000 // PERIOD_NS + 10)]
    bench.send(resting)
    bench.send(demonstration(len(resting) + 1))
    report = bench.end(len(resting) + 110)
    assert len(report.demonstrations) == 1
    assert bench.store.demonstrations("lift")[0].samples < 200
    assert report.received == len(resting) + 110


def test_a_grasp_that_ends_a_take_is_the_first_sample_of_the_next_in_all_statistics(bench: Bench) -> None:
    bench.begin()
    carry = demonstration(transport=40)[20:75]  # no rest: the hand comes back and takes the object again
    stream = [
        s._replace(sequence=n, device_ns=START_NS + n * PERIOD_NS, receive_ns=START_NS + n * PERIOD_NS)
        for n, s in enumerate([*demonstration()[:20], *carry, *carry, *demonstration(transport=40)[20:]], 1)
    ]
    bench.send(stream)
    bench.end(len(stream))
    rows = bench.store.demonstrations("lift")
    assert [row.statistics.received for row in rows] == [row.samples for row in rows]
    assert [row.verdict for row in rows] == ["clean"] * 3
    assert [row.grasp for row in rows] == [20, 0, 0]
