from collections.abc import Callable

import pytest

from teachpath.realtime import NICE, request_realtime


def refuse(_: int) -> None:
    raise PermissionError(1, "Operation not permitted")


def grant(_: int) -> None:
    return None


def test_what_is_granted_is_said() -> None:
    asked: list[int] = []
    assert request_realtime(40, fifo=asked.append, nice=refuse) == "real-time scheduling SCHED_FIFO 40"
    assert asked == [40]


@pytest.mark.parametrize(("nice", "words"), [(grant, f"but nice {NICE}"), (refuse, "shares the processor")])
def test_a_refusal_falls_back_to_nice_and_says_how_to_allow_it(nice: Callable[[int], None], words: str) -> None:
    said = request_realtime(40, fifo=refuse, nice=nice)
    assert said.startswith("no real-time scheduling ([Errno 1] Operation not permitted)")
    assert words in said
    assert "rtprio 40` in /etc/security/limits.conf" in said
    assert "LimitRTPRIO=40" in said
    assert "\n" not in said


def test_a_system_without_either_is_no_error() -> None:
    def missing(_: int) -> None:
        raise AttributeError("sched_setscheduler")

    assert "no real-time scheduling" in request_realtime(40, fifo=missing, nice=missing)
