"""From a curve to configurations: even lengths along it, and every way the arm can hold its tool down on it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import degrees
from typing import Final

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.interpolate import CubicHermiteSpline, make_interp_spline

from teachpath.errors import PathRefused
from teachpath.motion.kinematics import BRANCHES, downward, explain_reach, inverse, least_singular_value
from teachpath.motion.puma560 import LOWER, UPPER, Array
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve

SHORTEST: Final = 0.01  # m, of a path that is worth following
FEWEST_NODES: Final = 60
FINEST: Final = 3  # times that the nodes are doubled where the curve bends sharply
STANDSTILL: Final = 1e-4  # share of the mean speed |dc/du| below which a curve has a cusp
# A joint that turns more than this between two nodes has jumped: the branch ends there.
LARGEST_STEP: Final = 0.35  # rad


class ArcLength:
    """The arc length of a curve, and its inverse, both smooth."""

    def __init__(self, curve: Curve) -> None:
        grid = np.unique(np.concatenate([np.linspace(a, b, 120) for a, b in pairwise(np.unique(curve.knots))]))
        nodes, weights = leggauss(6)
        half = np.diff(grid) / 2
        inner = (grid[:-1] + half)[:, None] + half[:, None] * nodes
        pieces = half * (np.linalg.norm(curve(inner.ravel(), 1), axis=1).reshape(inner.shape) @ weights)
        self._grid = grid
        self._lengths = np.concatenate([[0.0], np.cumsum(pieces)])
        self._speeds = np.linalg.norm(curve(grid, 1), axis=1)
        self._arc = CubicHermiteSpline(grid, self._lengths, self._speeds)
        self.total = float(self._lengths[-1])

    def standstill(self) -> float | None:
        """Return the arc length [m] where the curve has a cusp, or None."""
        still = int(np.argmin(self._speeds))
        return float(self._lengths[still]) if self._speeds[still] < STANDSTILL * self.total else None

    def lengths(self, u: Array) -> Array:
        """Return the arc lengths (m,) [m] at the curve's parameters (m,)."""
        return np.asarray(self._arc(u), dtype=np.float64)

    def parameters(self, lengths: Array) -> Array:
        """Return the curve's parameters (m,) at arc lengths (m,) [m]."""
        # Inverting by linear interpolation alone would put its kinks into the third derivative of q(s).
        slope = self._arc.derivative()
        u = np.interp(lengths, self._lengths, self._grid)
        for _ in range(3):
            u = np.clip(u - (self._arc(u) - lengths) / slope(u), 0.0, 1.0)
        return np.asarray(u, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class Route:
    """A curve sampled at even arc lengths.

    Attributes:
        curve: what was sampled.
        arc: its arc length.
        lengths: (n,) arc length of the nodes [m].
        positions: (n, 3) [m], world.
    """

    curve: Curve
    arc: ArcLength
    lengths: Array
    positions: Array

    def place(self, index: int) -> str:
        """Name a node and the control point nearest to it."""
        x, y, z = self.positions[index]
        return f"at s = {self.lengths[index]:.3f} m ({x:.3f}, {y:.3f}, {z:.3f}); {self.remedy(index)}"

    def remedy(self, index: int) -> str:
        """Name the control point nearest to a node."""
        points = self.curve.control_points
        nearest = int(np.argmin(np.linalg.norm(points - self.positions[index], axis=1)))
        return f"move control point {nearest + 1} of {len(points)}"


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way to hold the arm along a whole route.

    Attributes:
        branch: shoulder, elbow, wrist and tool roll in words.
        index: of shoulder, elbow and wrist in `BRANCHES`.
        roll: of the tool [rad].
        joints: (n, 6) continuous configurations [rad].
        excess: largest violation of a joint limit [rad], at most 0 when all hold.
        worst: (node, joint) where a joint comes nearest to a limit, or is farthest beyond.
        singular: least singular value of the Jacobian, and `singular_at` its node.
    """

    branch: str
    index: int
    roll: float
    joints: Array
    excess: float
    worst: tuple[int, int]
    singular: float
    singular_at: int
    jump: int  # node at which a joint jumps, or -1


def route(curve: Curve, settings: MotionSettings) -> Route:
    """Sample a curve at even arc lengths, as densely as its sharpest bend needs.

    Raises:
        PathRefused: it has no 3 dimensions, is too short or stands still on its way.
    """
    if curve.control_points.shape[1] != 3:
        raise PathRefused(f"a path in the world has 3 dimensions, this one has {curve.control_points.shape[1]}")
    arc = ArcLength(curve)
    if arc.total < SHORTEST:
        raise PathRefused(
            f"the path is {1000 * arc.total:.1f} mm long, the shortest followed is {1000 * SHORTEST:.0f} mm"
        )
    still = arc.standstill()
    if still is not None:
        raise PathRefused(
            f"the curve stands still at s = {still:.3f} m: control points coincide there, move them apart"
        )
    count = max(FEWEST_NODES, int(np.ceil(arc.total / settings.node_spacing)))
    found = _sampled(curve, arc, count)
    for _ in range(FINEST):
        if _spline_error(found) <= settings.path_tolerance / 10:
            break
        count *= 2
        found = _sampled(curve, arc, count)
    return found


def candidates(way: Route, settings: MotionSettings) -> list[Candidate]:
    """Find every branch and tool roll along a route, with how well each does.

    Raises:
        PathRefused: the wrist cannot get there on any branch.
    """
    found = []
    for roll in settings.rolls:
        solutions = inverse(downward(way.positions, roll))
        worst = int(np.argmax(solutions.excess[:, 0]))
        if solutions.excess[worst, 0] > 0:
            reason = explain_reach(
                float(solutions.excess[worst, 0]), bool(solutions.beyond[worst]), float(way.lengths[worst])
            )
            raise PathRefused(f"{reason}, {way.remedy(worst)} towards the middle of the table")
        for index, branch in enumerate(BRANCHES):
            name = f"{branch}, roll {degrees(roll):.0f} deg"
            found.append(_candidate(name, index, roll, solutions.joints[:, index]))
    return found


def usable(candidate: Candidate, settings: MotionSettings) -> bool:
    """Tell whether a candidate keeps the joint limits, has no jump and stays away from singular poses."""
    return candidate.excess <= 0 and candidate.jump < 0 and candidate.singular >= settings.least_singular


def explain(way: Route, candidate: Candidate, settings: MotionSettings) -> str:
    """Say why a candidate is not usable, where, and which control point to move."""
    if candidate.excess > 0:
        node, joint = candidate.worst
        angle = candidate.joints[node, joint]
        limit = UPPER[joint] if angle > UPPER[joint] else LOWER[joint]
        return (
            f"joint {joint + 1} needs {degrees(angle):.1f} deg, limit {degrees(limit):.1f}, "
            f"{way.place(candidate.worst[0])} ({candidate.branch} comes nearest)"
        )
    if candidate.jump >= 0:
        return f"the wrist would have to turn over {way.place(candidate.jump)} ({candidate.branch})"
    return (
        f"the arm is nearly singular (least singular value {candidate.singular:.3f}, limit "
        f"{settings.least_singular:g}) {way.place(candidate.singular_at)} ({candidate.branch})"
    )


def within_limits(joints: Array) -> Array:
    """Shift each joint of continuous configurations (n, 6) by whole turns, nearest to the middle of its range."""
    middle = (joints.max(axis=0) + joints.min(axis=0)) / 2
    turns = np.round(((LOWER + UPPER) / 2 - middle) / (2 * np.pi))
    return np.asarray(joints + 2 * np.pi * turns, dtype=np.float64)


def _candidate(name: str, index: int, roll: float, joints: Array) -> Candidate:
    continuous = within_limits(np.unwrap(joints, axis=0))
    over = np.maximum(continuous - UPPER, LOWER - continuous)
    node, joint = np.unravel_index(int(np.argmax(over)), over.shape)
    steps = np.abs(np.diff(continuous, axis=0)).max(axis=1)
    jump = int(np.argmax(steps)) if steps.max() > LARGEST_STEP else -1
    values = least_singular_value(continuous)
    lowest = int(np.argmin(values))
    return Candidate(
        name, index, roll, continuous, float(over.max()), (int(node), int(joint)), float(values[lowest]), lowest, jump
    )


def _sampled(curve: Curve, arc: ArcLength, count: int) -> Route:
    lengths = np.linspace(0.0, arc.total, count + 1)
    return Route(curve, arc, lengths, curve(arc.parameters(lengths)))


def _spline_error(found: Route) -> float:
    """Return how far [m] the spline through the nodes leaves the curve half way between them."""
    middle = (found.lengths[1:] + found.lengths[:-1]) / 2
    spline = make_interp_spline(found.lengths, found.positions, k=5)
    wanted = found.curve(found.arc.parameters(middle))
    return float(np.linalg.norm(spline(middle) - wanted, axis=1).max())
