"""What becomes of a message on the bus while its way out is full, because a peer hangs or reads too slowly."""

from __future__ import annotations

from enum import Enum
from typing import Final


class Delivery(Enum):
    """What becomes of a message while its way out is full.

    Every kind has a queue of its own at each line, because a sender that waits would keep all others of its queue
    waiting. One queue holds at least 64 KiB, and the operating system takes more.
    """

    WAITS = "waits"  # its sender waits; after 5 s Zenoh cuts the line
    DROPS = "drops"  # it is dropped after a millisecond at most; whoever hears the next one sees it by its number
    DROPS_LAST = "drops last"  # likewise, but its queue is not the one that streams fill


WAITS: Final = Delivery.WAITS
