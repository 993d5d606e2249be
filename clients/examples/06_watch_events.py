"""Watch a station: print what changes, and how jobs and executions stand, without asking in a loop.

The events of a station (`Station.events`, the WebSocket /api/v1/events, described at /asyncapi.json) say that something
has changed, or carry a state. An event of topic `all` comes first, and after a gap: everything is to be read
anew. Of each thing only the newest event waits, so a slow reader misses no last word.

    python 06_watch_events.py [--url http://127.0.0.1:8765] [--until-job]
"""

import argparse
import sys

from teachpath_client import ClientError, Station
from teachpath_client.events import Event

FINAL_STATES = ("succeeded", "failed", "cancelled")


def line(station: Station, event: Event) -> str:
    """Return what an event says, in a line."""
    if event.topic == "all":
        return f"read everything anew: {len(station.tasks())} tasks ({event.reason})"
    if event.status and event.topic == "jobs":
        what = "job {id} ({kind} of {task}): {state} {fraction:.0%} {message}"
        return what.format(id=event.id, **event.status).rstrip()
    if event.status:
        return "execution {id}: {state} {reason}".format(id=event.id, **event.status).rstrip()
    return f"{event.topic} {event.id}".rstrip()


def main() -> None:
    """Print a line for each event, until Ctrl-C, or until a job has ended."""
    parser = argparse.ArgumentParser(description="Print what changes at a station.")
    parser.add_argument("--url", default="http://127.0.0.1:8765")
    parser.add_argument("--until-job", action="store_true", help="end when a job has ended")
    options = parser.parse_args()
    try:
        with Station(options.url) as station, station.events() as events:
            for event in events:
                print(line(station, event), flush=True)
                if options.until_job and event.topic == "jobs" and (event.status or {}).get("state") in FINAL_STATES:
                    return
    except KeyboardInterrupt:
        return
    except ClientError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
