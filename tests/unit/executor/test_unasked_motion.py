"""An arm that moves although nothing is under way: noticed, written down, and held until somebody has seen why."""

from collections.abc import Callable

import numpy as np
import pytest

from teachpath.errors import Conflict, Unanswered
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.unasked_motion import REST_TIME, SETTLING_TIME
from teachpath.io.documents import encode
from teachpath.io.wire import encode_state
from teachpath.records import Plan
from tests.unit.executor.executors import HOME, KEYS, Bench

THRESHOLD = ExecutorSettings().unasked_motion


class Pushed(Bench):
    """A bench whose arm moves by what is added to `foreign`, whoever does it."""

    def __init__(self, plan: Plan) -> None:
        super().__init__()
        self.plan = encode(plan)
        self.foreign = np.zeros(6)
        self.refusals: list[str] = []

    def sleep(self, duration: float) -> None:
        if self.setpoints:
            self.pushed = self.foreign
        else:
            self.position = HOME + self.foreign
        super().sleep(duration)

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        begin: list[int] = []
        self.when(lambda: True, lambda: begin.append(self.now))
        self.when(lambda: self.now - begin[0] > seconds * 1e9, lambda: None)

    def push(self, joint: int, angle: float) -> None:
        """Move a joint, a tenth of the angle at a time."""
        for _ in range(10):
            self.when(lambda: True, lambda: self.foreign.__setitem__(joint, self.foreign[joint] + angle / 10))

    def attempt(self, what: Callable[[], object]) -> None:
        """Do what has to be refused."""

        def refused() -> None:
            with pytest.raises(Conflict) as refusal:
                what()
            self.refusals.append(str(refusal.value))

        self.when(lambda: True, refused)

    def jump(self, angle: float) -> None:
        """Move a joint at once, and say so."""
        self.foreign[1] += angle
        self.position = HOME + self.foreign
        self.bus.publish(KEYS.state("puma560"), encode_state(self.joint_state()))

    def acknowledge(self) -> None:
        self.command("acknowledge")

    def start_now(self) -> None:
        self.command("start", plan=self.plan)

    @property
    def unasked(self) -> list[str]:
        return [entry.answer for entry in self.journal if entry.verb == "unasked motion"]


