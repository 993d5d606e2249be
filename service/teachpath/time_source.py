"""What time it is and how to wait: by the machine's clocks, or by those of a test."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class TimeSource:
    """The clocks of one running part; a test passes its own, so that it never waits.

    Attributes:
        monotonic_ns: returns nanoseconds of a clock that is never set back.
        wall_ns: returns nanoseconds since the Unix epoch.
        sleep: waits for a number of seconds.
        wait: waits until an event is set, but no longer than a number of seconds.
    """

    monotonic_ns: Callable[[], int] = time.monotonic_ns
    wall_ns: Callable[[], int] = time.time_ns
    sleep: Callable[[float], object] = time.sleep
    wait: Callable[[threading.Event, float], object] = threading.Event.wait
