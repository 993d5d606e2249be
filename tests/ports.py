"""TCP ports for servers of tests, which nobody else takes between the moment they are chosen and that of their use.

The system gives ports of its ephemeral range to whoever connects, or listens at port 0: one that was free a moment ago
may be taken by a test beside this one before its server listens. So tests choose below that range, each process of a
run among ports of its own, and none twice.
"""

import itertools
import os
import random
import socket
from contextlib import suppress

FIRST_PORT, COUNT = 12_000, 4_000  # of one process of a run; the system's own begin at 32768
PROCESSES = 5
_numbers = itertools.count(random.SystemRandom().randrange(COUNT))  # other runs on this machine begin elsewhere


def free_port() -> int:
    """Return a TCP port of loopback that nobody listens on now, and that no test chooses again."""
    process = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) % PROCESSES
    for number in itertools.islice(_numbers, COUNT):
        port = FIRST_PORT + process * COUNT + number % COUNT
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise AssertionError(f"somebody listens on all of {COUNT} ports")


def free_ports(count: int) -> list[int]:
    """Return such ports, all different."""
    return [free_port() for _ in range(count)]


def free_endpoint() -> str:
    """Return such a port as the endpoint of a bus."""
    return f"tcp/127.0.0.1:{free_port()}"
