"""Who may steer the arm, by steps too, and how it goes on after a hold in which something happened to it."""

import numpy as np
import pytest

from teachpath.errors import Conflict, TeachpathError, UnusableInput
from teachpath.io import wire
from teachpath.io.documents import encode
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.records import Command, Plan
from teachpath_proto.control import CommandVerb
from tests.unit.executor.executors import KEYS, PERIOD_NS, Bench, standing, within_limits
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()


@pytest.fixture
def bench() -> Bench:
    return Bench()


def refused(bench: Bench, kind: type[TeachpathError], verb: str, **given: object) -> str:
    with pytest.raises(kind) as error:
        bench.command(verb, **given)
    return str(error.value)


def following(bench: Bench, progress: float = 0.3) -> bool:
    return bench.state == "following" and bench.statuses[-1].progress > progress


def settled(bench: Bench) -> bool:
    """Held, and told of it long after the arm came to rest."""
    return bench.state == "held" and all(s.state == "held" for s in bench.statuses[-6:])


# steps


@pytest.mark.parametrize("length", [0.02, -0.03, 0.0004, 5.0, -5.0])
def test_a_step_goes_a_length_along_the_path_and_is_held(bench: Bench, middle: Plan, length: float) -> None:
    held: list[float] = []
    total = float(middle.lengths[-1])

    def step() -> None:
        held.append(bench.statuses[-1].length)
        bench.command("step", length=length)

    bench.start(middle)
    bench.when(lambda: following(bench), lambda: bench.command("hold"))
    bench.when(lambda: settled(bench), step)
    bench.when(lambda: bench.state == "following", lambda: None)
    bench.when(lambda: settled(bench), lambda: held.append(bench.statuses[-1].length))
    bench.when(lambda: len(held) == 2, lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert held[1] == pytest.approx(min(max(held[0] + length, 0.0), total), abs=1e-6)
    assert within_limits(bench.setpoints)
    assert bench.statuses[-1].progress == pytest.approx(1.0)
    on_path = np.array([s.position for s in bench.setpoints if s.on_path])
    wanted = way(MIDDLE).curve(np.linspace(0, 1, 20001))
    tool = tool_pose(on_path[::10], ARM)[:, :3, 3]
    off = np.sqrt(((tool[:, None, :] - wanted[None, ::10, :]) ** 2).sum(-1).min(axis=1))
    assert off.max() < 1e-3  # as fine as the samples of the curve are


def test_a_step_of_one_node_goes_to_the_next_one_and_back(bench: Bench, middle: Plan) -> None:
    lengths: list[float] = []

    def then(nodes: int) -> None:
        lengths.append(bench.statuses[-1].length)
        bench.command("step", nodes=nodes)

    bench.start(middle)
    bench.when(lambda: following(bench), lambda: bench.command("hold"))
    for nodes in (1, 1, -1):
        bench.when(lambda: settled(bench), lambda nodes=nodes: then(nodes))  # type: ignore[misc]
        bench.when(lambda: bench.state == "following", lambda: None)
    bench.when(lambda: settled(bench), lambda: lengths.append(bench.statuses[-1].length))
    bench.when(lambda: len(lengths) == 4, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    first = int(np.searchsorted(middle.lengths, lengths[0] + 1e-5))
    wanted = [middle.lengths[first], middle.lengths[first + 1], middle.lengths[first]]
    np.testing.assert_allclose(lengths[1:], wanted, atol=1e-6)


def test_steps_that_make_no_sense_say_why(bench: Bench, middle: Plan) -> None:
    said: list[str] = []
    bench.start(middle)
    bench.when(lambda: bench.state == "approaching", lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: said.append(refused(bench, Conflict, "step", length=0.01)))
    bench.when(lambda: bool(said), lambda: bench.command("resume"))
    bench.when(lambda: following(bench), lambda: said.append(refused(bench, Conflict, "step", length=0.01)))
    bench.when(lambda: True, lambda: said.append(refused(bench, UnusableInput, "step")))
    bench.when(lambda: True, lambda: said.append(refused(bench, UnusableInput, "step", length=1e3)))
    bench.when(lambda: True, lambda: said.append(refused(bench, UnusableInput, "step", length=float("nan"))))
    bench.when(lambda: len(said) == 5, bench.stop.set)
    bench.run()
    for sentence, words in zip(
        said,
        ["on the approach", "hold it first", "one of the two", "units metres", "length should be finite, got nan"],
        strict=True,
    ):
        assert words in sentence


# stopping


def test_a_stop_may_be_said_at_any_time_and_twice(bench: Bench, middle: Plan) -> None:
    states: list[str] = []

    def stop(execution: str = "run-1") -> None:
        payload = wire.encode_command(Command(CommandVerb.STOP, execution))
        states.append(wire.decode_status(bench.bus.ask(KEYS.executor_stop, payload)).state)

    bench.when(lambda: True, lambda: stop(""))  # nothing was ever started
    bench.start(middle)
    bench.when(lambda: following(bench), stop)
    bench.when(lambda: bench.state == "stopping", stop)
    bench.when(lambda: bench.state == "ended", lambda: stop(""))
    bench.when(lambda: True, lambda: stop("run-1"))
    bench.when(lambda: len(states) == 5, bench.stop.set)
    bench.run()
    assert states == ["idle", "following", "stopping", "ended", "ended"]
    assert bench.statuses[-1].reason == "stopped by the operator"
    assert standing(bench.setpoints)


# control


def test_while_somebody_is_in_control_others_may_only_stop(bench: Bench, middle: Plan) -> None:
    said: list[str] = []
    tokens: list[str] = []
    bench.when(lambda: True, lambda: tokens.append(bench.control("acquire", "Ada", seconds=60.0).token))
    bench.when(
        lambda: bench.now > 10**7,
        lambda: said.append(refused(bench, Conflict, "start", plan=encode(middle), who="Bea")),
    )
    bench.when(lambda: bool(said), lambda: bench.command("start", plan=encode(middle), lease=tokens[0]))
    bench.when(lambda: following(bench), lambda: said.append(refused(bench, Conflict, "hold", lease="stale")))
    bench.when(lambda: True, lambda: bench.command("override", override=0.5, lease=tokens[0]))
    bench.when(lambda: True, lambda: bench.command("stop", who="Bea"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert said[0].startswith("Ada is in control; ask for it")
    assert "Ada is in control" in said[1]
    assert bench.statuses[-1].reason == "stopped by Bea"
    assert bench.statuses[-1].operator == "Ada"
    done = [(e.who, e.verb) for e in bench.journal if e.answer == "done"]
    assert done == [("Ada", "acquire control"), ("Ada", "start"), ("Ada", "override"), ("Bea", "stop")]
    assert [(e.who, e.verb) for e in bench.journal if e.answer != "done"] == [("Bea", "start"), ("somebody", "hold")]


def test_an_operator_who_was_lost_while_nothing_moved_holds_no_later_motion(bench: Bench, middle: Plan) -> None:
    bench.when(lambda: True, lambda: bench.control("acquire", "Ada", seconds=0.5, hold_when_lost=True))
    bench.when(lambda: bench.now > 1e9, lambda: bench.command("start", plan=encode(middle)))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert "held" not in bench.states()


def test_a_lost_operator_leaves_an_arm_that_holds_and_may_be_resumed(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(
        lambda: bench.state == "following",
        lambda: bench.control("acquire", "Ada", seconds=0.5, hold_when_lost=True),
    )
    bench.when(lambda: bench.state == "held", lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    held = next(s for s in bench.statuses if s.state == "held")
    assert held.reason.startswith("nothing was heard of Ada")
    assert held.operator == ""
    assert ("the executor", "hold") in [(e.who, e.verb) for e in bench.journal]
    assert bench.statuses[-1].progress == pytest.approx(1.0)


# regain and revocation


def test_an_arm_that_was_pushed_away_stays_there_and_is_brought_back(bench: Bench, middle: Plan) -> None:
    sent: list[int] = []

    def push() -> None:
        bench.pushed = 0.1

    def let_go() -> None:
        sent.append(len(bench.setpoints))
        bench.command("resume")
        bench.pushed = 0.0

    bench.start(middle)
    bench.when(lambda: following(bench), lambda: bench.command("hold"))
    bench.when(lambda: settled(bench), push)
    bench.when(lambda: "pushed 0.100 rad" in bench.statuses[-1].reason, lambda: sent.append(len(bench.setpoints)))
    bench.when(lambda: settled(bench) and bench.now % 10 == 0, let_go)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert sent[1] - sent[0] <= 1  # nothing is sent to an arm that somebody holds
    held, again = bench.setpoints[: sent[1]], bench.setpoints[sent[1] :]
    np.testing.assert_allclose(again[0].position, held[-1].position + 0.1, atol=1e-3)
    assert within_limits(held)
    assert within_limits(again)
    assert "on the way back to the path" in {s.activity for s in bench.statuses}
    assert min(np.abs(s.position - held[-1].position).max() for s in again) < 1e-9
    assert bench.statuses[-1].progress == pytest.approx(1.0)


def test_a_revoked_certificate_holds_for_good(bench: Bench, middle: Plan) -> None:
    said: list[str] = []
    bench.start(middle)
    bench.when(lambda: following(bench), lambda: bench.command("revoke", "", plan_id="another", reason="no"))
    bench.when(
        lambda: following(bench, 0.4),
        lambda: bench.command("revoke", "", plan_id=middle.id, reason="the table was moved"),
    )
    bench.when(lambda: bench.state == "held", lambda: said.append(refused(bench, Conflict, "resume")))
    bench.when(lambda: True, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    held = next(s for s in bench.statuses if s.state == "held")
    assert "the table was moved" in held.reason
    assert said == [held.reason]
    assert within_limits(bench.setpoints)


@pytest.mark.parametrize("timeout", [0.3, 1.2])
def test_an_arm_that_takes_up_no_setpoints_is_held_and_brought_back(middle: Plan, timeout: float) -> None:
    bench = Bench(setpoint_timeout=timeout)

    def go_deaf() -> None:
        bench.deaf = bench.setpoints[-1]

    def hear_again() -> None:
        bench.deaf = None
        bench.position = bench.setpoints[-1].position

    bench.start(middle)
    bench.when(lambda: bench.state == "following" and bench.statuses[-1].progress > 0.2, go_deaf)
    bench.when(lambda: bench.state == "held", lambda: None)
    bench.when(lambda: "was pushed" in bench.statuses[-1].reason, lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "approaching" or bench.state == "following", hear_again)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    reasons = [status.reason for status in bench.statuses if status.state in ("held", "stopping")]
    assert any(f"taken up no setpoint for {timeout} s" in reason for reason in reasons)
    assert ("the executor", "hold") in [(entry.who, entry.verb) for entry in bench.journal]
    assert bench.statuses[-1].progress == pytest.approx(1.0)


@pytest.mark.parametrize("pace", [0.9, 0.5, 0.2])
def test_an_arm_that_cannot_keep_up_is_waited_for_so_that_a_stop_does_not_wait(
    bench: Bench, middle: Plan, pace: float
) -> None:
    late: list[int] = []

    def ended() -> bool:
        if len(bench.setpoints) % 25 == 0:
            late.append(bench.late)
        return bench.state == "ended"

    bench.pace = pace
    bench.start(middle)
    bench.when(ended, bench.stop.set)
    bench.run()
    assert max(late) * PERIOD_NS < 0.9e9  # 0.3 s and what it takes to come to rest
    assert any("waiting for the arm" in status.activity for status in bench.statuses) == (pace < 0.9)
    assert not any(status.state in ("held", "faulted") for status in bench.statuses)
    assert bench.statuses[-1].progress == pytest.approx(1.0)
    assert within_limits(bench.setpoints)


def test_an_arm_that_is_late_is_not_taken_for_one_that_was_pushed_away(bench: Bench, middle: Plan) -> None:
    seen: list[str] = []

    def resume_too_early() -> None:
        with pytest.raises(Conflict, match="not at rest yet"):
            bench.command("resume")
        seen.append(bench.statuses[-1].reason)
        bench.behind = 0

    bench.behind = 110  # 0.44 s
    bench.start(middle)
    bench.when(lambda: bench.state == "following" and bench.statuses[-1].progress > 0.3, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: None)
    bench.when(lambda: bench.executor._command_handler.current.is_settled, resume_too_early)
    bench.when(lambda: True, lambda: None)
    bench.when(lambda: True, lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert seen == ["held by the operator"]
    assert not any("pushed" in status.reason for status in bench.statuses)
    assert bench.statuses[-1].progress == pytest.approx(1.0)
    assert within_limits(bench.setpoints)
