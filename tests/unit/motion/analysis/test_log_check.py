import numpy as np
import pytest

from teachpath.errors import UnusableRecording
from teachpath.io.setpoints import read_setpoints
from teachpath.motion.analysis.log_check import SetpointLog, check_log
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.certificate import plan_trajectory
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Plan
from tests.unit.motion.ways import FAR_X, MIDDLE, way

ARM = Arm.of_variant()

RATE = 250.0


@pytest.fixture(scope="module")
def planned() -> Plan:
    return plan(way(MIDDLE), paper_scene())


def streamed(planned: Plan, **changes: object) -> SetpointLog:
    positions = plan_trajectory(planned).setpoints(RATE)[:, :6]
    return SetpointLog(np.arange(len(positions)) / RATE, positions, **changes)  # type: ignore[arg-type]


def test_what_was_planned_is_judged_to_keep_everything(planned: Plan) -> None:
    judgement = check_log(streamed(planned), way(MIDDLE).curve, ARM)
    assert judgement.faults == ()
    assert any("over 100.0 % of its parameter" in sentence for sentence in judgement.measured)


def test_its_own_kinematics_agree_with_ours() -> None:
    from teachpath.motion.analysis.log_check import _tool

    q = np.random.default_rng(2).uniform(-2, 2, (50, 6))
    np.testing.assert_allclose(_tool(q, ARM), tool_pose(q, ARM)[:, :3, 3], atol=1e-12)


def test_a_setpoint_that_was_dropped_repeated_or_moved_is_found(planned: Plan) -> None:
    whole = streamed(planned)
    middle = len(whole.times) // 2
    dropped = SetpointLog(np.delete(whole.times, middle), np.delete(whole.positions, middle, axis=0), missing=1)
    repeated = SetpointLog(whole.times, np.concatenate([whole.positions[:middle], whole.positions[middle - 1 : -1]]))
    moved = whole.positions.copy()
    moved[middle] += 2e-4
    for log, words in ((dropped, "missing"), (repeated, "limit used to"), (SetpointLog(whole.times, moved), "jerk")):
        faults = check_log(log, way(MIDDLE).curve, ARM).faults
        assert any(words in fault for fault in faults), faults


def test_a_gap_at_rest_is_no_fault_and_one_in_motion_is(planned: Plan) -> None:
    whole = streamed(planned)
    rest = np.repeat(whole.positions[:1], 10, axis=0)
    positions = np.concatenate([rest, whole.positions])
    times = np.concatenate([np.arange(10) / RATE, 1.0 + whole.times])
    assert check_log(SetpointLog(times, positions), None, ARM).faults == ()
    middle = len(times) // 2
    times[middle:] += 0.5
    assert any("not one period apart" in fault for fault in check_log(SetpointLog(times, positions), None, ARM).faults)


def test_where_the_arm_came_to_rest_by_itself_the_log_begins_anew_from_rest(planned: Plan) -> None:
    whole = streamed(planned)
    middle = len(whole.times) // 2
    times = np.concatenate([whole.times[:middle], whole.times[middle - 1] + 0.3 + whole.times])

    def faults(after: np.ndarray, *restarts: int) -> tuple[str, ...]:
        positions = np.concatenate([whole.positions[:middle], after])
        return check_log(SetpointLog(times[: len(positions)], positions, restarts=restarts), None, ARM).faults

    assert len(faults(whole.positions)) == 4  # the gap, and every limit
    assert faults(whole.positions, middle) == ()
    assert any("jerk limit" in fault for fault in faults(whole.positions[middle:], middle)), "it does not begin at rest"


def test_another_path_or_other_limits_are_broken(planned: Plan) -> None:
    assert any("off the path" in f for f in check_log(streamed(planned), way(MIDDLE, height=0.61).curve, ARM).faults)
    faster = streamed(planned)
    quick = SetpointLog(faster.times / 1.2, faster.positions)
    assert len([f for f in check_log(quick, way(MIDDLE).curve, ARM).faults if "limit used to" in f]) == 3
    beyond = SetpointLog(faster.times, faster.positions + np.array([0, 0, 0, 0, 4.0, 0]))
    assert any("beyond its limit" in f for f in check_log(beyond, None, ARM).faults)
    far = tool_pose(np.array(MotionSettings().home), ARM)[:3, 3]
    rest = SetpointLog(faster.times, np.tile(MotionSettings().home, (len(faster.times), 1)))
    assert np.linalg.norm(way(FAR_X).curve(0.0) - far) > 0.01
    assert any("never comes to the start" in f for f in check_log(rest, way(FAR_X).curve, ARM).faults)


def test_a_tool_that_is_faster_than_its_limit_is_found() -> None:
    slow = MotionSettings(tool_speed=0.25)
    arm = Arm.of_settings(slow)
    log = streamed(plan(way(MIDDLE), paper_scene(), slow))
    kept = check_log(log, way(MIDDLE).curve, arm)
    assert kept.faults == ()
    assert any("allowed 0.25 m/s" in sentence for sentence in kept.measured)
    faults = check_log(SetpointLog(log.times / 1.02, log.positions), way(MIDDLE).curve, arm).faults
    assert sum("allowed 0.25 m/s (motion.tool_speed)" in fault for fault in faults) == 1


def test_a_csv_is_read_back_and_a_broken_one_names_its_line() -> None:
    header = "t,q1,q2,q3,q4,q5,q6,on_path\n"
    rows = [f"{0.004 * k},0.1,0.2,0.3,0.4,0.5,{0.001 * k},1" for k in range(6)]
    times, positions, on_path = read_setpoints((header + "\n".join(rows)).encode(), "log.csv")
    np.testing.assert_allclose(positions[:, 5], 0.001 * np.arange(6))
    assert on_path is not None
    assert on_path.all()
    assert len(times) == 6
    seven = header.replace("q6,", "q6,q7,") + "\n".join(row.replace("0.5", "0.5,0.7") for row in rows)
    np.testing.assert_array_equal(read_setpoints(seven.encode(), "log.csv")[1][:, 5], np.full(6, 0.7))
    with pytest.raises(UnusableRecording, match="setpoints of 7 joints; the arm, corke-armstrong, has 6"):
        check_log(SetpointLog(*read_setpoints(seven.encode(), "log.csv")[:2]), None, Arm.of_variant())
    for text, sentence in (
        ("", "first line must be"),
        (header, "0 setpoints are too few"),
        (header + "\n".join([*rows, "1,2,3"]), "line 8: 3 values"),
        (header + "\n".join([*rows, "0,nan,0,0,0,0,0,1"]), "line 8: a value is not finite"),
        (header + "\n".join([*rows, rows[0]]), "line 8: time does not go on"),
        (header + "\n".join(r.replace("0.2", "20.5") for r in rows), "are these degrees"),
    ):
        with pytest.raises(UnusableRecording, match=sentence):
            read_setpoints(text.encode(), "log.csv")
