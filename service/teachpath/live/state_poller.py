"""The lookout: looks at what changes without saying so, and tells what is different."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping

from teachpath.live.event_hub import Document, EventHub

POLL_INTERVAL = 0.2  # [s] a person sees no delay, and a moving arm no more than five documents a second

# How all things of one topic stand now, by id.
Poll = Callable[[], Mapping[str, Document]]

log = logging.getLogger("teachpath")


class StatePoller:
    """Looks again and again, on a thread of its own; start it and stop it.

    Args:
        looks: for every topic, what gives its documents.
    """

    def __init__(self, hub: EventHub, polls: Mapping[str, Poll], *, interval: float = POLL_INTERVAL) -> None:
        self._hub, self._polls, self._interval = hub, dict(polls), interval
        self._last: dict[str, dict[str, Document]] = {topic: {} for topic in polls}
        self._stopped = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Look from now on."""
        self._thread = threading.Thread(target=self._run, name="lookout", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Look no more; a second call does nothing."""
        self._stopped.set()
        if self._thread is not None:
            self._thread.join()
            self._thread = None

    def poll(self) -> None:
        """Look once, and tell what is different from the last time."""
        for topic, poll in self._polls.items():
            now, before = dict(poll()), self._last[topic]
            self._last[topic] = now
            for key in [*now, *(k for k in before if k not in now)]:
                if now.get(key) != before.get(key):
                    self._hub.publish_state(topic, key, now.get(key))

    def _run(self) -> None:
        while not self._stopped.wait(self._interval):
            try:
                self.poll()
            except Exception:  # whatever cannot be looked at now must not blind the page to the rest
                log.exception("the page is not told how the station stands")
