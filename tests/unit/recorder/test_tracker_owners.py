"""A tracker's name belongs to the session that sent first, until it is silent."""

import pytest

from teachpath.errors import Conflict
from teachpath.io.memory_bus import MemoryBus
from teachpath.recorder.tracker_owners import REPORT_TIME, SILENCE_TIMEOUT, TrackerOwners
from teachpath_proto.keys import Keys

KEYS = Keys()


def test_a_name_belongs_to_the_session_that_sent_first_until_it_is_silent() -> None:
    bus, now = MemoryBus(), [0.0]
    owners = TrackerOwners(KEYS, lambda: now[0])
    bus.subscribe_with_source(KEYS.all_samples, owners.on_sample)

    def send(source: str, tracker: str = "glove") -> None:
        bus.publish(KEYS.samples(tracker), b"", source=source)

    assert owners.owner("glove") == ""
    send("first")
    send("second")
    send("second", "other")
    assert (owners.owner("glove"), owners.owner("other")) == ("first", "second")
    assert len(owners.faults()) == 1
    assert "as glove" in owners.faults()[0]
    for _ in range(4):  # it stays the first one's while that one sends
        now[0] += SILENCE_TIMEOUT / 2
        send("first")
        send("second")
    assert owners.owner("glove") == "first"
    now[0] += SILENCE_TIMEOUT + 0.1
    assert owners.owner("glove") == ""
    send("second")
    assert owners.owner("glove") == "second"
    now[0] += REPORT_TIME
    assert owners.faults() == []


def test_samples_that_name_no_session_own_no_name_and_lead_no_arm() -> None:
    bus, now = MemoryBus(), [0.0]
    owners = TrackerOwners(KEYS, lambda: now[0])
    bus.subscribe_with_source(KEYS.all_samples, owners.on_sample)
    owners.require_named("glove")  # which may begin to send
    bus.publish(KEYS.samples("glove"), b"", source="")
    with pytest.raises(Conflict, match=r"samples as glove name no session .* attach the session's id"):
        owners.require_named("glove")
    bus.publish(KEYS.samples("glove"), b"", source="first")
    owners.require_named("glove")
    assert owners.owner("glove") == "first"
