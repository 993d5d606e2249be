from typing import Any

import pytest

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.wire import encode_sample
from teachpath.recorder import websocket_trackers
from teachpath.recorder.websocket_trackers import WebSocketTracker, WebSocketTrackers
from teachpath.records import Sample
from tests.unit.recorder.recorders import KEYS, Bench
from tests.unit.recording.hands import demonstration, sample
from tests.waiting import wait_until


class Desk:
    """WebSocket trackers on a bench, and the reasons why some were disconnected."""

    def __init__(self, bench: Bench) -> None:
        self.bench, self.now, self.reasons = bench, 0.0, list[str]()
        self.trackers = WebSocketTrackers(bench.bus, KEYS, bench.recorder, clock=lambda: self.now)

    def register(self, name: str = "page", session: str = "secret") -> WebSocketTracker:
        return self.trackers.register(name, self.reasons.append, session)


@pytest.fixture
def desk(bench: Bench) -> Desk:
    return Desk(bench)


def as_json(s: Sample) -> dict[str, Any]:
    x, y, z = s.position
    named = {"sequence": s.sequence, "device_ns": s.device_ns, "position": {"x": x, "y": y, "z": z}}
    return named | {"flexions": list(s.flexions), "tracked": s.tracked, "buttons": s.buttons}


def test_a_demonstration_over_a_websocket_gets_the_verdict_and_the_statistics_of_any_other(desk: Desk) -> None:
    stream = demonstration()
    bench = desk.bench
    bench.begin("page")
    page = desk.register()
    for s in stream[:55]:
        assert page.publish(as_json(s)) == ""
    for s in stream[55:]:
        assert page.publish(encode_sample(s)) == ""
    report = page.end_recording(len(stream), discard=False)
    bench.begin("glove", "other")
    bench.send(stream)
    other = bench.end(len(stream))
    assert (page.accepted, page.refused) == (len(stream), 0)
    ours, theirs = bench.store.demonstrations("lift"), bench.store.demonstrations("other")
    assert [(d.verdict, d.samples, d.grasp, d.release) for d in ours] == [
        ("clean", len(stream) - report["idle"], 20, 70)
    ]
    assert [(d.verdict, d.samples, d.grasp, d.release) for d in theirs] == [
        (d.verdict, d.samples, d.grasp, d.release) for d in ours
    ]
    assert (report["received"], report["lost"]) == (other.received, other.lost)
    with pytest.raises(NotFound, match="not being recorded"):
        page.end_recording(1, discard=False)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"position": {"x": float("nan")}}, "not finite"),
        ({"position": {"x": float("inf")}}, "not finite"),
        ({"position": {"x": 580.0}}, "are its units metres"),
        ({"orientation": {"w": 2.0}}, "no unit quaternion"),
        ({"flexions": [0.5] * 7}, "7 flexions"),
        ({"flexions": [1.5] * 18}, "outside 0"),
        ({"device_ns": 0}, "nanoseconds since the Unix epoch"),
    ],
)
def test_unsound_values_are_refused_with_a_sentence_and_counted_by_the_recorder_too(
    desk: Desk, changes: dict[str, Any], sentence: str
) -> None:
    desk.bench.begin("page")
    page = desk.register()
    assert sentence in page.publish(as_json(sample(1, (0.5, 0.0, 0.5))) | changes)
    assert page.publish(as_json(sample(2, (0.5, 0.0, 0.5)))) == ""
    report = page.end_recording(2, discard=True)
    assert (page.accepted, page.refused, report["received"], report["refused"]) == (1, 1, 1, 1)


