"""How fast the arm may go along a path: a quintic spline through configurations and one box of limits for its length.

With q(s) and s(t): q' = dq/ds and so on, the joints' velocity is q's', their acceleration q's'' + q''s'^2, their jerk
q's''' + 3 q''s's'' + q'''s'^3. The triangle bound turns joint limits into limits of s', s'' and s'''.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from ruckig import ControlInterface, InputParameter, Result, Ruckig, RuckigError, Trajectory
from scipy.interpolate import BSpline, make_interp_spline

from teachpath.errors import PathRefused
from teachpath.motion.puma560 import ACCELERATION, JERK, SPEED, Array

DEGREE: Final = 5
# Samples per node at which the box is computed: the bound holds between them up to the spline's own smoothness.
DENSITY: Final = 4
# The share of the limits the box uses, for what lies between the samples.
SHARE: Final = 0.995
SPEEDS: Final = 48  # candidates of the search for the fastest box
ACCELERATIONS: Final = 16

State = tuple[float, float, float]  # s, its speed, its acceleration


@dataclass(frozen=True, slots=True)
class Limits:
    """Largest velocity [m/s], acceleration [m/s^2] and jerk [m/s^3] of s; for a joint move in rad."""

    velocity: float
    acceleration: float
    jerk: float


@dataclass(frozen=True, eq=False)
class JointPath:
    """Configurations along a length: q(s), three times continuously differentiable and more.

    Attributes:
        lengths: (n,) strictly increasing, from 0.
        joints: (n, 6) configurations at the nodes [rad].
    """

    lengths: Array
    joints: Array

    @property
    def end(self) -> float:
        """Length of the whole path."""
        return float(self.lengths[-1])

    @cached_property
    def _derivatives(self) -> tuple[BSpline[np.float64], ...]:
        degree = min(DEGREE, len(self.lengths) - 1)
        spline = make_interp_spline(self.lengths, self.joints, k=degree)
        return (spline, *(spline.derivative(k) for k in range(1, min(degree, 3) + 1)))

    def __call__(self, s: Array | float, order: int = 0) -> Array:
        """Evaluate q or its derivative of `order` 0 to 3 with respect to s: (..., 6)."""
        at = np.clip(s, 0.0, self.end)
        if order >= len(self._derivatives):
            return np.zeros((*np.shape(at), self.joints.shape[1]))
        return np.asarray(self._derivatives[order](at), dtype=np.float64)

    def motion(self, s: float, speed: float, acceleration: float) -> tuple[Array, Array, Array]:
        """Return the joints' position, velocity and acceleration (6,) each, at a state of s."""
        first = self(s, 1)
        return self(s), first * speed, first * acceleration + self(s, 2) * speed**2

    def dense(self) -> Array:
        """Return lengths several times denser than the nodes."""
        grid = np.arange((len(self.lengths) - 1) * DENSITY + 1) / DENSITY
        return np.interp(grid, np.arange(len(self.lengths)), self.lengths)


def joint_move(start: Array, goal: Array) -> JointPath:
    """Return the straight line between two different configurations; its length is the largest turn [rad]."""
    return JointPath(np.array([0.0, np.abs(goal - start).max()]), np.stack([start, goal]))


