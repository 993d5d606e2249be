"""Seeded demonstrations like those of the paper's two experiments, for the tests of learning."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length
from teachpath.records import Array, Trajectory

START, GOAL = np.array([0.35, 0.25, 0.05]), np.array([0.40, -0.30, 0.05])
WAY_POINTS = (
    np.array([[0.20, 0.12, 0.18], [0.18, -0.12, 0.20]]),  # left of both obstacles
    np.array([[0.38, 0.10, 0.34], [0.40, -0.12, 0.36]]),  # above them
    np.array([[0.55, 0.12, 0.16], [0.58, -0.12, 0.18]]),  # right of them
)
PERIOD = 0.02  # s


def demonstration(
    rng: np.random.Generator,
    vias: Array = WAY_POINTS[1],
    *,
    duration: float = 3.16,
    warp: float = 0.1,
    via_spread: float = 0.015,
    end_spread: float = 0.004,
    tremor: float = 0.0015,
    noise: float = 0.001,
    wiggle: float = 0.0,
    goal: Array = GOAL,
) -> Trajectory:
    """One demonstration through via points, at minimum-jerk speed; spreads, tremor and wiggle in metres."""
    count = round(duration / PERIOD) + 1
    t = np.linspace(0.0, 1.0, count)
    tau = t + rng.normal(0, warp) * np.sin(np.pi * t) ** 2 / np.pi
    s = tau**3 * (10 - 15 * tau + 6 * tau**2)
    ends = np.stack([START, goal]) + rng.normal(0, end_spread, (2, 3))
    knots = np.vstack([ends[0], vias + rng.normal(0, via_spread, vias.shape), ends[1]])
    positions = CubicSpline(np.linspace(0, 1, len(knots)), knots)(s)
    seconds = t * duration
    envelope = np.sin(np.pi * t)[:, None]
    positions = positions + _shaking(rng, seconds, tremor, 4.0, 9.0, waves=3)
    positions = positions + envelope * _shaking(rng, seconds, wiggle, 1.5, 3.0, waves=1)
    return Trajectory(seconds, positions + rng.normal(0, noise, positions.shape))


def experiment_1(seed: int, *, duration_spread: float = 0.0, **options: float) -> dict[str, Trajectory]:
    """Twelve demonstrations, three ways around two obstacles: 5, 3 and 4 of them, ids `1` to `12`."""
    rng = np.random.default_rng(seed)
    ways = (0, 1, 2, 2, 1, 0, 2, 0, 2, 0, 1, 0)  # as Table I lists them
    return {
        str(number + 1): demonstration(
            rng, WAY_POINTS[way], duration=3.16 * (1 + duration_spread * rng.uniform(-1, 1)), **options
        )
        for number, way in enumerate(ways)
    }


def experiment_2(
    seed: int, *, wiggle: float = 0.025, marked: int = 5, count: int = 5, **options: float
) -> dict[str, Trajectory]:
    """Demonstrations of one way, ids `1` to `5`; the one with number `marked` wiggles."""
    rng = np.random.default_rng(seed)
    return {
        str(number): demonstration(rng, duration=3.98, wiggle=wiggle if number == marked else 0.0, **options)
        for number in range(1, count + 1)
    }


def loop(points: int = 300, noise: float = 0.0, seed: int = 0) -> Array:
    """A path that crosses itself: (points, 3) [m]."""
    t = np.linspace(0, 1, points)
    angle = 2 * np.pi * (1.6 * t - 0.2)
    path = np.column_stack([0.5 * t, 0.1 * np.sin(angle), 0.2 + 0.1 * np.cos(angle)])
    return path + np.random.default_rng(seed).normal(0, noise, path.shape)


def curl(points: int = 300) -> Array:
    """A path with a full loop in its middle, on which it comes back towards its start: (points, 3) [m]."""
    t = np.linspace(0, 1, points)
    angle = 3 * np.pi * t
    return np.column_stack([0.4 * t + 0.12 * np.sin(angle), 0.12 * (1 - np.cos(angle)), 0.1 + 0.1 * t])


def retreat(points: int = 300) -> Array:
    """A path that turns back for a third of its length: (points, 3) [m]."""
    t = np.linspace(0, 1, points)
    along = 0.5 * t + 0.12 * np.sin(2 * np.pi * 1.5 * t)
    return np.column_stack([along, 0.08 * np.cos(3 * np.pi * t), 0.1 + 0.05 * t])


def closed(points: int = 300) -> Array:
    """A path that ends where it began: (points, 3) [m]."""
    angle = np.linspace(0, 2 * np.pi, points)
    return np.column_stack([0.2 - 0.2 * np.cos(angle), 0.15 * np.sin(angle), 0.1 + 0.03 * np.sin(2 * angle)])


def shown(path: Array, count: int, seed: int = 1) -> tuple[list[Trajectory], Array]:
    """Demonstrations along a path, each with a smooth bow, tremor and noise of its own, and the mean without those two.

    Returns:
        the trajectories, and (n, 3) [m] the mean of the clean paths at equal arc length.
    """
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 1.0, len(path))
    bows = np.sin(np.pi * np.outer(t, [1, 2]))
    clean = [path + bows @ rng.normal(0, 0.01, (2, 3)) for _ in range(count)]
    speed = t + 0.1 * np.sin(2 * np.pi * t) / np.pi
    seconds = np.arange(len(path)) * PERIOD
    trajectories = []
    for course in clean:
        walked = np.column_stack([np.interp(speed, t, course[:, k]) for k in range(3)])
        shaken = walked + _shaking(rng, seconds, 0.0015, 4.0, 9.0, waves=3) + rng.normal(0, 0.001, course.shape)
        trajectories.append(Trajectory(seconds, shaken))
    return trajectories, np.mean([at_equal_arc_length(course, 300) for course in clean], axis=0)


def turning(demonstrations: dict[str, Trajectory], noise: float = 0.01, seed: int = 1) -> dict[str, Trajectory]:
    """The same demonstrations with orientations: a turn by 2.5 rad, noise in rad, signs at random."""
    rng = np.random.default_rng(seed)
    turned = {}
    for name, d in demonstrations.items():
        share = arc_lengths(d.positions)
        angle = 2.5 * share / share[-1]
        axis = np.array([0.6, 0.0, 0.8])
        quaternions = np.column_stack([np.cos(angle / 2), np.sin(angle / 2)[:, None] * axis])
        quaternions += rng.normal(0, noise / 2, quaternions.shape)
        quaternions *= rng.choice([-1.0, 1.0], (len(d), 1)) / np.linalg.norm(quaternions, axis=1, keepdims=True)
        turned[name] = Trajectory(d.times, d.positions, quaternions)
    return turned


def moved(demonstrations: dict[str, Trajectory], rotation: Array, offset: Array) -> dict[str, Trajectory]:
    """The same demonstrations in another frame."""
    return {k: Trajectory(d.times, d.positions @ rotation.T + offset) for k, d in demonstrations.items()}


def _shaking(
    rng: np.random.Generator, seconds: Array, amplitude: float, low: float, high: float, *, waves: int
) -> Array:
    """Sines of random frequency [Hz] and phase on every axis, together as strong as one of this amplitude."""
    frequencies = rng.uniform(low, high, (waves, 3))
    phases = rng.uniform(0, 2 * np.pi, (waves, 3))
    sines = np.sin(2 * np.pi * frequencies * seconds[:, None, None] + phases)
    return amplitude / np.sqrt(waves) * sines.sum(axis=1)
