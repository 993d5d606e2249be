"""How setpoints are played when they come late, not at all, or after a pause of their sender."""

from collections.abc import Callable, Iterable

import numpy as np
import pytest

from teachpath.motion.arm.puma560 import ACCELERATION, SPEED
from teachpath.records import Setpoint
from teachpath.simulator.setpoint_player import SetpointPlayer

PERIOD, DELAY, SILENCE = 0.004, 0.03, 0.02
START = np.zeros(6)
GOAL = np.array([0.8, -0.6, 0.9, 1.0, -1.0, 1.2])
SECONDS = 1.2

Arrival = Callable[[int], float]  # of a cycle [s]


def wanted_at(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A quintic move from rest to rest, and the rest behind it."""
    x = min(max(t / SECONDS, 0.0), 1.0)
    s, ds = 10 * x**3 - 15 * x**4 + 6 * x**5, (30 * x**2 - 60 * x**3 + 30 * x**4) / SECONDS
    dds = (60 * x - 180 * x**2 + 120 * x**3) / SECONDS**2
    return s * GOAL, ds * GOAL, dds * GOAL


def played(arrives: Arrival, left_out: Iterable[int] = (), seconds: float = 2.0) -> tuple[SetpointPlayer, np.ndarray]:
    """Play the move; returns the player, and what was wanted each millisecond (n, 3, 6)."""
    gone = set(left_out)
    coming = sorted((arrives(k), k) for k in range(int(seconds / PERIOD)) if k not in gone)
    player = SetpointPlayer(START, delay=DELAY, silence=SILENCE)
    log = []
    for ms in range(int(1e3 * seconds)):
        while coming and coming[0][0] <= ms / 1e3:
            k = coming.pop(0)[1]
            nominal = round(1e9 * (1000 + k * PERIOD))
            p, v, a = wanted_at(k * PERIOD)
            player.add(Setpoint(k, nominal, nominal, p, v, a, False, "e"), round(1e9 * (1000 + ms / 1e3)))
        player.advance(0.001, round(1e9 * (1000 + ms / 1e3)))
        log.append(np.stack([player.target.position, player.target.velocity, player.target.acceleration]))
    return player, np.array(log)


def in_time(k: int) -> float:
    return k * PERIOD


def test_in_time_it_plays_the_motion_and_nothing_else() -> None:
    player, log = played(in_time)
    ideal = np.array([np.stack(wanted_at((ms + 1) / 1e3 - DELAY)) for ms in range(len(log))])
    np.testing.assert_allclose(log[40:, 0], ideal[40:, 0], atol=1e-6)
    np.testing.assert_allclose(log[40:, 1], ideal[40:, 1], atol=1e-3)
    assert (player.missed, player.late) == (0, 0)


def test_what_comes_late_or_is_missing_within_the_delay_changes_nothing() -> None:
    _, ideal = played(in_time)
    rng = np.random.default_rng(1)
    late = np.maximum.accumulate([k * PERIOD + rng.uniform(0.0, 0.008) for k in range(600)])
    player, log = played(lambda k: float(late[k]), left_out=[50, 51, 120, 200, 202])
    np.testing.assert_allclose(log[:, 0], ideal[:, 0], atol=1e-5)
    assert (player.missed, player.late) == (5, 0)


@pytest.mark.parametrize("pause", [0.02, 0.05, 0.2, 0.6])
@pytest.mark.parametrize("at", [60, 150, 240])
def test_a_pause_of_the_sender_slows_the_arm_within_its_limits_and_moves_it_on(pause: float, at: int) -> None:
    player, log = played(lambda k: k * PERIOD + (pause if k >= at else 0.0), seconds=2.4)
    speed = np.diff(log[:, 0], axis=0) * 1e3
    assert np.all(np.abs(speed) <= SPEED)
    assert np.all(np.abs(np.diff(speed, axis=0)) * 1e3 <= ACCELERATION)
    np.testing.assert_allclose(log[-1, 0], GOAL, atol=1e-9)
    np.testing.assert_allclose(log[-1, 1:], 0.0, atol=1e-9)
    assert player.missed == 0


def test_a_sender_that_is_gone_leaves_an_arm_that_brakes_and_says_that_it_holds() -> None:
    player, log = played(lambda k: k * PERIOD + (1e6 if k >= 150 else 0.0))
    assert player.holding
    assert player.overdue == pytest.approx((2.0 - 150 * PERIOD) / PERIOD, abs=10)
    speed = np.diff(log[:, 0], axis=0) * 1e3
    assert np.all(np.abs(np.diff(speed, axis=0)) * 1e3 <= ACCELERATION)
    np.testing.assert_allclose(log[-1, 1], 0.0, atol=1e-9)
    begin, end = wanted_at(150 * PERIOD)[0], log[-1, 0]
    assert np.all(np.abs(end - begin) <= SPEED * 0.12)  # as far as braking takes


def test_who_is_behind_catches_up_at_a_standstill_without_a_jump() -> None:
    player = SetpointPlayer(START, delay=DELAY, silence=SILENCE)
    log, reached = [], 0
    for ms in range(4000):
        if ms % 4 == 0:
            k = ms // 4
            p, v, a = wanted_at(k * PERIOD)
            player.add(Setpoint(k, round(1e9 * k * PERIOD), 0, p, v, a, k * PERIOD > 2.9, "e"), round(1e6 * ms))
        if ms % 2:  # its machine has time for half of what is to be done
            continue
        player.advance(0.001, round(1e6 * ms))
        wanted = player.target
        log.append(np.stack([wanted.position, wanted.velocity, wanted.acceleration]))
        if player.last_reached is not None and ms == 2000:
            reached = ms // 4 - player.last_reached.cycle
    played = np.array(log)
    assert reached * PERIOD > 0.5  # amid the motion
    assert player.last_reached is not None
    assert (999 - player.last_reached.cycle) * PERIOD < DELAY + 3 * PERIOD
    assert player.last_reached.gripper_closed
    np.testing.assert_array_equal(played[-1, 0], GOAL)
    assert np.all(np.abs(np.diff(played[:, 0], axis=0)) <= 0.001 * SPEED)
    assert np.all(np.abs(played[:, 2]) <= ACCELERATION)


def test_a_player_that_computes_in_bursts_is_never_ahead_of_its_setpoints() -> None:
    player = SetpointPlayer(START, delay=DELAY, silence=SILENCE)
    for burst in range(40):  # a rest of a second, the move, a rest: each 0.1 s of it heard, then played
        for k in range(25 * burst, 25 * burst + 25):
            p, v, a = wanted_at(k * PERIOD - 1.0)
            player.add(Setpoint(k, round(1e9 * k * PERIOD), 0, p, v, a, False, "e"), round(1e8 * burst))
        for ms in range(100 * burst, 100 * burst + 100):
            player.advance(0.001, round(1e6 * ms))
            np.testing.assert_allclose(player.target.position, wanted_at(ms / 1e3 + 0.001 - DELAY - 1.0)[0], atol=1e-6)
    assert player.late == 0


def test_another_execution_begins_from_where_the_arm_is() -> None:
    player, log = played(in_time)
    now = round(1e9 * 1010)
    player.add(Setpoint(0, now, now, GOAL + 0.004, START, START, False, "next"), now)
    steps = []
    for ms in range(200):
        player.advance(0.001, now + round(1e6 * ms))
        steps.append(player.target.position)
    assert np.abs(np.diff([log[-1, 0], *steps], axis=0)).max() < 1e-4
    np.testing.assert_allclose(steps[-1], GOAL + 0.004, atol=1e-9)
