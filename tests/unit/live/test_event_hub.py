import threading

from teachpath.live.event_hub import RESYNC_TOPIC, Document, EventHub, Subscriber
from teachpath.live.state_poller import StatePoller
from tests.waiting import HANG


def listen(hub: EventHub) -> Subscriber:
    return hub.subscribe(lambda: None)


def taken(subscriber: Subscriber) -> list[Document]:
    events = []
    while (event := subscriber.pop()) is not None:
        events.append(event)
    return events


def about(events: list[Document]) -> list[tuple[str, str]]:
    return [(event["topic"], event["id"]) for event in events]


def test_a_listener_reads_everything_first_and_then_hears_of_changes_in_their_order() -> None:
    hub = EventHub()
    hub.publish_change("tasks", "before")
    subscriber = listen(hub)
    assert about(taken(subscriber)) == [(RESYNC_TOPIC, "")]
    hub.publish_change("tasks", "a")
    hub.publish_change("runs", "b")
    events = taken(subscriber)
    assert about(events) == [("tasks", "a"), ("runs", "b")]
    assert events[0]["sequence"] < events[1]["sequence"]


def test_what_changes_twice_is_told_once_and_later() -> None:
    hub = EventHub()
    subscriber = listen(hub)
    taken(subscriber)
    for topic in ("jobs", "runs", "jobs"):
        hub.publish_change(topic, "x")
    assert about(taken(subscriber)) == [("runs", "x"), ("jobs", "x")]


def test_whoever_falls_behind_reads_everything_anew_and_keeps_how_things_stand() -> None:
    hub = EventHub(max_pending=10)
    subscriber = listen(hub)
    taken(subscriber)
    hub.publish_state("executor", "", {"progress": 0.5})
    for i in range(1000):
        hub.publish_change("demonstrations", str(i))
        assert subscriber.pending <= 12
    events = taken(subscriber)
    assert about(events) == [(RESYNC_TOPIC, ""), ("executor", "")]
    hub.publish_change("tasks", "after")
    assert about(taken(subscriber)) == [("tasks", "after")]


def test_what_stands_is_told_to_whoever_comes_later_until_it_is_gone() -> None:
    hub = EventHub()
    hub.publish_state("trackers", "glove", {"announced": True})
    assert taken(listen(hub))[1]["now"] == {"announced": True}
    early = listen(hub)
    hub.publish_state("trackers", "glove", None)
    assert taken(early)[-1]["now"] is None
    assert about(taken(listen(hub))) == [(RESYNC_TOPIC, "")]


def test_listeners_are_woken_and_those_that_have_left_are_not() -> None:
    hub, woken = EventHub(), []
    one, other = hub.subscribe(lambda: woken.append(1)), hub.subscribe(lambda: woken.append(2))
    hub.publish_change("tasks", "a")
    hub.unsubscribe(one)
    hub.publish_change("tasks", "b")
    assert woken.count(1) == 1
    assert woken.count(2) == 2
    assert other.pending


def test_many_threads_tell_and_no_sequence_number_comes_twice() -> None:
    hub = EventHub(max_pending=10_000)
    subscriber = listen(hub)
    taken(subscriber)
    threads = [
        threading.Thread(target=lambda t=t: [hub.publish_change(f"t{t}", str(i)) for i in range(200)])  # type: ignore[misc]
        for t in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    numbers = [event["sequence"] for event in taken(subscriber)]
    assert len(set(numbers)) == len(numbers) == 1600


def test_the_lookout_tells_what_is_different_and_nothing_else() -> None:
    hub = EventHub()
    now: dict[str, Document] = {"glove": {"received": 1}}
    poller = StatePoller(hub, {"recordings": lambda: now})
    subscriber = listen(hub)
    taken(subscriber)
    poller.poll()
    poller.poll()
    assert [event["now"] for event in taken(subscriber)] == [{"received": 1}]
    now = {"hand": {"received": 5}}
    poller.poll()
    assert {event["id"]: event["now"] for event in taken(subscriber)} == {"glove": None, "hand": {"received": 5}}


def test_a_look_that_fails_does_not_end_the_lookout() -> None:
    hub, looked = EventHub(), threading.Event()
    calls = []

    def poll() -> dict[str, Document]:
        calls.append(1)
        if len(calls) == 1:
            raise OSError("the disk is away")
        looked.set()
        return {}

    poller = StatePoller(hub, {"station": poll}, interval=0.01)
    poller.start()
    assert looked.wait(HANG)
    poller.stop()
