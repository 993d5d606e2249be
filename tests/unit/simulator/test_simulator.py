"""The simulated arm on the in-memory bus, with a clock that the test turns: no test waits."""

from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import Conflict, UnusableInput
from teachpath.io import documents, wire
from teachpath.motion.arm.kinematics import link_frames, tool_pose
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.collision.grasp import HALF_OPENING
from teachpath.records import ExecutorStatus, Scene, Shape
from teachpath_proto.control import ExecutorState
from tests.unit.simulator.simulator_bench import ARM, HOME, KEYS, NO_WAY_TO_REST, PERIOD_NS, START, Bench, above


def test_stays_at_home_without_setpoints() -> None:
    states = Bench().run(0.5)
    assert np.allclose(states[-1].position, HOME, atol=1e-3)
    assert not states[-1].holding
    assert states[-1].missed == 0


def test_an_arm_at_rest_dozes_speaks_as_often_as_the_contract_asks_and_wakes_at_once() -> None:
    bench = Bench(paper_scene())
    bench.run(0.5)  # the object settles on the table
    bench.steps = 0
    idle = bench.run(2.0)
    assert bench.steps == 0
    assert np.diff([state.stamp_ns for state in idle]).max() <= 50e6  # 20 Hz
    states = bench.move(HOME + 0.5, 1.0)
    assert np.diff([state.stamp_ns for state in states]).max() <= 10e6  # 100 Hz
    assert max(state.tracking_error for state in states) < 0.003
    assert not any(state.late or state.missed for state in states)
    assert np.abs(bench.run(0.2)[-1].position - HOME - 0.5).max() < 2e-3


def test_what_still_falls_does_not_doze() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    x, y, z = scene.carried.position
    bench = Bench(replace(scene, carried=replace(scene.carried, position=(x, y, z + 0.3))))
    assert bench.run(1.0)[-1].object_position[2] == pytest.approx(z, abs=2e-3)


def test_follows_a_smooth_move_closely_and_within_its_torques() -> None:
    states = Bench().move(HOME + np.array([0.8, -0.4, 0.5, 0.6, 0.5, -1.0]), 1.2)
    assert np.max([np.abs(s.velocity).max() for s in states]) > 1.0  # a real move, not a crawl
    assert max(s.tracking_error for s in states) < 0.003
    assert all(np.all(np.abs(s.torque) <= ARM.limits.torque) for s in states)
    assert not any(s.holding or s.missed for s in states)


def test_an_impossible_move_saturates_the_torques_instead_of_passing_them() -> None:
    bench = Bench()
    states = bench.move(HOME + np.array([1.5, -0.8, 0.0, 0.0, 0.0, 0.0]), 0.25)
    torques = np.abs([s.torque for s in states])
    assert np.all(torques <= ARM.limits.torque)
    assert np.any(torques == ARM.limits.torque)
    assert max(s.tracking_error for s in states) > 0.05


def test_without_setpoints_it_follows_the_way_to_rest_says_so_and_waits_for_a_stream_that_begins_there() -> None:
    bench, step = Bench(), np.array([0.3, 0, 0, 0, 0, 0])
    left = 1.0 - np.linspace(0.0, 1.0, 51)[1:, None, None]  # of the way, whose rate falls with its square
    shares = np.concatenate([1 - left**3, 3 * left**2 / 0.2, -6 * left / 0.2**2], axis=1)
    way = shares * step + [HOME, np.zeros(6), np.zeros(6)]
    velocity = 3 * step / 0.2  # with which the way begins

    def begin(now: int) -> None:
        if bench.cycle < 2 and (now - START) % PERIOD_NS == 0:
            moves = bench.cycle == 1
            bench.send(HOME, velocity * moves, np.zeros(6), way=way if moves else NO_WAY_TO_REST)

    states = bench.run(0.5, begin)
    assert not states[0].holding
    assert states[-1].stopped
    assert states[-1].cycle == 2
    assert any(state.holding and not state.stopped for state in states)
    assert np.allclose(states[-1].position, HOME + step, atol=2e-3)
    bench.wanted = HOME  # which is elsewhere
    assert bench.move(HOME + 2 * step, 0.2)[-1].stopped
    bench.wanted = HOME + step
    again = bench.move(HOME, 0.4)
    assert not again[-1].holding
    assert np.allclose(again[-1].position, HOME, atol=5e-3)


def test_the_end_of_an_execution_is_no_silence() -> None:
    bench = Bench()
    bench.move(HOME + 0.1, 0.4)

    def tell(now: int) -> None:
        status = wire.encode_status(ExecutorStatus(execution="e1", state=ExecutorState.ENDED))
        bench.bus.publish(KEYS.executor_status, status)

    assert not any(state.holding for state in bench.run(0.2, tell))


