"""An arm whose driver ends, or that stays silent, ends its execution as faulted, with the reason and the way out."""

from dataclasses import replace

import pytest

from teachpath.errors import Unreachable
from teachpath.executor.settings import ExecutorSettings
from teachpath.io.bus import Handle
from teachpath.io.documents import encode
from teachpath.io.memory_bus import MemoryBus
from teachpath.records import JointState, Plan
from tests.unit.executor.executors import KEYS, Bench, standing, within_limits

CUT = "the executor's own line to the bus is cut, and nothing is heard of the arm: look where the arm stands"
LOST_ARM_REASON = "the driver of puma560 has ended: look where the arm stands, then start again"


class LosableBench(Bench):
    """An executor with an arm whose driver announces itself."""

    def __init__(self, bus: MemoryBus | None = None) -> None:
        super().__init__(bus=bus)
        self.driver: Handle = self.bus.announce(KEYS.alive("robot", "puma560"))
        self.follows_way_to_rest = False

    def lose_driver(self) -> None:
        self.speaking = False
        self.driver.close()

    def joint_state(self) -> JointState:
        return replace(super().joint_state(), holding=self.follows_way_to_rest)


@pytest.fixture
def bench() -> LosableBench:
    return LosableBench()


@pytest.mark.parametrize("state", ["approaching", "following", "stopping", "held"])
def test_an_arm_whose_driver_ends_is_a_fault_in_every_state(bench: LosableBench, middle: Plan, state: str) -> None:
    times: list[int] = []

    def lose() -> None:
        times.append(bench.now)
        bench.lose_driver()

    bench.start(middle)
    if state in ("stopping", "held"):
        bench.when(lambda: len(bench.setpoints) > 50, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == state, lose)
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].reason == LOST_ARM_REASON
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)
    assert bench.now - times[0] < 1e9


def test_an_arm_whose_driver_ends_while_it_follows_a_way_to_rest_is_a_fault(bench: LosableBench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: setattr(bench, "follows_way_to_rest", True))
    bench.when(lambda: True, bench.lose_driver)
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].reason == LOST_ARM_REASON


class CuttableBus(MemoryBus):
    """A bus of which the executor can lose sight."""

    is_cut = False

    def is_joined(self) -> bool:
        return not self.is_cut


@pytest.mark.parametrize("delay", [0.0, 0.05])  # [s] from the loss of what was announced to that of the line
def test_an_executor_whose_line_to_the_bus_is_cut_does_not_say_that_the_driver_has_ended(
    middle: Plan, delay: float
) -> None:
    bus = CuttableBus()
    bench, times = LosableBench(bus), list[int]()

    def lose() -> None:
        times.append(bench.now)
        bench.lose_driver()

    bench.start(middle)
    bench.when(lambda: bench.state == "following", lose)
    bench.when(lambda: bench.now >= times[0] + 1e9 * delay, lambda: setattr(bus, "is_cut", True))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].reason == f"{CUT}, then start again"
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


def test_no_start_believes_the_last_joint_state_of_a_driver_that_has_ended(bench: LosableBench, middle: Plan) -> None:
    refused: list[str] = []

    def start_too_early() -> None:
        with pytest.raises(Unreachable, match="no joint state from puma560") as error:
            bench.command("start", "run-2", plan=encode(middle))
        refused.append(str(error.value))
        bench.speaking = True

    bench.start(middle)
    bench.when(lambda: len(bench.setpoints) > 50, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", bench.lose_driver)
    bench.when(lambda: bench.state == "faulted", start_too_early)
    bench.when(lambda: bool(refused), lambda: None)  # a joint state later
    bench.when(lambda: True, lambda: bench.command("start", "run-2", plan=encode(middle)))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].progress == 1.0


def test_a_driver_that_was_started_again_before_is_no_fault_of_a_later_execution(
    bench: LosableBench, middle: Plan
) -> None:
    bench.when(lambda: True, lambda: bench.driver.close())
    bench.start(middle)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.statuses[-1].progress == 1.0


def test_an_arm_that_stays_silent_is_held_and_after_a_time_a_fault(bench: LosableBench, middle: Plan) -> None:
    times: list[int] = []

    def fall_silent() -> None:
        times.append(bench.now)
        bench.speaking = False

    bench.start(middle)
    bench.when(lambda: bench.state == "following", fall_silent)
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.states()[-4:] == ["following", "stopping", "held", "faulted"]
    timeout = ExecutorSettings().silence_timeout
    reason = f"no joint state for {timeout:.1f} s: is the arm's driver running? look where the arm stands"
    assert bench.statuses[-1].reason == f"{reason}, then start again"
    assert (bench.now - times[0]) / 1e9 == pytest.approx(timeout, abs=0.1)
