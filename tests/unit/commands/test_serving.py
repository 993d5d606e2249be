"""The web port: what listens there."""

import gc
import socket
import sys

import pytest

from teachpath.commands.serving import listen, short_pauses
from teachpath.errors import Unreachable
from tests.ports import free_port


def test_answers_on_a_kept_connection_do_not_wait_for_acknowledgements() -> None:
    with listen("127.0.0.1", free_port()) as listener, socket.create_connection(listener.getsockname()):
        connection, _ = listener.accept()
        with connection:
            assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_a_port_that_is_taken_is_said() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(Unreachable, match="Choose another: --port"):
        listen("127.0.0.1", taken.getsockname()[1])


def test_the_collector_leaves_out_what_was_there_and_threads_take_turns_sooner_until_the_end() -> None:
    interval, there = sys.getswitchinterval(), [[number] for number in range(1000)]
    with short_pauses():
        assert gc.get_freeze_count() >= len(there)
        assert sys.getswitchinterval() < interval
    assert (gc.get_freeze_count(), sys.getswitchinterval()) == (0, interval)
