"""What version 1 of the WebSockets promises to programs, and what would break it.

`python -m tests.contract.live_promise` writes live_v1.json, for a release; it refuses while a promise is broken.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from teachpath.api.live_description import live_description
from tests.contract.rest_promise import without_texts
from tests.contract.rest_values import Values

PROMISE = Path(__file__).with_name("live_v1.json")


def broken(promised: dict[str, Any], present: dict[str, Any]) -> Iterator[str]:
    """Yield why a program that was written for promised WebSockets may fail at the present ones.

    New channels, messages, topics, and fields that the station sends or that may be left out break nothing.
    """
    taken = Values(wide=present, narrow=promised, are_answers=False)
    given = Values(wide=promised, narrow=present, are_answers=True)
    for name, before in promised["channels"].items():
        now = present["channels"].get(name)
        if now is None:
            yield f"channel {name} is gone"
        elif now["address"] != before["address"]:
            yield f"channel {name} was at {before['address']} and is at {now['address']}"
    for name, before in promised["operations"].items():
        now = present["operations"].get(name)
        if now is None or now["action"] != before["action"] or now["channel"] != before["channel"]:
            yield f"operation {name} is gone"
            continue
        sent = before["action"] == "send"  # by the station
        for message in (each["$ref"] for each in before["messages"]):
            old, new = payload(promised, message), payload(present, message)
            if new is None or {"$ref": message} not in now["messages"]:
                yield f"{name}: {message.rsplit('/', 1)[1]} is gone"
            elif sent:
                yield from given.faults(message, old, new)
            else:
                yield from taken.faults(message, new, old)


def payload(description: dict[str, Any], reference: str) -> Any:
    """Return the schema of a message, `#/channels/CHANNEL/messages/NAME`; None: it is gone."""
    _, _, channel, _, name = reference.split("/")
    return description["channels"].get(channel, {"messages": {}})["messages"].get(name, {}).get("payload")


def main() -> None:
    """Write the description that the next changes have to keep."""
    present = without_texts(live_description())
    if PROMISE.exists() and (faults := list(broken(json.loads(PROMISE.read_text()), present))):
        sys.exit("\n".join(["version 1 promises otherwise; take it back, or serve it under /api/v2:", *faults]))
    del present["components"]["schemas"]["ChangeEvent"]["properties"]["topic"]["enum"]  # topics may come
    PROMISE.write_text(json.dumps(present, separators=(",", ":")).replace('},"', '},\n"') + "\n")


if __name__ == "__main__":
    main()
