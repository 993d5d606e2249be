import json
import threading

from teachpath.live.event_hub import RESYNC_TOPIC, Document, EventHub, Subscriber
from teachpath.live.state_poller import StatePoller
from tests.waiting import HANG


def subscribed(hub: EventHub) -> Subscriber:
    return hub.subscribe(lambda: None)


def popped(subscriber: Subscriber) -> list[Document]:
    events = []
    while (event := subscriber.pop()) is not None:
        events.append(event.document)
    return events


def about(events: list[Document]) -> list[tuple[str, str]]:
    return [(event["topic"], event["id"]) for event in events]


def test_a_subscriber_reads_everything_first_and_then_gets_changes_in_their_order() -> None:
    hub = EventHub()
    hub.publish_change("tasks", "before")
    subscriber = subscribed(hub)
    assert about(popped(subscriber)) == [(RESYNC_TOPIC, "")]
    hub.publish_change("tasks", "a")
    hub.publish_change("runs", "b")
    events = popped(subscriber)
    assert about(events) == [("tasks", "a"), ("runs", "b")]
    assert events[0]["sequence"] < events[1]["sequence"]


def test_nobody_hears_who_signs_in() -> None:
    hub = EventHub()
    subscriber = subscribed(hub)
    popped(subscriber)
    for topic in ("sessions", "people", "access_tokens"):
        hub.publish_change(topic, "the hash of a secret")
    assert popped(subscriber) == []


def test_what_changes_twice_is_published_once_and_later() -> None:
    hub = EventHub()
    subscriber = subscribed(hub)
    popped(subscriber)
    for topic in ("jobs", "runs", "jobs"):
        hub.publish_change(topic, "x")
    assert about(popped(subscriber)) == [("runs", "x"), ("jobs", "x")]


def test_a_subscriber_that_falls_behind_reads_everything_anew_and_keeps_the_states() -> None:
    hub = EventHub(max_pending=10)
    subscriber = subscribed(hub)
    popped(subscriber)
    hub.publish_state("executor", "", {"progress": 0.5})
    for i in range(1000):
        hub.publish_change("demonstrations", str(i))
        assert subscriber.pending <= 12
    events = popped(subscriber)
    assert about(events) == [(RESYNC_TOPIC, ""), ("executor", "")]
    hub.publish_change("tasks", "after")
    assert about(popped(subscriber)) == [("tasks", "after")]


def test_a_state_is_published_to_later_subscribers_until_it_has_gone() -> None:
    hub = EventHub()
    hub.publish_state("trackers", "glove", {"announced": True})
    assert popped(subscribed(hub))[1]["now"] == {"announced": True}
    early = subscribed(hub)
    hub.publish_state("trackers", "glove", None)
    assert popped(early)[-1]["now"] is None
    assert about(popped(subscribed(hub))) == [(RESYNC_TOPIC, "")]


def test_subscribers_are_woken_and_those_that_have_left_are_not() -> None:
    hub, woken = EventHub(), []
    one, other = hub.subscribe(lambda: woken.append(1)), hub.subscribe(lambda: woken.append(2))
    hub.publish_change("tasks", "a")
    hub.unsubscribe(one)
    hub.publish_change("tasks", "b")
    assert woken.count(1) == 1
    assert woken.count(2) == 2
    assert other.pending


def test_many_threads_publish_and_no_sequence_number_comes_twice() -> None:
    hub = EventHub(max_pending=10_000)
    subscriber = subscribed(hub)
    popped(subscriber)
    threads = [
        threading.Thread(target=lambda t=t: [hub.publish_change(f"t{t}", str(i)) for i in range(200)])  # type: ignore[misc]
        for t in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    numbers = [event["sequence"] for event in popped(subscriber)]
    assert len(set(numbers)) == len(numbers) == 1600


def test_the_poller_publishes_differences_and_nothing_else() -> None:
    hub = EventHub()
    now: dict[str, Document] = {"glove": {"received": 1}}
    poller = StatePoller(hub, {"recordings": lambda: now})
    subscriber = subscribed(hub)
    popped(subscriber)
    poller.poll()
    poller.poll()
    assert [event["now"] for event in popped(subscriber)] == [{"received": 1}]
    now = {"hand": {"received": 5}}
    poller.poll()
    assert {event["id"]: event["now"] for event in popped(subscriber)} == {"glove": None, "hand": {"received": 5}}


def test_a_poll_that_fails_does_not_end_the_polling() -> None:
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


def test_an_event_is_encoded_once_for_all_subscribers() -> None:
    hub = EventHub()
    subscribers = [subscribed(hub), subscribed(hub)]
    for subscriber in subscribers:
        popped(subscriber)
    hub.publish_state("executor", "", {"progress": 0.5})
    one, other = (subscriber.pop() for subscriber in subscribers)
    assert one is not None
    assert other is not None
    assert json.loads(one.text) == one.document
    assert one.text is other.text
