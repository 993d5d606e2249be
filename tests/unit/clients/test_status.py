"""What the operator sees: one line that changes on a terminal, lines elsewhere, each take once."""

import io

import pytest

from teachpath_client.reading import HandReading
from teachpath_client.status import CLEAR_LINE, SILENCE_WARNING, Status
from teachpath_proto import tracker_pb2


def feedback(state: str, phase: str = "reach", newest: int = 0, **said: object) -> bytes:
    told = tracker_pb2.HandFeedback(task="lift", state=state, phase=phase, takes=newest, **said)  # type: ignore[arg-type]
    if newest:
        told.newest.CopyFrom(
            tracker_pb2.DemonstrationReport(
                demonstration=f"demo-{newest}",
                number=newest,
                verdict="repaired" if newest == 2 else "clean",
                reasons=["1 sample lost"] if newest == 2 else [],
            )
        )
    return told.SerializeToString()


def shown(payloads: list[bytes], *, live: bool) -> str:
    out = io.StringIO()
    status = Status(out, live=live)
    for payload in payloads:
        status.on_feedback(payload)
    status.end()
    return out.getvalue()


def test_each_change_is_a_line_where_there_is_no_terminal() -> None:
    payloads = [
        feedback("paused"),
        feedback("countdown", countdown_left=3.0, takes_left=2),
        feedback("countdown", countdown_left=2.0, takes_left=2),
        feedback("recording", "transport", takes_left=2),
        feedback("recording", "transport", takes_left=2),
        feedback("recording", newest=1, takes_left=1),
        feedback("recording", newest=2),
        feedback("", newest=2),
    ]
    assert shown(payloads, live=False).splitlines() == [
        "lift: paused: pedal, fist or `resume` to go on; 0 takes",
        "lift: begins in 3 s; 0 takes, 2 to go",
        "lift: begins in 2 s; 0 takes, 2 to go",
        "lift: recording: transport; 0 takes, 2 to go",
        "  + take 1 clean",
        "lift: recording; 1 take, 1 to go",
        "  ~ take 2 repaired: 1 sample lost",
        "lift: recording; 2 takes",
        "lift: ended; 2 takes",
    ]


def test_on_a_terminal_the_line_is_written_over_and_a_countdown_sounds() -> None:
    text = shown(
        [feedback("countdown", countdown_left=1.0), feedback("recording"), feedback("recording", newest=1)], live=True
    )
    assert text.split(CLEAR_LINE) == [
        "",
        "lift: begins in 1 s; 0 takes\a",
        "lift: recording; 0 takes",
        "  + take 1 clean\n",
        "lift: recording; 1 take\n",
    ]


@pytest.mark.parametrize("sign", ["toggle", "discard"])
def test_what_a_fist_offers_is_shown(sign: str) -> None:
    assert f"open the fist now to {sign}" in shown([feedback("recording", pending_command=sign)], live=False)


def test_a_station_that_says_nothing_is_said_once_until_it_speaks_again() -> None:
    out, now = io.StringIO(), [0.0]
    status = Status(out, live=False, clock=lambda: now[0])
    stream = status.readings(iter([HandReading(i * 0.5, (0.0, 0.0, 0.0)) for i in range(30)]))
    for _ in range(12):
        now[0] += 0.5
        if now[0] <= 2.0:
            status.on_feedback(feedback("recording"))
        next(stream)
    assert out.getvalue().splitlines() == ["lift: recording; 0 takes", SILENCE_WARNING]
    status.on_feedback(feedback("recording"))
    next(stream)
    assert out.getvalue().splitlines()[2:] == ["lift: recording; 0 takes"]


def test_a_station_that_speaks_each_second_is_not_missed() -> None:
    out, now = io.StringIO(), [100.0]
    status = Status(out, live=True, clock=lambda: now[0])
    for _ in status.readings(iter([HandReading(0.0, (0.0, 0.0, 0.0))] * 60)):
        now[0] += 1.0
        status.on_feedback(feedback("recording"))
    assert SILENCE_WARNING not in out.getvalue()
