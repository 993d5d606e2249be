"""How a driver plays setpoints that come late, doubled, in bursts or not at all."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
import pytest

from teachpath_client.driver import PlayerState, SetpointPlayer
from teachpath_client.driver.interpolation import WayToRest

PERIOD, DELAY = 0.004, 0.03
START = np.zeros(6)
GOAL = np.array([0.8, -0.6, 0.9, 1.0, -1.0, 1.2])
SECONDS = 1.2
BRAKING = 0.3  # s, that the way to rest takes
NOW_NS = 1_000 * 10**9  # ns, when the first setpoint is due

Arrival = Callable[[int], float]  # of a cycle [s]


@dataclass(frozen=True, eq=False)
class Setpoint:
    """A setpoint as the wire gives it."""

    cycle: int
    nominal_ns: int
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    gripper_closed: bool = False
    execution: str = "e"
    way_to_rest: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 6)))
    output: str = ""


def path(x: float) -> np.ndarray:
    """A curve in joint space, by the share of a plan time of `SECONDS`."""
    x = min(max(x, 0.0), 1.0)
    s = 10 * x**3 - 15 * x**4 + 6 * x**5
    return s * GOAL + np.sin(np.pi * s) ** 2 * np.array([0.1, 0.05, 0.0, -0.1, 0.0, 0.1])


def motion(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The motion at full speed, and the rest before and behind it."""
    h = 1e-4
    p = [path((t + k * h) / SECONDS) for k in (-1, 0, 1)]
    still = not 0.0 < t < SECONDS
    v, a = (p[2] - p[0]) / (2 * h), (p[2] - 2 * p[1] + p[0]) / h**2
    return p[1], 0 * v if still else v, 0 * a if still else a


def way_to_rest(t: float) -> np.ndarray:
    """The motion along the same curve while its rate falls to zero, smoothly."""
    if not 0.0 < t < SECONDS:
        return np.empty((0, 3, 6))
    x = np.arange(1, round(BRAKING / PERIOD) + 1) * PERIOD / BRAKING
    ahead = BRAKING * (x - (x**6 - 3 * x**5 + 2.5 * x**4))
    rates, slopes = 1 - (10 * x**3 - 15 * x**4 + 6 * x**5), -30 * (x**2 - 2 * x**3 + x**4) / BRAKING
    states = []
    for each, rate, slope in zip(ahead, rates, slopes, strict=True):
        p, v, a = motion(t + each)
        states.append((p, v * rate, a * rate**2 + v * slope))
    return np.array(states)


def setpoint(k: int, *, start: float = 0.0, **changes: object) -> Setpoint:
    """The setpoint of a control period; `start` is the plan time [s] of the first."""
    t = start + k * PERIOD
    given = {"nominal_ns": NOW_NS + round(1e9 * k * PERIOD), "way_to_rest": way_to_rest(t)} | changes
    return Setpoint(k, given.pop("nominal_ns"), *motion(t), **given)  # type: ignore[arg-type]


STREAM = [setpoint(k) for k in range(500)]


def played(
    arrives: Arrival, left_out: Iterable[int] = (), seconds: float = 2.0, player: SetpointPlayer | None = None
) -> tuple[SetpointPlayer, np.ndarray]:
    """Play the motion; returns the player, and what it aimed at each millisecond (n, 3, 6)."""
    gone = set(left_out)
    coming = sorted((arrives(k), k) for k in range(len(STREAM)) if k not in gone)
    player = player or SetpointPlayer(START, delay=DELAY)
    log = []
    for ms in range(int(1e3 * seconds)):
        now = NOW_NS + ms * 10**6
        while coming and coming[0][0] <= ms / 1e3:
            player.add(STREAM[coming.pop(0)[1]], now)
        player.advance(0.001, now)
        log.append(np.stack([player.target.position, player.target.velocity, player.target.acceleration]))
    return player, np.array(log)


def in_time(k: int) -> float:
    return k * PERIOD


CURVE = np.array([path(x) for x in np.linspace(0.0, 1.0, 2001)])


def off_path(log: np.ndarray) -> float:
    """The largest distance of positions (n, 6) from the curve [rad], seen as chords."""
    chords = np.diff(CURVE, axis=0)
    worst = 0.0
    for each in log[::5]:
        ahead = each - CURVE[:-1]
        share = np.clip(np.einsum("ij,ij->i", ahead, chords) / np.maximum(np.sum(chords**2, axis=1), 1e-30), 0.0, 1.0)
        worst = max(worst, float(np.linalg.norm(ahead - share[:, None] * chords, axis=1).min()))
    return worst


