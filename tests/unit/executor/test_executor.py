from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from teachpath.errors import Conflict, PathRefused, TeachpathError, Unreachable, UnusableInput
from teachpath.executor.settings import ExecutorSettings
from teachpath.io.documents import encode
from teachpath.motion.analysis.log_check import SetpointLog, check_log
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.records import Plan
from tests.unit.executor.executors import EPOCH, HOME, PERIOD_NS, Bench, standing, within_limits
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_a_whole_pick_and_place(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.states() == ["idle", "approaching", "following", "ended"]
    assert within_limits(bench.setpoints)
    assert [s.cycle for s in bench.setpoints] == list(range(len(bench.setpoints)))
    assert set(np.diff([s.nominal_ns for s in bench.setpoints])) == {PERIOD_NS}
    closed = [s for s in bench.setpoints if s.gripper_closed]
    tool = tool_pose(np.array([closed[0].position, closed[-1].position]), ARM)[:, :3, 3]
    np.testing.assert_allclose(tool, way(MIDDLE).curve(np.array([0.0, 1.0])), atol=1e-6)
    np.testing.assert_allclose(bench.setpoints[-1].position, HOME, atol=1e-9)
    last = bench.statuses[-1]
    assert last.progress == 1.0
    assert last.cycles == len(bench.setpoints)
    assert last.duration == pytest.approx(len(bench.setpoints) / 250.0)
    assert (last.late, last.missed) == (0, 0)
    # The path was closed-gripper for as long as planned, plus the time the gripper takes.
    assert len(closed) / 250.0 == pytest.approx(middle.duration + ExecutorSettings().dwell, abs=0.05)


def test_the_use_of_limits_is_measured_on_the_setpoints(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    positions = np.array([HOME] * 3 + [s.position for s in bench.setpoints])
    uses = [
        np.abs(np.diff(positions, k, axis=0)).max(axis=0) * 250.0**k / limit
        for k, limit in ((1, ARM.limits.speed), (2, ARM.limits.acceleration), (3, ARM.limits.jerk))
    ]
    assert bench.statuses[-1].limit_use == pytest.approx(np.max(uses), rel=1e-9)
    assert "joint" in bench.statuses[-1].limit_place


def test_hold_stands_on_the_path_and_resume_goes_on(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following" and bench.statuses[-1].progress > 0.3, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.states() == ["idle", "approaching", "following", "stopping", "held", "following", "ended"]
    held = next(s for s in bench.statuses if s.state == "held")
    assert held.reason == "held by the operator"
    assert standing(bench.setpoints[: held.cycles])
    assert 0.3 < held.progress < 1.0
    assert within_limits(bench.setpoints)
    assert bench.statuses[-1].progress == 1.0


def test_the_approach_can_be_held_too(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: len(bench.setpoints) > 50, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held", lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert bench.states()[1:6] == ["approaching", "stopping", "held", "approaching", "following"]
    assert within_limits(bench.setpoints)


def test_stop_ends_on_the_path(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following" and bench.statuses[-1].progress > 0.3, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    last = bench.statuses[-1]
    assert bench.states()[-3:] == ["following", "stopping", "ended"]
    assert last.reason == "stopped by the operator"
    assert 0.3 < last.progress < 1.0
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)
    wanted = way(MIDDLE).curve(np.linspace(0, 1, 20001))
    here = tool_pose(bench.setpoints[-1].position, ARM)[:3, 3]
    assert np.linalg.norm(wanted - here, axis=1).min() < 1e-4


def test_a_process_told_to_end_brakes_first(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: bench.state == "following" and bench.statuses[-1].progress > 0.3, bench.stop.set)
    bench.run()
    assert bench.states()[-2:] == ["stopping", "ended"]
    assert bench.statuses[-1].reason == "the executor was told to stop"
    assert standing(bench.setpoints)
    assert within_limits(bench.setpoints)


def test_an_override_slows_down_and_zero_holds(bench: Bench, middle: Plan) -> None:
    bench.start(middle, override=0.5)
    bench.when(lambda: bench.state == "following", lambda: bench.command("override", override=0.0))
    bench.when(lambda: bench.state == "held", lambda: bench.command("override", override=0.2))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    assert next(s for s in bench.statuses if s.state == "held").reason == "the override is 0"
    assert bench.statuses[-1].override == pytest.approx(0.2)
    assert bench.statuses[-1].duration > 5 * middle.duration
    assert within_limits(bench.setpoints)


def test_a_lost_joint_state_holds_with_a_reason_and_may_be_resumed(bench: Bench, middle: Plan) -> None:
    refused: list[TeachpathError] = []

    def fall_silent() -> None:
        bench.speaking = False

    def resume_too_early() -> None:
        with pytest.raises(Unreachable) as error:
            bench.command("resume")
        refused.append(error.value)
        bench.speaking = True

    bench.start(middle)
    bench.when(lambda: bench.state == "following", fall_silent)
    bench.when(lambda: bench.state == "held", resume_too_early)
    bench.when(lambda: bool(refused), lambda: None)
    bench.when(lambda: bool(refused), lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    held = next(s for s in bench.statuses if s.state == "held")
    assert "no joint state for 0.2" in held.reason
    assert refused
    assert bench.statuses[-1].progress == 1.0
    assert within_limits(bench.setpoints)


def test_a_large_tracking_error_ends_the_execution_as_faulted(bench: Bench, middle: Plan) -> None:
    def block() -> None:
        bench.error = 0.2

    bench.start(middle)
    bench.when(lambda: bench.state == "following", block)
    bench.when(lambda: bench.state == "faulted", bench.stop.set)
    bench.run()
    assert bench.states()[-2:] == ["stopping", "faulted"]
    assert "tracking error 0.200 rad at s = 0.0" in bench.statuses[-1].reason
    assert bench.statuses[-1].tracking_error == pytest.approx(0.2)
    assert standing(bench.setpoints)


def test_late_cycles_are_counted_and_left_out_ones_never_made_up_for(bench: Bench, middle: Plan) -> None:
    bench.oversleep = {100: 3_000_000, 200: 9_000_000}
    bench.start(middle)
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    last = bench.statuses[-1]
    assert (last.late, last.missed) == (2, 2)
    assert last.lateness_max_us == pytest.approx(9000)
    sent = np.diff([s.sent_ns for s in bench.setpoints])
    assert sorted(sent)[-2:] == [7_000_000, 13_000_000]
    assert sent.min() == 1_000_000  # the one that came 3 ms late, then one in time: nothing faster
    # The clock of the motion loses the 8 ms: position, velocity and acceleration still belong together.
    moving = [b.nominal_ns - a.nominal_ns for a, b in pairwise(bench.setpoints) if np.any(b.velocity)]
    assert set(moving) == {PERIOD_NS}
    assert within_limits(bench.setpoints)


def test_whenever_the_loop_oversleeps_what_was_sent_can_be_judged(bench: Bench, middle: Plan) -> None:
    bench.oversleep = dict.fromkeys(range(50, 3000, 7), 5_000_000)
    bench.start(middle)
    bench.when(lambda: bench.statuses[-1].progress > 0.3, lambda: bench.command("hold"))
    bench.when(lambda: bench.state == "held" and bench.executor._command_handler.current.is_settled, lambda: None)  # type: ignore[union-attr]
    bench.when(lambda: True, lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    times = np.array([s.nominal_ns - EPOCH for s in bench.setpoints]) / 1e9
    on_path = np.array([s.on_path for s in bench.setpoints])
    log = SetpointLog(times, np.array([s.position for s in bench.setpoints]), on_path)
    assert check_log(log, way(MIDDLE).curve, ARM).faults == ()


def refusal(bench: Bench, kind: type[TeachpathError], **given: object) -> str:
    """What the executor says when it does not start."""
    said: list[str] = []

    def ask() -> None:
        with pytest.raises(kind) as error:
            bench.command("start", **given)
        said.append(str(error.value))
        bench.stop.set()

    bench.when(lambda: bench.now > 3 * PERIOD_NS, ask)
    bench.run()
    assert not bench.setpoints
    return said[0]


def test_a_changed_plan_is_refused(bench: Bench, middle: Plan) -> None:
    changed = replace(middle, scene=empty_scene())
    assert "the plan or its certificate was changed" in refusal(bench, PathRefused, plan=encode(changed))


def test_what_is_no_plan_is_refused(bench: Bench) -> None:
    assert "Plan" in refusal(bench, UnusableInput, plan=b"{}")


def test_an_arm_that_does_not_speak_is_not_moved(bench: Bench, middle: Plan) -> None:
    bench.speaking = False
    assert "no joint state from puma560" in refusal(bench, Unreachable, plan=encode(middle))


def test_a_moving_arm_is_not_taken_over(bench: Bench, middle: Plan) -> None:
    bench.velocity = 0.4
    assert "still moves at 0.40 rad/s" in refusal(bench, Conflict, plan=encode(middle))


def test_an_arm_among_the_obstacles_is_not_moved_through_them(middle: Plan) -> None:
    beside_the_box = middle.joints[len(middle.joints) // 2] + np.array([0.0, 0.0, 0.25, 0.0, 0.0, 0.0])
    said = refusal(Bench(beside_the_box), PathRefused, plan=encode(middle))
    assert "on the way to the path's start" in said


def test_a_second_start_and_commands_to_another_execution_are_conflicts(bench: Bench, middle: Plan) -> None:
    seen: list[str] = []

    def try_others() -> None:
        for verb, execution in (("start", "run-2"), ("hold", "run-2")):
            with pytest.raises(Conflict):
                bench.command(verb, execution, plan=encode(middle))
            seen.append(verb)
        bench.stop.set()

    bench.start(middle)
    bench.when(lambda: len(bench.setpoints) > 10, try_others)
    bench.run()
    assert seen == ["start", "hold"]


def test_an_ended_execution_may_be_followed_by_another_from_where_the_arm_is(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(lambda: len(bench.setpoints) > 150, lambda: bench.command("stop"))
    bench.when(lambda: bench.state == "ended", lambda: bench.command("start", "run-2", plan=encode(middle)))
    bench.when(lambda: bench.statuses[-1].execution == "run-2" and bench.state == "ended", bench.stop.set)
    bench.run()
    first = [s for s in bench.setpoints if s.execution == "run-1"]
    second = [s for s in bench.setpoints if s.execution == "run-2"]
    np.testing.assert_allclose(second[0].position, first[-1].position, atol=1e-4)
    assert bench.statuses[-1].progress == 1.0
    assert within_limits(second)


def test_reverse_goes_back_to_the_beginning_of_the_path_and_resume_on_to_its_end(bench: Bench, middle: Plan) -> None:
    bench.start(middle)
    bench.when(
        lambda: bench.state == "following" and bench.statuses[-1].progress > 0.4, lambda: bench.command("reverse")
    )
    bench.when(lambda: bench.state == "held", lambda: bench.command("resume"))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    held = next(s for s in bench.statuses if s.state == "held")
    assert held.progress == 0.0
    assert "back at the beginning" in held.reason
    assert bench.states()[-4:] == ["following", "held", "following", "ended"]
    assert bench.statuses[-1].progress == 1.0
    assert within_limits(bench.setpoints)
