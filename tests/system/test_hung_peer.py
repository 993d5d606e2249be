"""A program on the bus that stops to read: nobody who may not wait does, and what is dropped shows by its number."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

import pytest

from teachpath.errors import TeachpathError
from teachpath.io.bus import Bus, BusSettings, listen_on_bus
from teachpath.io.bus_delivery import Delivery
from tests.ports import free_port
from tests.system import listener
from tests.waiting import wait_until

pytestmark = pytest.mark.system

KEY = "hung/setpoints"
SIZE, FLOOD = 16 * 1024, 4096  # bytes of a message, and how many: more than two systems keep for a line


@contextmanager
def joined(endpoint: str) -> Iterator[int]:
    """Run a listener; yields its process id."""
    process = subprocess.Popen([sys.executable, str(Path(listener.__file__)), endpoint, KEY])
    try:
        yield process.pid
    finally:
        process.kill()
        process.wait()


def heard(bus: Bus) -> list[int]:
    """Return the numbers that the listener has heard, or none while it does not answer."""
    with suppress(TeachpathError):
        answer = bus.ask(f"{KEY}/heard")
        return [int.from_bytes(answer[i : i + 8], "little") for i in range(0, len(answer), 8)]
    return []


def is_stopped(pid: int) -> bool:
    return Path(f"/proc/{pid}/stat").read_text().rsplit(") ", 1)[1].startswith("T")


def test_who_never_waits_loses_numbers_and_not_the_line_to_a_program_that_hangs() -> None:
    endpoint, numbers, seen = f"tcp/127.0.0.1:{free_port()}", count(1), list[bool]()
    bus = listen_on_bus(BusSettings(endpoint=endpoint))

    def send(size: int = 8) -> int:
        number = next(numbers)
        bus.publish(KEY, number.to_bytes(8, "little").ljust(size), delivery=Delivery.DROPS)
        return number

    try:
        with joined(endpoint) as pid:
            bus.watch(f"{KEY}/alive", lambda _, alive: seen.append(alive))
            wait_until(lambda: send() and seen and heard(bus), "the listener hears")
            os.kill(pid, signal.SIGSTOP)
            wait_until(lambda: is_stopped(pid), "it is stopped")
            before = send()
            for _ in range(FLOOD):
                send(SIZE)
            after = send()
            os.kill(pid, signal.SIGCONT)
            newest = wait_until(lambda: send() and [n for n in heard(bus) if n > after], "it hears again")
            told = [n for n in heard(bus) if before < n <= newest[-1]]
            assert told == sorted(set(told))
            kept = [n for n in told if n < after]
            assert 0 < len(kept) < FLOOD  # what the line holds is heard, and the gaps in the numbers count the others
            assert seen == [True]  # a sender that waits has the line cut after 5 s
    finally:
        bus.close()
