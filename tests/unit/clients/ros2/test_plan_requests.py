"""Whatever is sent, only a plan's own motion, fresh and once, asks for that plan."""

import random
from functools import cache
from typing import Any

import numpy as np
import pytest

from teachpath.io.programs.joint_trajectory import joint_trajectory_cdr
from teachpath.records import SampledMotion
from teachpath_client.__main__ import main
from teachpath_client.ros2.messages import TRAJECTORY, Malformed, decode, encode, header
from teachpath_client.ros2.plan_requests import MAX_SIZE, PLAN_RATE, PlannedMotion, PlanRequests
from teachpath_client.ros2.trajectories import JointMotion, read_trajectory, trajectory_fields
from tests.unit.clients.ros2 import golden
from tests.unit.clients.ros2.test_readings import NAMES

NOW_NS = golden.STAMP_NS
DURATION = 1.2345  # s
SECOND = 1_000_000_000


def moved(times: np.ndarray, duration: float = DURATION) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the joints, their speeds and accelerations of a plan from rest to rest."""
    share, slopes = np.clip(times / duration, 0.0, 1.0)[:, None], np.array([0.4, -1.1, 0.2, 0.9, -0.3, 2.0])
    position = slopes * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    speed = slopes * 30.0 * share**2 * (1.0 - share) ** 2 / duration
    return position, speed, slopes * 60.0 * share * (1.0 - share) * (1.0 - 2.0 * share) / duration**2


def written(rate: float, duration: float = DURATION) -> bytes:
    """Return the plan as a station writes it."""
    times = np.arange(int(np.ceil(duration * rate)) + 1) / rate
    names = tuple(f"joint {number}" for number in range(1, 7))
    return joint_trajectory_cdr(SampledMotion("p", NOW_NS, (), names, rate, times, *moved(times, duration)))


@cache
def planned() -> PlannedMotion:
    return PlannedMotion(read_trajectory(decode(TRAJECTORY, written(PLAN_RATE)), NAMES), DURATION)


def asking(rate: float = 125.0, *, stamp: int = NOW_NS, **changed: Any) -> bytes:
    """Return the plan's own trajectory with a stamp; changed: joint_names, points."""
    message = decode(TRAJECTORY, written(rate))
    fields = {"joint_names": message.joint_names, "points": message.points} | changed
    return encode(TRAJECTORY, header=header(stamp, ""), **fields)


def judged(content: bytes, *, now: int = NOW_NS) -> str | None:
    return PlanRequests(NAMES, {"plan-1": planned()}).plan_of(content, now)


@pytest.mark.parametrize("rate", [10.0, 83.333, 125.0, 250.0, 1000.0])
def test_a_plans_own_trajectory_asks_for_it_at_any_rate(rate: float) -> None:
    assert judged(asking(rate)) == "plan-1"


def test_the_order_of_the_joints_and_what_is_left_out_do_not_matter() -> None:
    points = decode(TRAJECTORY, written(125.0)).points
    for point in points:
        point.positions, point.velocities = point.positions[::-1].copy(), np.empty(0)
    assert judged(asking(joint_names=list(NAMES[::-1]), points=points)) == "plan-1"


@pytest.mark.parametrize("part", ["positions", "velocities"])
def test_a_trajectory_that_was_altered_anywhere_is_refused_with_the_place(part: str) -> None:
    chance = random.Random(part)
    for _ in range(20):
        points = decode(TRAJECTORY, written(125.0)).points
        row, joint = chance.randrange(len(points)), chance.randrange(6)
        setattr(points[row], part, getattr(points[row], part) + chance.choice((-0.02, 0.02)) * np.eye(6)[joint])
        with pytest.raises(Malformed, match=rf"plan-1: joint {joint + 1} is 0\.02 rad.* off at {row / 125.0:.3f} s"):
            judged(asking(points=points))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda points: points[:-1], "it lasts"),
        (lambda points: points[::-1], "first point is at"),
        (lambda points: [points[0], points[-1]], r"points are over 0\.1 s apart"),
        (lambda points: points[:1], r"points are over 0\.1 s apart"),
        (lambda points: [*points[:9], points[8], *points[9:]], "point 9 is not later than the one before"),
        (lambda points: [points[0], *points[3:]], None),  # still the same motion
    ],
)
def test_points_that_are_not_those_of_the_plan_are_refused(change: Any, sentence: str | None) -> None:
    content = asking(rate=100.0, points=change(decode(TRAJECTORY, written(100.0)).points))
    if sentence is None:
        assert judged(content) == "plan-1"
        return
    with pytest.raises(Malformed, match=sentence):
        judged(content)