@pytest.mark.parametrize(
    "content",
    [
        {"sequence": -1},
        {"sequence": 2**64},
        {"sequence": "1"},
        {"sequence": 1.5},
        {"position": [1, 2, 3]},
        {"position": {"x": "1"}},
        {"flexions": "open"},
        {"self": 1},
        {"colour": "\ud800"},
        b"rubbish",
        bytes(100_000),
    ],
)
def test_what_is_no_sample_is_refused_and_does_not_reach_the_bus(desk: Desk, content: Any) -> None:
    seen: list[bytes] = []
    desk.bench.bus.subscribe(KEYS.all_samples, lambda _, payload: seen.append(payload))
    page = desk.register()
    assert len(page.publish(content)) > 15
    assert (seen, page.refused) == ([], 1)


def test_a_flood_has_to_leave_and_a_burst_after_a_pause_may_stay(desk: Desk) -> None:
    page = desk.register()
    one = as_json(sample(1, (0.5, 0.0, 0.5)))
    for _ in range(int(websocket_trackers.RATE_BURST)):
        page.publish(one)
    with pytest.raises(UnusableInput, match="faster than 1000 a second"):
        page.publish(one)
    desk.now += 1.0
    for _ in range(int(websocket_trackers.RATE_LIMIT) - 1):
        page.publish(one)


def test_one_that_never_makes_sense_has_to_leave(desk: Desk) -> None:
    page = desk.register()
    for _ in range(websocket_trackers.MAX_CONSECUTIVE_REJECTS):
        page.refuse("nonsense")
    with pytest.raises(UnusableInput, match="101 messages in a row were refused; the last one: nonsense"):
        page.refuse("nonsense")


def test_names_are_kept_apart(desk: Desk) -> None:
    with pytest.raises(UnusableInput, match="cannot name a tracker"):
        desk.register("../glove")
    token = desk.bench.bus.announce(KEYS.alive("tracker", "glove"))
    desk.bench.begin("glove")
    wait_until(desk.bench.recorder.trackers, "the tracker is there")
    with pytest.raises(Conflict, match="a tracker glove is there already"):
        desk.register("glove")
    token.close()
    many = [desk.register(f"page-{k}") for k in range(websocket_trackers.MAX_TRACKERS)]
    with pytest.raises(Conflict, match="close some"):
        desk.register("one-more")
    desk.trackers.unregister(many[0])
    desk.trackers.unregister(many[0])
    desk.register("one-more")


def test_one_that_comes_back_at_once_is_not_taken_for_another(desk: Desk) -> None:
    recorder = desk.bench.recorder
    page = desk.register()
    wait_until(lambda: any(tracker.announced for tracker in recorder.trackers()), "the tracker is there")
    other = desk.bench.bus.announce(KEYS.alive("tracker", "page"))  # as if the bus still told of it
    desk.trackers.unregister(page)
    desk.trackers.unregister(desk.register())
    other.close()
    desk.now += websocket_trackers.REANNOUNCE_GRACE
    desk.bench.bus.announce(KEYS.alive("tracker", "page"))
    wait_until(lambda: any(tracker.announced for tracker in recorder.trackers()), "the tracker is there")
    with pytest.raises(Conflict):
        desk.register()


@pytest.mark.parametrize(("mine", "other"), [("secret", "guess"), ("secret", ""), ("", "")])
def test_nobody_else_connects_under_a_name_until_it_is_left(desk: Desk, mine: str, other: str) -> None:
    page = desk.register(session=mine)
    with pytest.raises(Conflict, match="page is connected already; choose another name"):
        desk.register(session=other)
    assert desk.reasons == []
    desk.trackers.unregister(page)
    desk.register(session=other)


def test_a_page_that_comes_back_takes_its_own_place_and_leaving_is_seen_on_the_bus(desk: Desk) -> None:
    alive: list[tuple[str, bool]] = []
    desk.bench.bus.watch(KEYS.all_trackers_alive, lambda key, there: alive.append((key.rsplit("/")[-1], there)))
    first = desk.register()
    second = desk.register()
    assert desk.reasons == ["page has connected again"]
    desk.trackers.unregister(first)  # its connection ends later than the new one began
    assert alive == [("page", True), ("page", False), ("page", True)]
    desk.trackers.unregister(second)
    assert alive[-1] == ("page", False)
