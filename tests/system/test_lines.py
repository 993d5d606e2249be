"""Samples that are lost, doubled, late or cut off on a real line: the account says exactly which."""

import itertools
import random
import threading
import time
from pathlib import Path

import pytest

from tests.system.lines import KEYS, bad_line, desk, plain_session, publish, stretches
from tests.unit.recording.hands import demonstration
from tests.waiting import wait_until

pytestmark = pytest.mark.system

SAMPLE_COUNT = 110


def test_what_a_client_skips_doubles_and_sends_late_is_named_number_by_number(tmp_path: Path) -> None:
    chance = random.Random(3)
    stream = [s for i in range(4) for s in demonstration(1 + i * SAMPLE_COUNT)]
    last = len(stream)
    gone = sorted({n for start in chance.sample(range(20, last - 20), 8) for n in range(start, start + 2)})
    left = [s for s in stream if s.sequence not in gone]
    doubled = chance.sample([s.sequence for s in left], 7)
    sent = [s for one in left for s in ([one, one] if one.sequence in doubled else [one])]
    late = 0
    for i in range(50, len(sent) - 50, 90):  # neighbours change places
        if sent[i].sequence < sent[i + 1].sequence and sent[i].sequence not in doubled:
            if sent[i + 1].sequence in doubled:
                continue
            sent[i], sent[i + 1] = sent[i + 1], sent[i]
            late += 1
    assert late
    with desk(tmp_path) as here, bad_line(here) as (_, link):
        here.begin("glove", "lift")
        publish(link.publisher(KEYS.samples("glove")), sent)
        report = here.end("glove", last)
    runs = [[gone[0]]]
    for number in gone[1:]:
        runs[-1].append(number) if number == runs[-1][-1] + 1 else runs.append([number])
    assert stretches(report) == [(run[0], run[-1]) for run in runs]
    assert (report.lost, report.duplicated, report.reordered + report.late) == (len(gone), len(doubled), late)
    assert report.received == len(sent)
    assert report.gaps == len(runs)


def test_a_line_that_stalls_loses_nothing(tmp_path: Path) -> None:
    stream = [s for i in range(3) for s in demonstration(1 + i * SAMPLE_COUNT)]
    with desk(tmp_path) as here, bad_line(here) as (proxy, link):
        here.begin("glove", "lift")
        publisher = link.publisher(KEYS.samples("glove"))
        publish(publisher, stream[:150], rate=500.0)
        here.received("glove", 150)
        proxy.stall()
        publish(publisher, stream[150:250], rate=500.0)
        time.sleep(0.5)
        assert here.report("glove").received == 150
        proxy.go_on()
        publish(publisher, stream[250:], rate=500.0)
        report = here.end("glove", len(stream))
        assert (report.received, report.lost, stretches(report)) == (len(stream), 0, [])
        assert [d.statistics.lost for d in here.store.demonstrations("lift")] == [0, 0, 0]


@pytest.mark.parametrize("ours", [True, False])
def test_a_line_that_breaks_loses_what_was_under_way_and_our_client_sends_it_again(tmp_path: Path, ours: bool) -> None:
    takes = itertools.chain.from_iterable(demonstration(1 + i * SAMPLE_COUNT) for i in itertools.count())
    other = [s for i in range(3) for s in demonstration(1 + i * SAMPLE_COUNT)]
    with desk(tmp_path) as here, bad_line(here) as (proxy, link):
        here.begin("glove", "lift")
        here.begin("calm", "other")
        with plain_session(proxy.port) as foreign, plain_session(here.port) as straight:
            publisher = (link.publisher if ours else foreign.declare_publisher)(KEYS.samples("glove"))
            calm = threading.Thread(target=publish, args=(straight.declare_publisher(KEYS.samples("calm")), other))
            publish(publisher, list(itertools.islice(takes, 200)), rate=500.0)
            here.received("glove", 200)
            proxy.drop(cut=True)
            calm.start()
            publish(publisher, list(itertools.islice(takes, 100)), rate=500.0)  # nobody hears these
            proxy.go_on()
            last = 300

            def back() -> bool:
                nonlocal last
                publish(publisher, [next(takes)])
                last += 1
                return here.report("glove").received > 200

            wait_until(back, "the line is back", pause=lambda _: time.sleep(1 / 60))
            rest = -last % SAMPLE_COUNT + 2 * SAMPLE_COUNT  # two whole takes more
            publish(publisher, list(itertools.islice(takes, rest)), rate=60.0)
            last += rest
            calm.join()
            report = here.end("glove", last)
            untouched = here.end("calm", len(other))
        assert (untouched.received, untouched.lost) == (len(other), 0)
        assert report.received + report.lost == last
        if ours:
            assert (report.lost, stretches(report)) == (0, [])
        else:
            assert stretches(report) == [(201, 200 + report.lost)]
            assert report.lost >= 100
            # Where the hole ends is the line's own time: in a phase of a take, or in the next one's grasp; then the
            # take before says how many samples it lacks.
            holed = [d for d in here.store.demonstrations("lift") if d.statistics.lost]
            assert holed
            for take in holed:
                assert take.verdict != "clean"
                said = ("a gap of ", f"{take.statistics.lost} samples lost")
                assert any(words in reason for reason in take.reasons for words in said), take.reasons