def fastest_box(path: JointPath, *, share: float = 1.0) -> Limits:
    """Find the constant limits of s that bring the arm from rest to rest soonest within every joint limit.

    Args:
        path: what to follow.
        share: of the joints' speed, acceleration and jerk limits that may be used, in (0, 1].

    Raises:
        PathRefused: the path turns so sharply in the joints that no useful speed is left.
    """
    first, second, third = (np.abs(path(path.dense(), k)) for k in (1, 2, 3))
    room = share * SHARE
    speed, acceleration, jerk = room * SPEED, room * ACCELERATION, room * JERK
    steepest = np.maximum(first, 1e-9)
    fastest = min(
        _least(speed / steepest),
        _least(np.sqrt(acceleration / np.maximum(second, 1e-9))),
        _least(np.cbrt(jerk / np.maximum(third, 1e-9))),
    )
    best, shortest = None, np.inf
    for v in fastest * np.linspace(1.0 / SPEEDS, 1.0, SPEEDS):
        most = _least((acceleration - second * v**2) / steepest)
        for a in most * np.linspace(1.0 / ACCELERATIONS, 1.0, ACCELERATIONS):
            j = _least((jerk - third * v**3 - 3 * second * v * a) / steepest)
            if a <= 1e-6 or j <= 1e-6:
                continue
            box = Limits(float(v), float(a), j)
            duration = rest_to_rest(path.end, box)
            if duration < shortest:
                best, shortest = box, duration
    if best is None:
        raise PathRefused("the path turns too sharply for the joints; smooth it by moving its control points apart")
    return best


def rest_to_rest(length: float, box: Limits) -> float:
    """Return the time [s] to cover `length` from rest to rest (Biagiotti & Melchiorri 2008, section 3.4)."""
    v, a, j = box.velocity, box.acceleration, box.jerk
    a = min(a, np.sqrt(v * j))
    if length >= v * (v / a + a / j):
        return float(length / v + v / a + a / j)
    if length >= 2 * a**3 / j**2:
        return float(a / j + np.sqrt((a / j) ** 2 + 4 * length / a))
    return float(4 * np.cbrt(length / (2 * j)))


def to_position(state: State, end: float, box: Limits, speed: float) -> Trajectory | None:
    """Solve for the way from a state of s to rest at `end`, no faster than `speed`; None when there is none."""
    inputs = _inputs(state, box)
    inputs.control_interface = ControlInterface.Position
    inputs.target_position = [end]
    inputs.max_velocity = [speed]
    return _solve(inputs)


def to_speed(state: State, box: Limits, speed: float) -> Trajectory | None:
    """Solve for the soonest way from a state of s to a constant `speed`; None when there is none."""
    inputs = _inputs(state, box)
    inputs.control_interface = ControlInterface.Velocity
    inputs.target_velocity = [speed]
    return _solve(inputs)


def extremes(trajectory: Trajectory) -> tuple[float, float, float]:
    """Return the least speed, the largest speed and the largest |acceleration| of s along an answer of Ruckig."""
    profile = trajectory.profiles[0][0]
    phases = [*zip(profile.brake.t, profile.brake.j, profile.brake.a, profile.brake.v, strict=True)]
    phases += [*zip(profile.t, profile.j, profile.a, profile.v, strict=False)]
    speeds, accelerations = [], []
    for duration, jerk, acceleration, speed in phases:
        if duration <= 0.0:
            continue
        last = acceleration + jerk * duration
        speeds += [speed, speed + (acceleration + last) / 2 * duration]
        accelerations += [abs(acceleration), abs(last)]
        if acceleration * last < 0:
            speeds.append(speed - acceleration**2 / (2 * jerk))
    return min(speeds, default=0.0), max(speeds, default=0.0), max(accelerations, default=0.0)


def _solve(inputs: InputParameter) -> Trajectory | None:
    trajectory = Trajectory(1)
    try:
        result = Ruckig(1).calculate(inputs, trajectory)
    except RuckigError:
        return None
    return trajectory if result == Result.Working and np.isfinite(trajectory.duration) else None


def _inputs(state: State, box: Limits) -> InputParameter:
    inputs = InputParameter(1)
    inputs.current_position, inputs.current_velocity, inputs.current_acceleration = ([value] for value in state)
    inputs.target_velocity, inputs.target_acceleration = [0.0], [0.0]
    inputs.max_velocity, inputs.max_acceleration, inputs.max_jerk = (
        [box.velocity], [box.acceleration], [box.jerk])  # fmt: skip
    return inputs


def _least(values: Array) -> float:
    return float(np.min(values))
