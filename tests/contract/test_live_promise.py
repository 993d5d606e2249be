"""A program that was written for this version's WebSockets goes on: what it sends is taken, what it hears is there."""

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest

from teachpath.api.live_description import live_description
from tests.contract.live_promise import PROMISE, broken
from tests.contract.rest_promise import without_texts

PROMISED_DESCRIPTION: dict[str, Any] = json.loads(PROMISE.read_text())
Description = dict[str, Any]


def test_the_websockets_keep_what_this_version_promised() -> None:
    assert list(broken(PROMISED_DESCRIPTION, without_texts(live_description()))) == []


def fields(description: Description, model: str) -> dict[str, Any]:
    found: dict[str, Any] = description["components"]["schemas"][model]["properties"]
    return found


def remove_channel(d: Description) -> None:
    del d["channels"]["joints"]


def move_channel(d: Description) -> None:
    d["channels"]["events"]["address"] = "/api/v1/news"


def turn_round(d: Description) -> None:
    d["operations"]["sendSamples"]["action"] = "send"


def remove_message(d: Description) -> None:
    del d["channels"]["samples"]["messages"]["ping"]


def send_no_more(d: Description) -> None:
    d["operations"]["answerSamples"]["messages"].pop()


def say_less(d: Description) -> None:
    del fields(d, "ChangeEvent")["id"]
    d["components"]["schemas"]["ChangeEvent"]["required"].remove("id")


def say_otherwise(d: Description) -> None:
    fields(d, "ResyncEvent")["sequence"]["type"] = "string"


def need_a_field(d: Description) -> None:
    d["components"]["schemas"]["EndMessage"]["required"].append("reason")
    fields(d, "EndMessage")["reason"] = {"type": "string"}


def drop_a_field(d: Description) -> None:
    del fields(d, "SampleFields")["flexions"]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (remove_channel, "channel joints is gone"),
        (move_channel, "channel events was at /api/v1/events and is at /api/v1/news"),
        (turn_round, "operation sendSamples is gone"),
        (remove_message, "sendSamples: ping is gone"),
        (send_no_more, "answerSamples: refused is gone"),
        (say_less, ".id is gone"),
        (say_otherwise, ".sequence may be string, where it is integer"),
        (need_a_field, ".reason may be left out, where it must be there"),
        (drop_a_field, ".flexions is not known any more"),
    ],
)
def test_what_breaks_a_promise_is_found(change: Callable[[Description], None], sentence: str) -> None:
    changed = copy.deepcopy(PROMISED_DESCRIPTION)
    change(changed)
    faults = list(broken(PROMISED_DESCRIPTION, changed))
    assert any(sentence in fault for fault in faults), faults


def test_what_is_added_breaks_nothing() -> None:
    changed = copy.deepcopy(PROMISED_DESCRIPTION)
    moon = {"name": "moon", "payload": {"type": "object", "properties": {}}}
    changed["channels"]["moon"] = {"address": "/api/v1/moon", "messages": {"moon": moon}}
    changed["channels"]["events"]["messages"]["moonState"] = moon
    reference = {"$ref": "#/channels/events/messages/moonState"}
    changed["operations"]["watchEvents"]["messages"].append(reference)
    fields(changed, "ResyncEvent")["moon"] = {"type": "string"}
    fields(changed, "EndMessage")["moon"] = {"type": "string", "default": ""}
    assert list(broken(PROMISED_DESCRIPTION, changed)) == []
