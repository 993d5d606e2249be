"""The one door to motion: what may not start moves nothing, and what no longer holds does not go on."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import PathRefused
from teachpath.io.documents import encode
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.tool_speed import difference_speeds
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.plan import plan
from teachpath.motion.planning.signature import SigningKey
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan
from tests.unit.executor.executors import EPOCH, PERIOD_NS, Bench, signed
from tests.unit.motion.ways import MIDDLE, way

DAY = 86_400 * 10**9


@pytest.fixture
def bench() -> Bench:
    return Bench()


def refusal(bench: Bench, plan: Plan) -> str:
    """What the executor says when it does not start; the arm has not moved and the journal says why."""
    said: list[str] = []

    def ask() -> None:
        with pytest.raises(PathRefused) as refused:
            bench.command("start", plan=encode(plan))
        said.append(str(refused.value))
        bench.stop.set()

    bench.when(lambda: bench.now > 3 * PERIOD_NS, ask)
    bench.run()
    assert not bench.setpoints
    assert [entry.answer for entry in bench.journal] == said
    return said[0]


def unsigned(plan: Plan) -> Plan:
    return replace(plan, certificate=replace(plan.certificate, signature=None))


@pytest.mark.parametrize(
    ("forge", "sentence"),
    [
        (lambda plan: replace(plan, squared_rates=4.0 * plan.squared_rates), "the plan or its certificate was changed"),
        (unsigned, "is not signed: it was made outside a station"),
        (lambda plan: signed(unsigned(plan), issued_ns=EPOCH - 31 * DAY), "expired 1.00 days ago"),
        (lambda plan: signed(unsigned(plan), key=SigningKey(b"another station's key, 32 bytes.")), "another station"),
    ],
)
def test_a_plan_that_the_station_did_not_sign_or_for_no_longer_moves_nothing(
    bench: Bench, middle: Plan, forge: Callable[[Plan], Plan], sentence: str
) -> None:
    asked: list[bytes] = []
    bench.confirm = lambda query: asked.append(query) or query  # type: ignore[func-returns-value]
    said = refusal(bench, forge(middle))
    assert sentence in said
    assert "plan the path again" in said
    assert not asked


def revoked(_: bytes) -> bytes:
    raise PathRefused("the certificate of plan was revoked: the table was moved; plan the path again")


def test_what_the_service_refuses_moves_nothing(bench: Bench, middle: Plan) -> None:
    bench.confirm = revoked
    assert "was revoked: the table was moved" in refusal(bench, middle)


def test_without_an_answer_of_the_service_nothing_moves(bench: Bench, middle: Plan) -> None:
    bench.service.close()
    assert "the service did not answer" in (said := refusal(bench, middle))
    assert "teachpath serve" in said


def test_an_answer_for_another_plan_is_none(bench: Bench, middle: Plan) -> None:
    bench.confirm = lambda query: query.replace(b"plan", b"nalp")
    assert "answered for another plan" in refusal(bench, middle)


@pytest.mark.parametrize("verb", ["resume", "reverse", "step", "override"])
def test_a_held_arm_does_not_go_on_under_a_certificate_that_holds_no_longer(
    bench: Bench, middle: Plan, verb: str
) -> None:
    given = {"step": {"length": 0.01}, "override": {"override": 0.5}}.get(verb, {})
    said: list[str] = []

    def try_it() -> None:
        with pytest.raises(PathRefused) as refused:
            bench.command(verb, **given)
        said.append(str(refused.value))

    bench.start(middle)
    bench.when(lambda: bench.state == "following", lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: setattr(bench, "confirm", revoked))
    bench.when(lambda: True, try_it)
    bench.when(lambda: bool(said), lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert said == ["the certificate of plan was revoked: the table was moved; plan the path again"]
    states = bench.states()
    assert "following" not in states[states.index("held") :]


def test_the_speed_of_the_tool_is_that_of_the_certificate_and_its_use_is_measured(middle: Plan) -> None:
    slow = MotionSettings(tool_speed=0.25)
    bench = Bench(motion=slow)
    assert "holds for motion.tool_speed = None, and it is 0.25 now" in refusal(bench, middle)
    bench = Bench(motion=slow)
    bench.start(signed(plan(way(MIDDLE), paper_scene(), slow), motion=slow))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    speeds = difference_speeds(np.array([s.position for s in bench.setpoints]), 250.0, Arm.of_settings(slow))
    assert bench.statuses[-1].limit_use == pytest.approx(speeds.max() / 0.25, rel=1e-9)
    assert "speed of the" in bench.statuses[-1].limit_place
