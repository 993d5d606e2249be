"""Stops that are put: obeyed in every state, shown by the status at once, and written down once."""

import threading
from itertools import pairwise

import pytest

from teachpath.io import wire
from teachpath.records import Command, Plan
from teachpath_proto.control import CommandVerb
from tests.unit.executor.executors import KEYS, PERIOD_NS, Bench, standing, within_limits


@pytest.fixture
def bench() -> Bench:
    return Bench()


def put(bench: Bench, execution: str = "run-1", who: str = "", id: str = "") -> None:
    command = Command(CommandVerb.STOP, execution, who=who, id=id)
    bench.bus.publish(KEYS.executor_stop, wire.encode_command(command))


def on_its_way(bench: Bench) -> bool:
    return bench.state == "following" and bench.statuses[-1].progress > 0.3


@pytest.mark.parametrize("state", ["approaching", "following", "stopping", "held"])
@pytest.mark.parametrize("execution", ["run-1", ""])
def test_a_stop_that_is_put_ends_an_execution_in_every_state(
    bench: Bench, middle: Plan, state: str, execution: str
) -> None:
    bench.start(middle)
    if state in ("stopping", "held"):
        bench.when(lambda: on_its_way(bench), lambda: bench.command("hold"))
    bench.when(lambda: bench.state == state, lambda: put(bench, execution))
    bench.when(lambda: bench.statuses[-1].ending, lambda: None)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].reason == "stopped by the operator"
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


def test_the_status_shows_a_stop_in_the_next_period_also_while_the_arm_comes_to_rest(
    bench: Bench, middle: Plan
) -> None:
    counts: list[int] = []
    times: list[int] = []

    def stop() -> None:
        counts.append(len(bench.statuses))
        times.append(bench.now)
        put(bench)

    def shown() -> bool:
        times.append(bench.now)
        return True

    bench.start(middle)
    bench.when(lambda: on_its_way(bench), lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "stopping", stop)
    bench.when(lambda: bench.statuses[-1].ending, shown)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    first = bench.statuses[counts[0]]
    assert (first.state, first.ending) == ("stopping", True)
    assert times[-1] - times[0] <= 2 * PERIOD_NS
    assert not any(status.ending for status in bench.statuses[: counts[0]])


def test_a_stop_where_nothing_moves_is_answered_by_a_status_at_once(bench: Bench) -> None:
    counts: list[int] = []

    def stop() -> None:
        counts.append(len(bench.statuses))
        put(bench, "")

    bench.when(lambda: bench.now > PERIOD_NS, stop)
    bench.when(lambda: len(bench.statuses) > counts[0], bench.stop.set)
    bench.run()
    assert bench.statuses[-1].state == "idle"
    assert bench.now < 0.1e9  # an idle executor publishes its status every 0.25 s


def test_the_repeats_of_a_stop_stand_in_the_journal_once(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: on_its_way(bench), lambda: None)
    for _ in range(20):
        bench.when(lambda: True, lambda: put(bench, "run-1", "Ada", "stop-1"))
    bench.when(lambda: True, lambda: put(bench, "run-1", "Bea", "stop-2"))
    bench.when(lambda: True, lambda: put(bench, "run-1", "Cyd"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert [entry.who for entry in bench.journal if entry.verb == "stop"] == ["Ada", "Bea", "Cyd"]
    assert bench.statuses[-1].reason == "stopped by Ada"


def test_a_flood_of_stops_of_nothing_delays_no_setpoint(bench: Bench, middle: Plan) -> None:
    def flood() -> None:
        for number in range(5000):
            put(bench, "nothing", id=f"stop-{number}")

    bench.start(middle)
    bench.when(lambda: bench.state == "following", flood)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].progress == pytest.approx(1.0)
    assert (bench.statuses[-1].late, bench.statuses[-1].missed) == (0, 0)


@pytest.mark.parametrize("payload", [b"\xff\xff", wire.encode_command(Command(CommandVerb.HOLD, "run-1"))])
def test_what_is_no_stop_is_not_obeyed_and_harms_nothing(bench: Bench, middle: Plan, payload: bytes) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: bench.bus.publish(KEYS.executor_stop, payload))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].progress == pytest.approx(1.0)


class WakefulBench(Bench):
    """An executor that may be woken at every millisecond of its rest."""

    def doze(self, woken: threading.Event, duration: float) -> None:
        end = self.now + round(1e9 * duration)
        while self.now < end and not woken.is_set():
            self.sleep(1e-3)


def test_at_rest_a_stop_is_shown_in_the_next_period_and_many_of_them_hurry_nobody() -> None:
    bench, waited, looks = WakefulBench(), list[int](), list[int]()
    bench.bus.subscribe(KEYS.executor_status, lambda _, __: looks.append(bench.now))

    def stop() -> None:
        count, begun = len(looks), bench.now
        put(bench, id=f"stop at {begun}")
        bench.todo.insert(0, (lambda: len(looks) > count, lambda: waited.append(looks[-1] - begun)))

    for moment in range(900, 1023, 3):  # [ms] at every millisecond of an idle cycle
        bench.when(lambda moment=moment: bench.now >= 1e6 * moment, stop)
    flood = 1_050_000_000
    for _ in range(100):  # one each millisecond
        bench.when(lambda: bench.now >= flood, lambda: put(bench))
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert len(waited) == 41
    assert max(waited) <= PERIOD_NS
    shown = [now for now in looks if now >= flood]
    assert len(shown) > 20
    assert all(later - sooner >= PERIOD_NS for sooner, later in pairwise(shown))
