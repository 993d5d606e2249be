"""The shortest stop that is possible from a state on a track, found offline: what a stop of the governor is held against.

Plan time tau(t) is made of pieces of constant third derivative. For a given duration the largest violation of a joint
limit is brought down by linear programs about the newest solution; the least duration without violation is bisected.
It is a local optimum of a finite number of pieces: an estimate of the best possible from above.
"""

import numpy as np
from scipy.optimize import linprog

from teachpath.motion.track import Track

PIECES = 30
PROGRAMS = 12  # per duration
HALVINGS = 6
KEPT = 2e-3  # violation that counts as none
FURTHEST = 0.02  # s, that tau may move in one program


def shortest_stop(track: Track, place: int, dt: float) -> float:
    """Return the duration [s] of the best stop from full speed, `place` periods of `dt` after the beginning."""
    tau, least, most = place * dt, 0.02, 0.8
    start = None
    for _ in range(HALVINGS + 1):
        middle = (least + most) / 2
        found = _stop(track, tau, middle, start)
        if found is None:
            least = middle
        else:
            most, start = middle, found * middle**2
    return most


def _stop(track: Track, tau: float, duration: float, start: np.ndarray | None) -> np.ndarray | None:
    """Return the pieces [1/s^2] of a stop within the limits; `start` are those of another duration, times it squared."""
    step = duration / PIECES
    rates, gains = _responses(step)
    t = step * np.arange(1, PIECES + 1)
    if start is None:
        jerk = np.where(np.arange(PIECES) < PIECES // 2, -4.0, 4.0) / duration**2
    else:
        jerk = start / duration**2
    for _ in range(PROGRAMS):
        matrix, values, state = _linearised(track, tau + t + gains[0] @ jerk, 1.0 + gains[1] @ jerk, gains[2] @ jerk, jerk, gains)
        answer = linprog(
            np.append(np.zeros(PIECES), 1.0),
            A_ub=np.block([
                [matrix, -np.ones((len(matrix), 1))], [-matrix, -np.ones((len(matrix), 1))],
                [gains[0], np.zeros((PIECES, 1))], [-gains[0], np.zeros((PIECES, 1))], [-gains[1], np.zeros((PIECES, 1))],
            ]),
            b_ub=np.concatenate([
                1.0 - values, 1.0 + values, np.full(2 * PIECES, FURTHEST), state,
            ]),
            A_eq=np.column_stack([rates, np.zeros(2)]), b_eq=[-1.0 - rates[0] @ jerk, -rates[1] @ jerk],
            bounds=[(None, None)] * PIECES + [(0.0, None)],
        )  # fmt: skip
        if answer.status != 0:
            return None
        jerk = jerk + answer.x[:PIECES]
        _, values, state = _linearised(track, tau + t + gains[0] @ jerk, 1.0 + gains[1] @ jerk, gains[2] @ jerk, jerk, gains)
        if np.abs(values).max() <= 1.0 + KEPT and state.min() > -1e-6:
            return jerk
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
    track: Track, tau: np.ndarray, rate: np.ndarray, slope: np.ndarray, jerk: np.ndarray, gains: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the uses of the limits at the ends of the pieces, their derivative by the pieces, and the rates."""
    row = np.clip(np.rint(tau / track.step), 0, len(track.table) - 1).astype(int)
    one, two, three = (track.table[row, k, :6] for k in (1, 2, 3))
    four = (track.table[np.minimum(row + 4, len(track.table) - 1), 3, :6] - track.table[np.maximum(row - 4, 0), 3, :6]) / (
        8 * track.step
    )
    r, a, j = rate[:, None], slope[:, None], jerk[:, None]
    d_tau, d_rate, d_slope = (gain[:, None, :] for gain in gains)
    own = np.eye(PIECES)[:, None, :]

    def by(tau_: np.ndarray, rate_: np.ndarray, slope_: np.ndarray, jerk_: np.ndarray, limit: np.ndarray) -> np.ndarray:
        total = tau_[..., None] * d_tau + rate_[..., None] * d_rate + slope_[..., None] * d_slope + jerk_[..., None] * own
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
        by(
            two * j + 3 * three * r * a + four * r**3, 3 * two * a + 3 * three * r**2, 3 * two * r, one, limits.jerk
        ),
    ]
    return np.concatenate(matrix), np.concatenate(uses), rate
