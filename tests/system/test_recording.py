"""Hostile and unlucky trackers at a running service: killed, malformed, twice under one name, away in time."""

import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from teachpath_client import ClientError, HandReading, Link, Tracker
from teachpath_client.models import Demonstration, RecordingReport
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys
from tests.system.processes import Service
from tests.system.test_station import FAST_RATE, SAMPLE_COUNT, record, shown
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

KEYS = Keys()
SILENCE = 5  # [s] more than a client that is alive gets no turn


@pytest.fixture(scope="module")
def impatient(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that waits for no tracker that is silent."""
    folder = tmp_path_factory.mktemp("impatient")
    with Service(folder / "data", TEACHPATH_RECORDING__LONGEST_SILENCE=str(SILENCE)) as service:
        yield service


def names(service: Service) -> list[str]:
    return [t.name for t in service.station.health().trackers]


@contextmanager
def hand(service: Service, task: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Show a task by the client's synthetic hand, as tracker glove-TASK; its process is killed in the end."""
    words = ["synthetic", "--task", task, "--scene", "paper", "--tracker", f"glove-{task}", "--speed", "1"]
    command = [sys.executable, "-m", "teachpath_client", *words, "--endpoint", service.endpoint]
    client = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    try:
        yield client
    finally:
        client.send_signal(signal.SIGKILL)
        client.wait(HANG)


def report_of(service: Service, task: str) -> RecordingReport | None:
    """Return the report of the recording of a task, if it has begun."""
    known = {task.name for task in service.station.tasks()}
    running = service.station.recordings(task) if task in known else []
    return running[0] if running else None


def stop_while_it_carries(client: "subprocess.Popen[bytes]", service: Service, task: str) -> None:
    """Stop the process of a hand in mid-take; where this test got no turn before the take was over, in a later one."""

    def carries() -> bool:
        report = report_of(service, task)
        return report is not None and report.phase == "transport" and report.received > 150

    def stopped() -> bool:
        if not carries():
            return False
        client.send_signal(signal.SIGSTOP)
        time.sleep(0.1)  # what it had sent comes
        if not carries():
            client.send_signal(signal.SIGCONT)
        return carries()

    wait_until(stopped, "the hand has carried for a second")


def rejected(service: Service, task: str) -> Demonstration:
    """Wait until a take is rejected, and return it."""
    found = wait_until(
        lambda: next((take for take in service.station.demonstrations(task) if take.verdict == "reject"), None),
        "the take has ended",
    )
    assert found is not None
    return found


def test_a_tracker_that_is_killed_in_mid_take_leaves_a_reject_that_says_so(service: Service) -> None:
    with hand(service, "killed") as client:
        stop_while_it_carries(client, service, "killed")
        assert "glove-killed" in names(service)
    wait_until(lambda: "glove-killed" not in names(service), "the tracker has gone")
    assert rejected(service, "killed").reasons[0] == "the tracker has gone in mid-take"
    (report,) = service.station.recordings("killed")
    assert report.state == "lost"
    with Link(service.endpoint) as link:  # and the next client of that name may begin
        tracker = Tracker(link, "glove-killed")
        tracker.start("killed")
        tracker.publish(shown(1), speed=FAST_RATE)
        assert len(tracker.stop().demonstrations) == 1
    assert [d.verdict for d in service.station.demonstrations("killed")][-2:] == ["reject", "clean"]


def test_a_tracker_whose_process_is_stopped_is_silent_and_its_take_ends(impatient: Service) -> None:
    service = impatient

    def silent() -> bool:
        trackers = {t.name: t for t in service.station.health().trackers}
        return trackers["glove-stopped"].silence > 0.8

    def recorded() -> bool:
        report = report_of(service, "stopped")
        return report is not None and report.state == "recording"

    with hand(service, "stopped") as client:
        stop_while_it_carries(client, service, "stopped")
        wait_until(silent, "the tracker is silent")
        assert rejected(service, "stopped").reasons[0] == f"no sample came for {SILENCE} s in mid-take"
        client.send_signal(signal.SIGCONT)
        wait_until(recorded, "it is recorded again")
        wait_until(lambda: not silent(), "it is heard again")


def malformed(chance: random.Random) -> bytes:
    good = next(iter(shown(1))).message(chance.randrange(10**6), 10**18)
    match chance.randrange(9):
        case 0:
            return chance.randbytes(chance.randrange(400))
        case 1:
            return good.SerializeToString()[: chance.randrange(100)]
        case 2:
            good.position.x = chance.choice([float("nan"), float("inf"), 1e300, -101.0])
        case 3:
            good.orientation.w = chance.choice([float("nan"), 5.0, -0.2])
        case 4:
            good.flexions.extend([0.5] * chance.randrange(1, 300))
        case 5:
            good.flexions[3] = chance.choice([float("nan"), -0.1, 1.1, float("inf")])
        case 6:
            good.device_ns = chance.choice([0, -1, -(2**63)])
        case 7:
            return good.SerializeToString() + b"\x0a" + chance.randbytes(60)
        case 8:
            return bytes(chance.choice([64 * 1024 + 1, 10**6]))
    return good.SerializeToString()


def test_a_thousand_malformed_samples_are_counted_and_other_takes_are_untouched(service: Service) -> None:
    chance = random.Random(5)
    payloads = [malformed(chance) for _ in range(1000)]
    with Link(service.endpoint) as link:
        fuzzed = Tracker(link, "glove-fuzz")
        fuzzed.start("fuzzed", scene="paper")
        publisher = link.publisher(KEYS.samples("glove-fuzz"))

        def rain() -> None:
            for payload in payloads:
                publisher.put(payload)
                time.sleep(0.002)

        raining = threading.Thread(target=rain)
        raining.start()
        calm = record(service, "calm", 2)
        raining.join()
        fuzzed.publish(shown(1), speed=FAST_RATE)
        report = fuzzed.stop()
    assert (calm.received, calm.lost, len(calm.demonstrations)) == (2 * SAMPLE_COUNT, 0, 2)
    assert [d.verdict for d in service.station.demonstrations("calm")] == ["clean", "clean"]
    assert report.received + report.refused == 1000 + SAMPLE_COUNT
    assert report.refused > 800
    assert report.notes
    assert all(len(note) < 400 for note in report.notes)


def test_queries_that_are_malformed_or_misnamed_are_answered_with_a_sentence(service: Service) -> None:
    chance = random.Random(6)
    keys = [
        KEYS.recorder_start,
        KEYS.recorder_stop,
        KEYS.recorder_pause,
        KEYS.recorder_resume,
        KEYS.recorder_discard,
        KEYS.recorder_restore,
        KEYS.recorder_amend,
    ]
    hostile = ["a/b", "..", "a\x00b", "*", "**", "a" * 10_000, "", "ü", "a\nb", "$*"]
    with Link(service.endpoint) as link:
        for key in keys:
            for name in hostile:
                request = tracker_pb2.StartRecording(task=name, tracker=name)
                with pytest.raises(ClientError) as caught:
                    link.ask(key, request.SerializeToString())
                assert len(str(caught.value)) > 10
            for _ in range(20):
                with pytest.raises(ClientError):
                    link.ask(key, chance.randbytes(chance.randrange(1, 60)))
    assert service.station.health().notes == []


def test_two_trackers_of_one_name_are_told_and_their_take_is_not_trusted(service: Service) -> None:
    with Link(service.endpoint) as one, Link(service.endpoint) as other:
        first, second = Tracker(one, "glove-twin"), Tracker(other, "glove-twin")
        first.start("twins", scene="paper")
        with pytest.raises(ClientError, match="already recording twins"):
            second.start("twins")
        meet = threading.Barrier(2)

        def side_by_side() -> Iterator[HandReading]:
            for number, reading in enumerate(shown(1)):
                if number % 50 == 0:  # so that neither has shown its take before the other
                    meet.wait(HANG)
                yield reading

        both = [
            threading.Thread(target=t.publish, args=(side_by_side(),), kwargs={"speed": 8.0}) for t in (first, second)
        ]
        for thread in both:
            thread.start()
        for thread in both:
            thread.join()
        report = first.stop()
    assert any("two trackers share this name" in note for note in report.notes), report
    assert all(d.verdict == "reject" for d in service.station.demonstrations("twins"))


def test_a_client_that_stops_without_a_word_is_not_waited_for(impatient: Service) -> None:
    service = impatient
    with Link(service.endpoint) as link:
        tracker = Tracker(link, "glove-mute")
        tracker.start("mute", scene="paper")
        tracker.publish(list(shown(1))[:200], speed=FAST_RATE)
        wait_until(lambda: service.station.demonstrations("mute"), "the take ends by itself while the client lives")
        (only,) = service.station.demonstrations("mute")
        assert (only.verdict, only.reasons[0]) == ("reject", f"no sample came for {SILENCE} s in mid-take")
        assert tracker.stop().lost == 0
