import signal
from collections.abc import Iterator
from types import FrameType

import pytest

from tests.waiting import HANG


@pytest.fixture(autouse=True)
def deadline() -> Iterator[None]:
    """Fail a test that waits for a reading which never comes."""

    def fail(_number: int, _frame: FrameType | None) -> None:
        raise AssertionError(f"still waiting after {HANG:g} s")

    before = signal.signal(signal.SIGALRM, fail)
    signal.setitimer(signal.ITIMER_REAL, HANG)
    yield
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    signal.signal(signal.SIGALRM, before)