@pytest.mark.parametrize(
    ("part", "value", "sentence"),
    [
        ("positions", np.full(6, np.nan), "positions of point 7 are not finite"),
        ("positions", np.zeros(5), "point 7 has 5 positions instead of 6"),
        ("velocities", np.full(6, np.inf), "velocities of point 7 are not finite"),
        ("velocities", np.empty(0), "point 7 differs from the first in whether it has velocities"),
    ],
)
def test_points_that_are_not_whole_are_refused(part: str, value: np.ndarray, sentence: str) -> None:
    points = decode(TRAJECTORY, written(125.0)).points
    setattr(points[7], part, value)
    with pytest.raises(Malformed, match=sentence):
        judged(asking(points=points))


@pytest.mark.parametrize("names", [[], [*NAMES[:5], "joint7"], [*NAMES[:5], NAMES[0]]])
def test_a_trajectory_of_other_joints_is_refused(names: list[str]) -> None:
    with pytest.raises(Malformed, match="the arm has joint1"):
        judged(asking(joint_names=names))


def test_another_motion_a_faster_and_a_slower_one_are_refused() -> None:
    for duration in (0.5 * DURATION, 0.99 * DURATION, 1.05 * DURATION, 2.0 * DURATION):
        points = decode(TRAJECTORY, written(125.0, duration)).points
        with pytest.raises(Malformed, match="it is no plan's motion: plan-1: "):
            judged(asking(points=points))


@pytest.mark.parametrize(
    ("stamp", "sentence"),
    [
        (0, "it has no stamp"),
        (NOW_NS - 3 * SECOND, r"3\.0 s old, limit 2 s"),
        (NOW_NS + 3 * SECOND, r"3\.0 s ahead of the clock here"),
    ],
)
def test_a_stale_one_is_refused(stamp: int, sentence: str) -> None:
    with pytest.raises(Malformed, match=sentence):
        judged(asking(stamp=stamp))


def test_a_stamp_counts_once_whatever_came_of_it() -> None:
    requests = PlanRequests(NAMES, {"plan-1": planned()})
    assert requests.plan_of(asking(), NOW_NS) == "plan-1"
    for stamp in (NOW_NS, NOW_NS - 1):
        with pytest.raises(Malformed, match="it came twice"):
            requests.plan_of(asking(stamp=stamp), NOW_NS)
    with pytest.raises(Malformed, match="no plan's motion"):
        requests.plan_of(asking(stamp=NOW_NS + 2, points=decode(TRAJECTORY, written(125.0, 2.0)).points), NOW_NS)
    with pytest.raises(Malformed, match="it came twice"):
        requests.plan_of(asking(stamp=NOW_NS + 2), NOW_NS)
    assert requests.plan_of(asking(stamp=NOW_NS + 3), NOW_NS) == "plan-1"


def test_a_trajectory_without_points_asks_for_a_stop_with_any_stamp() -> None:
    assert judged(asking(points=[], stamp=0)) is None
    assert judged(asking(points=[], joint_names=[])) is None


def test_two_plans_of_one_motion_are_told_apart_by_nobody() -> None:
    requests = PlanRequests(NAMES, {"plan-1": planned(), "plan-2": planned()})
    with pytest.raises(Malformed, match="plan-1 and of plan-2: let only one of them be asked for"):
        requests.plan_of(asking(), NOW_NS)


def test_damaged_bytes_begin_no_other_motion() -> None:
    chance, content = random.Random(3), asking(10.0)
    for _ in range(300):
        damaged = bytearray(content)
        for _ in range(chance.randrange(1, 4)):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        damaged = damaged[: chance.choice((len(damaged), chance.randrange(len(damaged))))]
        try:
            plan = judged(bytes(damaged))
        except Malformed:
            continue
        if plan is not None:  # what was damaged is nothing that the motion depends on
            message = decode(TRAJECTORY, bytes(damaged))
            motion = read_trajectory(message, NAMES)
            assert np.allclose(motion.positions, moved(motion.times)[0], rtol=0, atol=1e-4)


def test_a_message_over_the_limit_is_refused_unread() -> None:
    with pytest.raises(Malformed, match=f"over the limit of {MAX_SIZE}"):
        judged(bytes(MAX_SIZE + 1))


def test_a_motion_is_written_and_read_without_a_loss() -> None:
    times = np.arange(5) * 0.008
    positions, speeds, efforts = moved(times)
    fields = trajectory_fields(JointMotion(times, positions, speeds), efforts, NAMES)
    message = decode(TRAJECTORY, encode(TRAJECTORY, header=header(0, ""), **fields))
    motion = read_trajectory(message, NAMES)
    assert motion.velocities is not None
    for is_, was in ((motion.times, times), (motion.positions, positions), (motion.velocities, speeds)):
        assert is_.tobytes() == was.tobytes()
    assert np.array([point.effort for point in message.points]).tobytes() == efforts.tobytes()


def test_execution_by_topic_wants_the_plans_that_may_be_asked_for() -> None:
    with pytest.raises(SystemExit, match="--execute needs the plans that may be asked for"):
        main(["ros2", "--router", "tcp/127.0.0.1:9", "--execute"])
