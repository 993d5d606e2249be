"""The shortest stop possible from a state on a track, found offline: what a stop of the governor is held against.

Plan time tau(t) is made of pieces of constant third derivative, at first those of the governor's own stop. The duration
is shortened as long as linear programs about the newest solution bring the largest violation of a joint limit down to
none. It is a local optimum of a finite number of pieces: an estimate of the best possible from above.
"""

import numpy as np
from scipy.optimize import linprog

from teachpath.motion.timing.timed_trajectory import TimedTrajectory

PIECES = 30
PROGRAMS = 10  # per duration
SHORTER_DURATIONS = (0.8, 0.9, 0.95, 0.98, 0.99, 0.995)  # factors of the duration that are tried, the most daring first
KEPT_GAIN = 5e-3  # violation that counts as none
MAX_SHIFT = 0.01  # s, that tau may move in one program


def shortest_stop(track: TimedTrajectory, tau: float, rates: list[float], dt: float) -> float:
    """Return the duration [s] of the best stop from full speed.

    Args:
        track: at full speed.
        tau: plan time at which the stop begins [s].
        rates: of plan time after each period of the governor's stop, down to zero.
        dt: control period [s].
    """
    duration = dt * len(rates)
    step = duration / PIECES
    ends = np.interp(step * np.arange(1, PIECES + 1), dt * np.arange(len(rates) + 1), [1.0, *rates])
    pieces = np.linalg.lstsq(_responses(step)[1][1], ends - 1.0, rcond=1e-3)[0] * duration**2
    for factor in SHORTER_DURATIONS:
        while (found := _stop(track, tau, factor * duration, pieces)) is not None:
            duration, pieces = factor * duration, found
    return duration


def _stop(track: TimedTrajectory, tau: float, duration: float, start: np.ndarray) -> np.ndarray | None:
    """Return the pieces of a stop within the limits, times its duration squared, or None; `start`: of another stop."""
    step = duration / PIECES
    final, gains = _responses(step)
    t = step * np.arange(1, PIECES + 1)
    pieces = start / duration**2
    # It must end at rest: the smallest change that brings it there.
    pieces = pieces + np.linalg.lstsq(final, np.array([-1.0, 0.0]) - final @ pieces, rcond=None)[0]
    slopes = np.full(PIECES, 4.0 / duration)
    for _ in range(PROGRAMS):
        state = tau + t + gains[0] @ pieces, 1.0 + gains[1] @ pieces, gains[2] @ pieces
        matrix, values = _linearised(track, *state, pieces, gains)
        if np.abs(values).max() <= 1.0 + KEPT_GAIN and state[1].min() > -1e-6:
            return pieces * duration**2
        answer = linprog(
            np.append(np.zeros(PIECES), 1.0),
            A_ub=np.block([
                [matrix, -np.ones((len(matrix), 1))], [-matrix, -np.ones((len(matrix), 1))],
                [np.concatenate([gains[0], -gains[0], -gains[1], gains[2], -gains[2]]), np.zeros((5 * PIECES, 1))],
            ]),
            b_ub=np.concatenate([1 - values, 1 + values, np.full(2 * PIECES, MAX_SHIFT), state[1], slopes, slopes]),
            A_eq=np.column_stack([final, np.zeros(2)]), b_eq=np.zeros(2),
            bounds=[(None, None)] * PIECES + [(0.0, None)],
        )  # fmt: skip
        if answer.status != 0:
            return None
        pieces = pieces + answer.x[:PIECES]
    return None


def _responses(step: float) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return what each piece adds to the final rate and its slope, and to tau, rate and slope at the end of each."""
    k, i = np.meshgrid(np.arange(PIECES), np.arange(1, PIECES + 1))
    left = np.maximum(step * (i - k - 1), 0.0)  # s, from the end of piece k to time i
    on = i > k
    slope = on * step
    rate = on * (step**2 / 2 + step * left)
    tau = on * (step**3 / 6 + step**2 / 2 * left + step * left**2 / 2)
    return np.stack([rate[-1], slope[-1]]), [tau, rate, slope]


def _linearised(
    track: TimedTrajectory,
    tau: np.ndarray,
    rate: np.ndarray,
    slope: np.ndarray,
    jerk: np.ndarray,
    gains: list[np.ndarray],
) -> tuple[np.ndarray, np.ndarray]:
    """Return how the uses of the limits at the ends of the pieces change with the pieces, and these uses."""
    row = np.clip(np.rint(tau / track.step), 0, len(track.table) - 1).astype(int)
    one, two, three = (track.table[row, k, :6] for k in (1, 2, 3))
    four = (
        track.table[np.minimum(row + 4, len(track.table) - 1), 3, :6] - track.table[np.maximum(row - 4, 0), 3, :6]
    ) / (8 * track.step)
    r, a, j = rate[:, None], slope[:, None], jerk[:, None]
    d_tau, d_rate, d_slope = (gain[:, None, :] for gain in gains)
    own = np.eye(PIECES)[:, None, :]

    def by(tau_: np.ndarray, rate_: np.ndarray, slope_: np.ndarray, jerk_: np.ndarray, limit: np.ndarray) -> np.ndarray:
        total = (
            tau_[..., None] * d_tau + rate_[..., None] * d_rate + slope_[..., None] * d_slope + jerk_[..., None] * own
        )
        return (total / limit[:, None]).reshape(-1, PIECES)

    limits, none = track.limits, 0.0 * one
    uses = [
        (one * r / limits.speed).ravel(),
        ((one * a + two * r**2) / limits.acceleration).ravel(),
        ((one * j + 3 * two * r * a + three * r**3) / limits.jerk).ravel(),
    ]
    matrix = [
        by(two * r, one, none, none, limits.speed),
        by(two * a + three * r**2, 2 * two * r, one, none, limits.acceleration),
        by(two * j + 3 * three * r * a + four * r**3, 3 * two * a + 3 * three * r**2, 3 * two * r, one, limits.jerk),
    ]
    return np.concatenate(matrix), np.concatenate(uses)
