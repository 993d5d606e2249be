"""The state poller: reads at intervals what changes without saying so, and publishes the differences."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from teachpath.live.event_hub import Document, EventHub
from teachpath.periodic_thread import PeriodicThread

POLL_INTERVAL = 0.2  # [s] a person sees no delay, and a moving arm causes at most five documents a second

# Returns the states of one topic, by id.
Poll = Callable[[], Mapping[str, Document]]


class StatePoller:
    """Polls on a thread of its own; start it and stop it.

    Args:
        polls: by topic, the function that returns the states of that topic.
        interval: [s] between two polls.
    """

    def __init__(self, hub: EventHub, polls: Mapping[str, Poll], *, interval: float = POLL_INTERVAL) -> None:
        self._hub = hub
        self._polls = dict(polls)
        self._last: dict[str, dict[str, Document]] = {topic: {} for topic in polls}
        self._thread = PeriodicThread("state poller", interval, self.poll)

    def start(self) -> None:
        """Poll from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Stop polling; a second call does nothing."""
        self._thread.stop()

    def poll(self) -> None:
        """Poll once, and publish every state that differs from the one before; None stands for one that has gone."""
        for topic, poll in self._polls.items():
            now, before = dict(poll()), self._last[topic]
            self._last[topic] = now
            for key in [*now, *(k for k in before if k not in now)]:
                if now.get(key) != before.get(key):
                    self._hub.publish_state(topic, key, now.get(key))
