import threading

from teachpath.live.event_hub import ALL, Document, EventHub, Subscriber
from teachpath.live.state_poller import StatePoller


def listen(news: EventHub) -> Subscriber:
    return news.attach(lambda: None)


def taken(listener: Subscriber) -> list[Document]:
    pieces = []
    while (piece := listener.take()) is not None:
        pieces.append(piece)
    return pieces


def about(pieces: list[Document]) -> list[tuple[str, str]]:
    return [(piece["topic"], piece["id"]) for piece in pieces]


def test_a_listener_reads_everything_first_and_then_hears_of_changes_in_their_order() -> None:
    news = EventHub()
    news.tell("tasks", "before")
    listener = listen(news)
    assert about(taken(listener)) == [(ALL, "")]
    news.tell("tasks", "a")
    news.tell("runs", "b")
    pieces = taken(listener)
    assert about(pieces) == [("tasks", "a"), ("runs", "b")]
    assert pieces[0]["sequence"] < pieces[1]["sequence"]


def test_what_changes_twice_is_told_once_and_later() -> None:
    news = EventHub()
    listener = listen(news)
    taken(listener)
    for topic in ("jobs", "runs", "jobs"):
        news.tell(topic, "x")
    assert about(taken(listener)) == [("runs", "x"), ("jobs", "x")]


def test_whoever_falls_behind_reads_everything_anew_and_keeps_how_things_stand() -> None:
    news = EventHub(longest=10)
    listener = listen(news)
    taken(listener)
    news.stand("executor", "", {"progress": 0.5})
    for i in range(1000):
        news.tell("demonstrations", str(i))
        assert listener.waiting <= 12
    pieces = taken(listener)
    assert about(pieces) == [(ALL, ""), ("executor", "")]
    news.tell("tasks", "after")
    assert about(taken(listener)) == [("tasks", "after")]


def test_what_stands_is_told_to_whoever_comes_later_until_it_is_gone() -> None:
    news = EventHub()
    news.stand("trackers", "glove", {"announced": True})
    assert taken(listen(news))[1]["now"] == {"announced": True}
    early = listen(news)
    news.stand("trackers", "glove", None)
    assert taken(early)[-1]["now"] is None
    assert about(taken(listen(news))) == [(ALL, "")]


def test_listeners_are_woken_and_those_that_have_left_are_not() -> None:
    news, woken = EventHub(), []
    one, other = news.attach(lambda: woken.append(1)), news.attach(lambda: woken.append(2))
    news.tell("tasks", "a")
    news.detach(one)
    news.tell("tasks", "b")
    assert woken.count(1) == 1
    assert woken.count(2) == 2
    assert other.waiting


def test_many_threads_tell_and_no_sequence_number_comes_twice() -> None:
    news = EventHub(longest=10_000)
    listener = listen(news)
    taken(listener)
    threads = [
        threading.Thread(target=lambda t=t: [news.tell(f"t{t}", str(i)) for i in range(200)])  # type: ignore[misc]
        for t in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    numbers = [piece["sequence"] for piece in taken(listener)]
    assert len(set(numbers)) == len(numbers) == 1600


def test_the_lookout_tells_what_is_different_and_nothing_else() -> None:
    news = EventHub()
    now: dict[str, Document] = {"glove": {"received": 1}}
    lookout = StatePoller(news, {"recordings": lambda: now})
    listener = listen(news)
    taken(listener)
    lookout.look()
    lookout.look()
    assert [piece["now"] for piece in taken(listener)] == [{"received": 1}]
    now = {"hand": {"received": 5}}
    lookout.look()
    assert {piece["id"]: piece["now"] for piece in taken(listener)} == {"glove": None, "hand": {"received": 5}}


def test_a_look_that_fails_does_not_end_the_lookout() -> None:
    news, looked = EventHub(), threading.Event()
    calls = []

    def look() -> dict[str, Document]:
        calls.append(1)
        if len(calls) == 1:
            raise OSError("the disk is away")
        looked.set()
        return {}

    lookout = StatePoller(news, {"station": look}, period=0.01)
    lookout.start()
    assert looked.wait(10)
    lookout.stop()
