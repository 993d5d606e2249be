import numpy as np
import pytest

from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.governor import Governor
from teachpath.motion.timing.joint_moves import straight_move
from teachpath.motion.timing.limit_margins import limit_uses
from teachpath.motion.timing.stop_search import find_stop
from teachpath.motion.timing.timed_trajectory import TimedTrajectory

ARM = Arm.of_variant()
LIMITS = ARM.limits.motion
DT = 0.004
TRIES = 4
SUBDIVISIONS = 4  # of a period, at which its motion is read


@pytest.fixture(scope="module")
def line() -> TimedTrajectory:
    return straight_move(np.zeros(6), np.array([1.5, 0, 0, 0, 0, 0]), LIMITS, arm=ARM, margins=(0.99, 0.9, 0.85))


def search(track: TimedTrajectory, tau: float, rate: float) -> np.ndarray:
    """Search for a stop from a constant rate; returns its states (n, 3)."""
    limits = np.stack([LIMITS.speed * DT, LIMITS.acceleration * DT**2, LIMITS.jerk * DT**3])
    sent, scale = np.zeros((6, 6)), DT * rate
    before = track(tau - scale * np.arange(3))[:, :6]
    midway = track(tau - scale * (np.arange(3) + 0.5))[:, :6]
    sent[0], sent[1], sent[2] = before[0], before[0] - before[1], before[0] - 2 * before[1] + before[2]
    sent[3], sent[4], sent[5] = midway[0], midway[0] - midway[1], midway[0] - 2 * midway[1] + midway[2]
    out = np.empty((500, 3))
    count = find_stop(track.table, track.step, np.array([tau, rate, 0.0]), sent, limits, DT, np.inf, TRIES, out)
    return out[:count]


def read(track: TimedTrajectory, tau: float, rate: float, states: np.ndarray) -> np.ndarray:
    """Read a stop and some of the motion before it at a fraction of its period, as joints (n, 6)."""
    begins = np.vstack([[tau, rate, 0.0], states])
    shares = np.arange(SUBDIVISIONS)[:, None] / SUBDIVISIONS
    (p0, v0, _), (p1, v1, _) = begins[:-1].T, begins[1:].T
    x2, x3 = shares**2, shares**3
    cubic = (2 * x3 - 3 * x2 + 1) * p0 + (3 * x2 - 2 * x3) * p1
    cubic = cubic + DT * ((x3 - 2 * x2 + shares) * v0 + (x3 - x2) * v1)
    taus = np.concatenate(
        [
            tau + rate * DT / SUBDIVISIONS * np.arange(-4 * SUBDIVISIONS, 0),
            cubic.T.ravel(),
            np.full(5 * SUBDIVISIONS, states[-1, 0]),
        ]
    )
    return track(taus)[:, :6]


@pytest.mark.parametrize("rate", [1.0, -0.9, 0.5])
@pytest.mark.parametrize("place", [0.35, 0.5, 0.65])
def test_a_stop_keeps_the_limits_at_whatever_moment_it_is_read(
    line: TimedTrajectory, place: float, rate: float
) -> None:
    tau = place * line.duration
    states = search(line, tau, rate)
    assert len(states)
    np.testing.assert_array_equal(states[-1, 1:], 0.0)
    joints = read(line, tau, rate, states)
    for phase in range(SUBDIVISIONS):
        for use in limit_uses(joints[phase::SUBDIVISIONS], LIMITS, 1 / DT):
            assert use.max() <= 1.0


@pytest.mark.parametrize("rate", [1.0, -0.9, 0.6])
def test_on_a_line_a_stop_takes_hardly_longer_than_its_closed_form(line: TimedTrajectory, rate: float) -> None:
    tau = 0.5 * line.duration
    row = round(tau / line.step)
    speed = float(np.abs(line.table[row, 1, 0] * rate))
    a, j = LIMITS.acceleration[0], LIMITS.jerk[0]
    shortest = speed / a + a / j if speed > a**2 / j else 2 * np.sqrt(speed / j)
    assert shortest <= DT * len(search(line, tau, rate)) <= 1.03 * shortest + 2 * DT


def test_where_the_trajectory_ends_before_a_stop_could_none_is_found(line: TimedTrajectory) -> None:
    assert len(search(line, line.duration - 0.05, 1.0)) == 0


def test_a_stop_never_turns_back(line: TimedTrajectory) -> None:
    for place in np.linspace(0.3, 0.7, 9):
        states = search(line, place * line.duration, 1.0)
        assert np.all(np.diff(states[:, 0]) >= 0.0)
        assert np.all(states[:, 1] >= 0.0)


def test_a_hold_takes_no_longer_than_the_way_to_rest_that_was_told(line: TimedTrajectory) -> None:
    governor = Governor(line, DT)
    for _ in range(int(0.5 * line.duration / DT)):
        governor.step()
    way = governor.way_to_rest()
    governor.hold()
    governor.step()
    np.testing.assert_allclose(governor.motion[0, :6], way.positions[0], atol=1e-12)
    for _ in way.positions[1:]:
        governor.step()
    assert governor.progress.at_rest