def is_smooth(log: np.ndarray) -> bool:
    """Tell whether velocity and acceleration belong to the positions and never jump."""
    speed = np.diff(log[:, 0], axis=0) * 1e3
    change = np.abs(np.diff(speed, axis=0)) * 1e3
    ideal = np.array([np.stack(motion(t)) for t in np.arange(0.0, SECONDS, 0.001)])
    braking = 1.9 / BRAKING * np.abs(ideal[:, 1]).max(axis=0)  # the largest slope of the rate, times the speed
    fastest, hardest = np.abs(ideal[:, 1]).max(axis=0), np.abs(ideal[:, 2]).max(axis=0) + braking
    return bool(np.all(np.abs(speed) <= 1.001 * fastest) and np.all(change <= 1.02 * hardest))


def test_in_time_it_plays_the_motion_and_nothing_else() -> None:
    player, log = played(in_time)
    ideal = np.array([np.stack(motion((ms + 1) / 1e3 - DELAY)) for ms in range(len(log))])
    np.testing.assert_allclose(log[:, 0], ideal[:, 0], atol=1e-6)
    np.testing.assert_allclose(log[40:, 1], ideal[40:, 1], atol=1e-3)
    assert (player.missed, player.late, player.stops) == (0, 0, 0)
    assert not player.target.velocity.any()


def test_what_comes_late_doubled_or_is_missing_within_the_delay_changes_nothing() -> None:
    _, ideal = played(in_time)
    rng = np.random.default_rng(1)
    late = np.maximum.accumulate([k * PERIOD + rng.uniform(0.0, 0.008) for k in range(len(STREAM))])
    player, log = played(lambda k: float(late[k]), left_out=[50, 51, 120, 200, 202])
    np.testing.assert_allclose(log[:, 0], ideal[:, 0], atol=1e-5)
    assert (player.missed, player.late, player.stops) == (5, 0, 0)
    doubled = SetpointPlayer(START, delay=DELAY)
    for k in range(20):
        assert doubled.add(STREAM[k], NOW_NS)
        assert not doubled.add(STREAM[k], NOW_NS)


@pytest.mark.parametrize("pause", [0.04, 0.06, 0.1, 0.5, 1e6])
@pytest.mark.parametrize("at", [20, 60, 110, 150, 190, 225])
def test_an_arm_without_setpoints_rests_on_its_path_within_its_limits(pause: float, at: int) -> None:
    player, log = played(lambda k: k * PERIOD + (pause if k >= at else 0.0))
    assert off_path(log[:, 0]) <= 1e-5
    assert is_smooth(log)
    assert player.state is PlayerState.STOPPED
    assert player.stops == 1
    assert player.last_reached is STREAM[at - 1]
    np.testing.assert_allclose(player.target.position, STREAM[at - 1].way_to_rest[-1, 0], atol=1e-12)
    assert not player.target.velocity.any()


def test_a_burst_of_overdue_setpoints_moves_nothing_and_is_late() -> None:
    player, _ = played(lambda k: in_time(k) if k < 100 else 1.2)
    at = player.target.position
    assert player.late == len(STREAM) - 100
    assert player.stops == 1
    np.testing.assert_array_equal(player.target.position, at)


def test_it_takes_up_again_what_begins_at_rest_where_the_arm_rests_and_nothing_else() -> None:
    player, before = played(lambda k: in_time(k) if k < 100 else 1e6, seconds=1.0)
    rest = player.target.position
    now = NOW_NS + 10**9
    moving = Setpoint(600, now, rest, np.ones(6), START)
    elsewhere = Setpoint(601, now, rest + 0.003, START, START)
    assert not player.add(moving, now)
    assert not player.add(elsewhere, now)
    assert player.state is PlayerState.STOPPED
    assert player.add(Setpoint(602, now, rest, START, START), now)
    goal = rest + 0.05
    for k in range(1, 100):
        x = min(k / 60, 1.0)
        s, ds = 10 * x**3 - 15 * x**4 + 6 * x**5, (30 * x**2 - 60 * x**3 + 30 * x**4) / 60 / PERIOD
        dds = (60 * x - 180 * x**2 + 120 * x**3) / 3600 / PERIOD**2
        one = Setpoint(602 + k, now + k * 4_000_000, rest + s * 0.05, np.full(6, ds * 0.05), np.full(6, dds * 0.05))
        assert player.add(one, now)
    steps = [before[-1, 0]]
    for ms in range(600):
        player.advance(0.001, now + ms * 10**6)
        steps.append(player.target.position)
    np.testing.assert_allclose(steps[-1], goal, atol=1e-9)
    assert np.abs(np.diff(steps, axis=0)).max() <= 0.001 * 1.9 * 0.05 / (60 * PERIOD)
    assert player.state is PlayerState.PLAYING


@pytest.mark.parametrize("lost", [4, 20])
def test_a_gap_is_not_bridged_but_rested_at(lost: int) -> None:
    player, log = played(in_time, left_out=range(100, 100 + lost))
    assert player.state is PlayerState.STOPPED
    assert off_path(log[:, 0]) <= 1e-5
    assert is_smooth(log)


