"""The error that is quoted of a process that died."""

import pytest

from teachpath.robot.last_error import LastError

TRACEBACK = ["Traceback (most recent call last):", '  File "a.py", line 1, in <module>', "    fail()"]


@pytest.mark.parametrize(
    ("lines", "error"),
    [
        ([], ""),
        (["INFO teachpath: real-time scheduling", "WARNING a.b: left out", "  "], ""),
        (["ERROR a.b: no such arm", "INFO a.b: ends"], "ERROR a.b: no such arm"),
        ([*TRACEBACK, "ValueError: two", "lines", "INFO a.b: ends"], "ValueError: two"),
        (["CRITICAL a.b: first", *TRACEBACK, "OSError: second"], "OSError: second"),
        ([*TRACEBACK, "KeyError: 1", "", "During handling of it:", "", *TRACEBACK, "TypeError: 2"], "TypeError: 2"),
        (["INFO a.b: begins", "teachpath: the bus cannot be reached"], "teachpath: the bus cannot be reached"),
        (["terminate called after std::bad_alloc", "ERROR a.b: x", "said later"], "ERROR a.b: x"),
        (["10:00:00Z ERROR zenoh: closed", "10:00:00Z  WARN zenoh: slow"], "10:00:00Z ERROR zenoh: closed"),
    ],
)  # fmt: skip
def test_the_error_is_found_and_no_line_of_a_lower_level(lines: list[str], error: str) -> None:
    found = LastError()
    for line in lines:
        found.add(line + "\n")
    assert found.text == error
