"""A stop over the bus: for whoever reaches a station's bus, and not its web service."""

from __future__ import annotations

import queue
import time
import uuid
from contextlib import suppress
from typing import Final

from teachpath_client.errors import ClientError, NotStopped
from teachpath_client.link import Link
from teachpath_proto.control import ExecutorState
from teachpath_proto.keys import Keys
from teachpath_proto.motion_pb2 import ExecutorCommand, ExecutorStatus

REPEAT_INTERVAL: Final = 0.05  # [s] between two repeats of a stop that is not confirmed
CONFIRM_TIMEOUT: Final = 2.0  # [s] after which it is said that the stop is not confirmed


def stop_over_bus(
    link: Link,
    execution: str = "",
    *,
    prefix: str = "teachpath/station",
    who: str = "",
    timeout: float = CONFIRM_TIMEOUT,
) -> ExecutorStatus:
    """Stop the arm on its path, and return the executor's own status that shows it; no lease is needed.

    The stop is put, which nobody can swallow, and asked, which no full line drops, until a status shows it that came
    since. An answer proves nothing: on an open bus anybody may give it.

    Args:
        link: with a login that hears `executor/status`: an operator's, a viewer's or a driver's.
        execution: that is to be stopped; empty: whatever moves.
        prefix: of the station's keys.
        who: your name, for the journal.
        timeout: [s] in which the executor must confirm it.

    Raises:
        NotStopped: no status shows it in time; the arm may be moving.
    """
    keys, statuses = Keys(prefix), queue.SimpleQueue[bytes]()
    subscriber = link.subscribe(keys.executor_status, statuses.put)
    stop = ExecutorCommand(verb=ExecutorCommand.VERB_STOP, execution=execution, id=uuid.uuid4().hex, who=who)
    order = stop.SerializeToString()
    end = time.monotonic() + timeout
    try:
        while time.monotonic() < end:
            link.put(keys.executor_stop, order)
            with suppress(ClientError):  # whoever answers is not believed
                link.ask(keys.executor_stop, order, timeout=REPEAT_INTERVAL)
            with suppress(queue.Empty):
                status = ExecutorStatus.FromString(statuses.get(timeout=REPEAT_INTERVAL))
                while not statuses.empty():
                    status = ExecutorStatus.FromString(statuses.get())
                if _shows(status, execution):
                    return status
    finally:
        subscriber.undeclare()
    raise NotStopped(
        f"NOT STOPPED: the executor has not confirmed the stop on the bus within {timeout:g} s, and the arm may be "
        "moving; press the emergency stop of the arm"
    )


def is_resting(status: ExecutorStatus) -> bool:
    """Tell whether nothing is under way; a state that this version does not know is no rest."""
    return status.state in [state.value for state in ExecutorState if state.is_resting]


def _shows(status: ExecutorStatus, execution: str) -> bool:
    """Tell whether what was to be stopped rests, or comes to its end."""
    return is_resting(status) or status.ending or execution not in ("", status.execution)
