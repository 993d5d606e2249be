"""What a station does beside moving the arm: it learns, and pages look on."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from teachpath_client import ClientError, Station

POLL = 0.1  # [s] at which the page asks


@contextmanager
def learner_and_page(url: str) -> Iterator[None]:
    """Learn without a pause, look at the view, and ask for tasks and executions ten times a second."""
    over = threading.Event()
    threads = [threading.Thread(target=work, args=(url, over)) for work in (_learn, _look, _ask)]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        over.set()
        for thread in threads:
            thread.join()


def _learn(url: str, over: threading.Event) -> None:
    with Station(url) as station:
        while not over.is_set():
            with suppress(ClientError):
                station.learn("demo")


def _look(url: str, over: threading.Event) -> None:
    with suppress(ConnectionClosed), connect(f"ws://{url.removeprefix('http://')}/api/v1/view") as page:
        while not over.is_set():
            with suppress(TimeoutError):
                page.recv(timeout=POLL)


def _ask(url: str, over: threading.Event) -> None:
    with Station(url) as station:
        while not over.wait(POLL):
            station.tasks()
            station.executions()