def test_counts_the_setpoints_that_never_came() -> None:
    bench = Bench()
    states = bench.move(HOME + 0.2, 1.0, skip=10)
    assert states[-1].missed == pytest.approx(bench.cycle // 10, abs=1)
    assert states[-1].missed > 20
    assert max(s.tracking_error for s in states) < 0.005  # one left out is bridged


def test_a_late_or_repeated_setpoint_changes_nothing() -> None:
    bench = Bench()
    bench.move(HOME, 0.1)
    newest = bench.cycle
    for cycle in (1, newest):
        bench.cycle = cycle - 1
        bench.send(HOME + 1.0, np.zeros(6), np.zeros(6))
    states = bench.run(0.05)
    assert states[-1].cycle == newest
    assert np.allclose(states[-1].position, HOME, atol=2e-3)


def test_carries_the_object_only_when_gripped_near_it() -> None:
    scene = paper_scene()
    assert scene.carried is not None
    x, y, z = scene.carried.position
    for offset, carried in (0.0, True), (0.08, False):
        bench = Bench(scene)
        bench.move(above((x + offset, y, z + 0.15)), 1.5)
        bench.move(above((x + offset, y, z)), 1.0)
        bench.move(above((x + offset, y, z)), 0.2, closed=True)
        states = bench.move(above((x + offset, y, z + 0.15)), 1.0, closed=True)
        lifted = states[-1].object_position[2] - z
        assert states[-1].gripper_closed
        assert states[-1].gripper_opening == pytest.approx(0.04 if carried else 0.0, abs=1e-3)
        assert lifted == pytest.approx(0.15 if carried else 0.0, abs=2e-3)
        if carried:
            tool = tool_pose(states[-1].position, ARM)[:3, 3]
            assert np.allclose(states[-1].object_position, tool, atol=2e-3)
            assert states[0].gripper_opening == pytest.approx(0.04, abs=1e-3)
            dropped = bench.move(above((x + offset, y, z + 0.15)), 1.0, closed=False)
            assert dropped[-1].object_position[2] == pytest.approx(z, abs=2e-3)  # it falls back onto the table
            assert dropped[-1].gripper_opening == pytest.approx(2 * HALF_OPENING)


def test_an_object_without_a_table_falls_onto_the_floor_of_its_scene() -> None:
    block = Shape("block", "box", (0.04, 0.04, 0.04), (0.6, 0.0, 0.2))
    bench = Bench(Scene("low", carried=block, floor=-0.1))
    assert bench.run(1.5)[-1].object_position[2] == pytest.approx(-0.08, abs=2e-3)


def test_reset_brings_the_object_back_leaves_the_arm_and_takes_a_new_scene() -> None:
    bench = Bench(paper_scene())
    bench.move(HOME + 0.3, 0.5)
    bench.run(0.3)  # nothing comes any more
    state = wire.decode_state(bench.simulator.reset(b""))
    assert np.allclose(state.position, HOME + 0.3, atol=0.01)
    assert (state.missed, state.cycle, state.execution) == (0, 0, "")
    assert state.object_position == paper_scene().carried.position  # type: ignore[union-attr]
    state = wire.decode_state(bench.simulator.reset(documents.encode(empty_scene())))
    assert not any(state.object_orientation)  # no object there
    with pytest.raises(UnusableInput):
        bench.simulator.reset(b"no scene")


def test_the_scene_is_not_changed_under_an_execution() -> None:
    bench = Bench(paper_scene())
    refused: list[str] = []

    def change(now: int) -> None:
        bench.send(HOME, np.zeros(6), np.zeros(6), execution="run-1")
        if now < START + 50_000_000:
            return
        try:
            bench.simulator.reset(documents.encode(empty_scene()))
        except Conflict as error:
            refused.append(str(error))

    states = bench.run(0.2, change)
    assert "run-1 is under way in scene paper" in refused[-1]
    assert any(states[-1].object_orientation)  # the object is still there
    ended = wire.encode_status(ExecutorStatus(execution="run-1", state=ExecutorState.ENDED))
    bench.run(0.002, lambda now: bench.bus.publish(KEYS.executor_status, ended))
    assert not any(wire.decode_state(bench.simulator.reset(documents.encode(empty_scene()))).object_orientation)


def test_answers_the_reset_query_and_shows_that_it_lives() -> None:
    bench = Bench()
    alive: list[bool] = []
    bench.bus.watch(KEYS.alive("robot", "puma560"), lambda key, here: alive.append(here))
    answers: list[bytes] = []
    bench.run(0.005, lambda now: answers.append(bench.bus.ask(KEYS.reset("puma560"))))
    assert np.array_equal(wire.decode_state(answers[0]).position, HOME)
    assert alive == [True, False]


def test_malformed_setpoints_are_left_out() -> None:
    bench = Bench()
    states = bench.run(0.1, lambda now: bench.bus.publish(KEYS.setpoint("puma560"), b"\xff\xff"))
    assert np.allclose(states[-1].position, HOME, atol=1e-3)


def test_the_models_links_are_where_the_kinematics_says() -> None:
    bench = Bench(paper_scene())
    arm = bench.simulator._arm
    frames = link_frames(arm.position, ARM)
    for i in range(1, 7):
        assert np.allclose(arm.data.body(f"link{i}").xpos, frames[i, :3, 3], atol=1e-9)
