"""A signal ends a command, whichever thread the system gives it to."""

import os
import signal
import threading

import pytest

from teachpath.commands.serving import until_signalled
from tests.waiting import HANG


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_is_heard_whichever_thread_it_is_given_to(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    for to_another in (False, True):
        with until_signalled() as stop:
            asleep = threading.Event()
            other = threading.Thread(target=asleep.wait)
            other.start()
            assert other.ident is not None
            if to_another:
                # The main thread sleeps when it comes, and nothing of Python's runs in it until the event is set.
                threading.Timer(0.2, signal.pthread_kill, (other.ident, number)).start()
            else:
                os.kill(os.getpid(), number)
            assert stop.wait(timeout=HANG)
            asleep.set()
            other.join()
        assert signal.getsignal(number) is before


def test_without_a_signal_nothing_is_heard() -> None:
    with until_signalled() as stop:
        assert not stop.is_set()
    assert not stop.is_set()