def test_an_arm_that_moves_unasked_is_noticed_and_nothing_starts_before_it_rests_and_somebody_acknowledges_it(
    middle: Plan,
) -> None:
    bench = Pushed(middle)
    bench.wait(SETTLING_TIME + 0.1)
    bench.push(2, 5 * THRESHOLD)
    bench.when(lambda: bench.statuses[-1].unasked_motion != "", lambda: None)
    bench.attempt(bench.start_now)
    bench.wait(REST_TIME / 2)
    bench.push(2, -THRESHOLD)  # it moves again: the rest begins anew
    bench.wait(REST_TIME * 0.9)
    bench.attempt(bench.acknowledge)
    bench.wait(REST_TIME)
    bench.attempt(bench.start_now)  # it rests, and nobody has seen why
    bench.when(lambda: True, bench.acknowledge)
    bench.when(lambda: bench.statuses[-1].unasked_motion == "", bench.start_now)
    bench.when(lambda: bench.state == "approaching", lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    moving, too_early, resting = bench.refusals
    assert moving == resting.replace(f"{4 * THRESHOLD:.2f}", f"{5 * THRESHOLD:.2f}")
    assert "although no execution is under way" in resting
    assert "acknowledge" in resting
    assert "has not rested" in too_early
    noticed, rested = bench.unasked
    assert f"{5 * THRESHOLD:.3f}" in rested
    assert "rests again" in rested
    assert "nothing starts" in noticed
    assert next(entry.execution for entry in bench.journal if entry.answer == noticed) == ""


@pytest.mark.parametrize("rest", [SETTLING_TIME + 0.1, 0.1])  # noticed by where it rested, or by where it was to start
def test_an_arm_that_moves_while_its_motion_is_made_ready_is_not_started(middle: Plan, rest: float) -> None:
    bench = Pushed(middle)

    def reset(_: bytes) -> bytes:
        bench.jump(2 * THRESHOLD)
        return b""

    bench.bus.serve(KEYS.reset("puma560"), reset)  # asked when the motion is ready, before it begins
    bench.wait(rest)
    bench.attempt(bench.start_now)
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert f"moved by {2 * THRESHOLD:.2f} rad while its motion was made ready" in bench.refusals[0]
    assert bench.setpoints == []


@pytest.mark.parametrize("rest", [SETTLING_TIME + 0.1, 0.1])
def test_an_arm_that_moves_before_the_first_setpoint_is_sent_none(middle: Plan, rest: float) -> None:
    bench = Pushed(middle)
    bench.wait(rest)
    bench.when(lambda: True, lambda: (bench.start_now(), bench.jump(2 * THRESHOLD)))
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.setpoints == []
    assert f"the arm moved by {2 * THRESHOLD:.2f} rad" in bench.statuses[-1].reason


def test_only_who_is_in_control_acknowledges_it_and_nothing_else_clears_it(middle: Plan) -> None:
    bench = Pushed(middle)
    bench.wait(SETTLING_TIME + 0.1)
    bench.push(2, 5 * THRESHOLD)
    bench.wait(REST_TIME + 0.5)
    token: list[str] = []
    bench.when(lambda: True, lambda: token.append(bench.control("acquire", name="Ada", seconds=60.0).token))
    bench.attempt(bench.acknowledge)
    bench.when(lambda: True, lambda: setattr(bench, "speaking", False))
    bench.wait(1.0)
    bench.attempt(lambda: bench.command("acknowledge", lease=token[0]))  # nobody knows whether it rests
    bench.when(lambda: True, lambda: setattr(bench, "speaking", True))
    bench.wait(SETTLING_TIME + 0.5)
    bench.attempt(lambda: bench.command("start", plan=bench.plan, lease=token[0]))
    bench.when(lambda: True, lambda: bench.command("acknowledge", lease=token[0]))
    bench.when(lambda: bench.statuses[-1].unasked_motion == "", bench.stop.set)
    bench.run()
    others, silent, unseen = bench.refusals
    assert "Ada" in others
    assert "has not rested" in silent
    assert "although no execution is under way" in unseen


def test_an_arm_that_moves_after_an_execution_is_noticed_and_one_that_follows_it_is_not(middle: Plan) -> None:
    bench = Pushed(middle)
    bench.start(middle, override=0.5)
    bench.when(lambda: bench.state == "following", lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", lambda: None)
    bench.wait(SETTLING_TIME + 0.1)
    bench.when(lambda: True, lambda: bench.refusals.extend(bench.unasked))  # none until here
    bench.push(0, -3 * THRESHOLD)
    bench.when(lambda: bench.statuses[-1].unasked_motion != "", bench.stop.set)
    bench.run()
    assert bench.refusals == []
    assert len(bench.unasked) == 1


def test_what_stays_below_the_threshold_or_was_not_seen_is_no_motion(middle: Plan) -> None:
    bench = Pushed(middle)
    bench.wait(SETTLING_TIME + 0.1)
    bench.push(1, 0.9 * THRESHOLD)
    bench.wait(0.5)
    bench.when(lambda: True, lambda: setattr(bench, "speaking", False))
    bench.wait(1.0)
    bench.push(1, 1.0)  # its driver is started again, and finds it elsewhere
    bench.when(lambda: True, lambda: setattr(bench, "speaking", True))
    bench.wait(SETTLING_TIME + 0.5)
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert bench.unasked == []
    assert {status.unasked_motion for status in bench.statuses} == {""}


def test_nothing_starts_while_the_simulated_arm_has_not_put_its_object_back(middle: Plan) -> None:
    bench = Pushed(middle)

    def reset(_: bytes) -> bytes:
        raise Unanswered("it is not there yet")

    def start() -> None:
        with pytest.raises(Unanswered, match="has not put its object back"):
            bench.start_now()

    bench.bus.serve(KEYS.reset("puma560"), reset)
    bench.wait(0.1)
    bench.when(lambda: True, start)
    bench.when(lambda: True, bench.stop.set)
    bench.run()
    assert bench.setpoints == []