def test_losses_of_five_percent_stay_on_the_path() -> None:
    for seed in range(20):
        lost = np.flatnonzero(np.random.default_rng(seed).random(len(STREAM)) < 0.05)
        player, log = played(in_time, left_out=lost[lost > 0])
        assert off_path(log[:, 0]) <= 1e-5
        assert is_smooth(log)
        assert player.stops <= 1


@pytest.mark.parametrize("seed", range(5))
def test_a_way_to_rest_whose_jerk_changes_from_period_to_period_is_read_as_it_was_made(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count, fine = 30, 8
    jerks = np.repeat(rng.uniform(-100.0, 100.0, (count, 6)), fine, axis=0)
    state, rows = np.zeros((3, 6)), []
    h = PERIOD / fine
    for jerk in jerks:  # from rest, read backwards
        p, v, a = state
        rows.append(state)
        state = np.array([p + h * (v + h * (a / 2 + h * jerk / 6)), v + h * (a + h * jerk / 2), a + h * jerk])
    backwards = np.array([*rows, state])[::-1] * np.array([[1.0], [-1.0], [1.0]])
    way = WayToRest(Setpoint(0, NOW_NS, *backwards[0], way_to_rest=backwards[fine::fine]), PERIOD)
    for k, (position, velocity, _) in enumerate(backwards):
        read = way(k * h)
        np.testing.assert_allclose(read[0], position, atol=1e-10)
        np.testing.assert_allclose(read[1], velocity, atol=1e-7)


def test_a_setpoint_that_moves_without_a_way_to_rest_is_braked_straight_ahead() -> None:
    player = SetpointPlayer(START, delay=DELAY)
    bare = [setpoint(k, way_to_rest=np.empty((0, 3, 6))) for k in range(150)]
    for each in bare:
        player.add(each, NOW_NS)
    for ms in range(1000):
        player.advance(0.001, NOW_NS + ms * 10**6)
    assert player.state is PlayerState.STOPPED
    ahead = player.target.position - bare[-1].position
    assert np.all(ahead * bare[-1].velocity >= 0)
    assert np.all(np.abs(ahead) <= 0.1 * np.abs(bare[-1].velocity))


def test_who_is_behind_catches_up_at_a_standstill_without_a_jump() -> None:
    player = SetpointPlayer(START, delay=DELAY)
    log, behind = [], 0
    for ms in range(4000):
        now = NOW_NS + ms * 10**6
        if ms % 4 == 0:
            player.add(setpoint(ms // 4, gripper_closed=ms > 2900), now)
        if ms % 2:  # its machine has time for half of what is to be done
            continue
        player.advance(0.001, now)
        log.append(player.target.position)
        if player.last_reached is not None and ms == 1000:
            behind = ms // 4 - player.last_reached.cycle
    assert behind * PERIOD > 0.3  # amid the motion
    assert player.last_reached is not None
    assert (999 - player.last_reached.cycle) * PERIOD < DELAY + 3 * PERIOD
    assert player.last_reached.gripper_closed
    np.testing.assert_array_equal(log[-1], GOAL)
    assert np.abs(np.diff(log, axis=0)).max() <= 0.003


def test_another_execution_begins_from_where_the_arm_is_or_not_at_all() -> None:
    player, log = played(in_time)
    now = NOW_NS + 10 * 10**9
    far = Setpoint(0, now, GOAL + 0.1, START, START, execution="far")
    moving = Setpoint(0, now, GOAL, np.ones(6), START, execution="moving")
    assert not player.add(far, now)
    assert not player.add(moving, now)
    assert player.add(Setpoint(0, now, GOAL + 0.004, START, START, execution="next"), now)
    steps = [log[-1, 0]]
    for ms in range(200):
        player.advance(0.001, now + ms * 10**6)
        steps.append(player.target.position)
    assert np.abs(np.diff(steps, axis=0)).max() < 1e-4
    np.testing.assert_allclose(steps[-1], GOAL + 0.004, atol=1e-9)


def test_nothing_moves_before_the_first_setpoint() -> None:
    player = SetpointPlayer(GOAL, delay=DELAY)
    assert player.advance(0.001, NOW_NS) is None
    np.testing.assert_array_equal(player.target.position, GOAL)
    assert (player.state, player.execution, player.at_rest) == (PlayerState.IDLE, "", True)


def test_a_setpoint_for_another_arm_is_left_out() -> None:
    player, others = SetpointPlayer(START, delay=DELAY), np.zeros(7)
    assert not player.add(Setpoint(0, NOW_NS, others, others, others), NOW_NS)
    assert player.add(Setpoint(0, NOW_NS, START, START, START), NOW_NS)
