import numpy as np
import pytest

from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.governor import Governor
from teachpath.motion.timing.joint_moves import straight_move
from teachpath.motion.timing.kernels import evaluate_table
from teachpath.motion.timing.limit_margins import limit_uses
from teachpath.motion.timing.ramp_checks import LIMITS_KEPT, PHASES, check_ramp, check_states
from teachpath.motion.timing.stop_search import find_stop
from teachpath.motion.timing.timed_trajectory import TimedTrajectory

ARM = Arm.of_variant()
LIMITS = ARM.limits.motion
DT = 0.004
WINDOW = np.stack([LIMITS.speed * DT, LIMITS.acceleration * DT**2, LIMITS.jerk * DT**3])  # of differences
TRIES = 4
SUBDIVISIONS = 16  # of a period, at which its motion is read


@pytest.fixture(scope="module")
def line() -> TimedTrajectory:
    return straight_move(np.zeros(6), np.array([1.5, 0, 0, 0, 0, 0]), LIMITS, arm=ARM, margins=(0.99, 0.9, 0.85))


def search(track: TimedTrajectory, tau: float, rate: float) -> np.ndarray:
    """Search for a stop from a constant rate; returns its states (n, 3)."""
    out, sent = np.empty((500, 3)), sent_at(track, tau, rate)
    count = find_stop(track.table, track.step, np.array([tau, rate, 0.0]), sent, WINDOW, DT, np.inf, TRIES, out)
    return out[:count]


def sent_at(track: TimedTrajectory, tau: float, rate: float) -> np.ndarray:
    """What was sent by an executor that came along at a constant rate (see `ramp_checks.advance`)."""
    sent = np.zeros((PHASES, 3, 6))
    for phase in range(PHASES):
        newest, one, two = track(tau - DT * rate * (np.arange(3) + 1.0 - (phase + 1) / PHASES))[:, :6]
        sent[phase] = newest, newest - one, newest - 2 * one + two
    return sent


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


@pytest.mark.parametrize("broken", [np.nan, np.inf, -np.inf])
def test_states_that_are_no_numbers_are_refused(line: TimedTrajectory, broken: float) -> None:
    tau = 0.5 * line.duration
    states, sent = search(line, tau, 1.0), sent_at(line, tau, 1.0)

    def keeps(states: np.ndarray) -> bool:
        given = (line.table, line.step, np.array([tau, 1.0, 0.0]), states, len(states), sent, WINDOW, DT)
        return bool(check_states(*given, np.empty(len(states))))

    assert keeps(states)
    for row in range(len(states)):
        bad = states.copy()
        bad[row, 0] = broken
        assert not keeps(bad)
    sound = np.array([tau, 1.0, 0.0, 0.2, 0.1, 0.2, -0.2, 0.988])
    assert check_ramp(line.table, line.step, sound, sent, WINDOW, DT)[0] == LIMITS_KEPT
    for place in range(8):
        ramp = sound.copy()
        ramp[place] = broken
        assert check_ramp(line.table, line.step, ramp, sent, WINDOW, DT)[0] != LIMITS_KEPT
    for column in range(3):
        state = np.array([tau, 1.0, 0.0])
        state[column] = broken
        out = np.empty((500, 3))
        assert find_stop(line.table, line.step, state, sent, WINDOW, DT, np.inf, TRIES, out) == 0


def test_a_table_is_read_within_its_rows_whatever_the_plan_time(line: TimedTrajectory) -> None:
    for tau, end in ((np.nan, 0), (-np.inf, 0), (-1e300, 0), (np.inf, -1), (1e300, -1)):
        joints = np.empty(7)
        evaluate_table(line.table, line.step, tau, joints)
        np.testing.assert_allclose(joints, line.table[end, 0], atol=1e-9)


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
    np.testing.assert_allclose(governor.motion[0, :6], way.states[0, 0], atol=1e-12)
    for _ in way.states[1:]:
        governor.step()
    assert governor.progress.at_rest
