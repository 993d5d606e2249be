"""The path of the tool: a curve sampled at even arc lengths, with the tool's poses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.interpolate import BSpline, CubicHermiteSpline, make_interp_spline

from teachpath.errors import PathRefused
from teachpath.lengths import describe_lengths
from teachpath.motion.arm.kinematics import downward_poses
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.settings import MotionSettings
from teachpath.nurbs import Curve, unit_quaternions

MIN_PATH_LENGTH: Final = 0.01  # m, of a path that is followed
MIN_NODES: Final = 60
MAX_REFINEMENTS: Final = 3  # doublings of the number of nodes for a curve that bends sharply
CUSP_SPEED_SHARE: Final = 1e-4  # share of the mean speed |dc/du| below which a curve has a cusp


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
        self.total: float = float(self._lengths[-1])

    def cusp(self) -> float | None:
        """Return the arc length [m] where the curve has a cusp; None where it has none."""
        still = int(np.argmin(self._speeds))
        return float(self._lengths[still]) if self._speeds[still] < CUSP_SPEED_SHARE * self.total else None

    def lengths(self, u: Array) -> Array:
        """Return the arc lengths (m,) [m] at the curve's parameters (m,)."""
        return np.asarray(self._arc(u), dtype=np.float64)

    def parameters(self, lengths: Array) -> Array:
        """Return the curve's parameters (m,) at arc lengths (m,) [m]."""
        # The kinks of a linear interpolation alone would appear in the third derivative of q(s).
        slope = self._arc.derivative()
        u = np.interp(lengths, self._lengths, self._grid)
        for _ in range(3):
            u = np.clip(u - (self._arc(u) - lengths) / slope(u), 0.0, 1.0)
        return np.asarray(u, dtype=np.float64)


@dataclass(frozen=True, eq=False)
class ToolPath:
    """A curve sampled at even arc lengths.

    Attributes:
        curve: that was sampled.
        orientation: quaternions of what is carried, at the same parameter; None where the tool always points down.
        arc: the curve's arc length.
        lengths: (n,) arc length of the nodes [m].
        parameters: (n,) of the curve at the nodes.
        positions: (n, 3) [m], world.
        posture: (n, joints) at the nodes that a plan prefers [rad]; None: any.
        tool_offset: by which the tool stays behind the curve, along its own z [m].
    """

    curve: Curve
    orientation: Curve | None
    arc: ArcLength
    lengths: Array
    parameters: Array
    positions: Array
    posture: Array | None = None
    tool_offset: float = 0.0

    @staticmethod
    def at_even_lengths(curve: Curve, orientation: Curve | None, arc: ArcLength, count: int) -> ToolPath:
        """Sample a curve at `count` + 1 nodes."""
        lengths = np.linspace(0.0, arc.total, count + 1)
        parameters = arc.parameters(lengths)
        return ToolPath(curve, orientation, arc, lengths, parameters, curve(parameters))

    def preferring(self, posture: Array) -> ToolPath:
        """Return the same path with the joints (n, joints) at its nodes that a plan prefers [rad]."""
        return replace(self, posture=posture)

    def poses(self, u: Array) -> Array:
        """Return the tool's poses (m, 4, 4) to world at parameters (m,), without any roll about its own axis.

        At the start, the tool points down and its fingers close along y. From there it turns by the same rotation as
        what is carried.
        """
        poses = downward_poses(self.curve(u), 0.0)
        if self.orientation is not None:
            turned = rotation_matrices(unit_quaternions(self.orientation, u))
            start = rotation_matrices(unit_quaternions(self.orientation, np.zeros(1)))[0]
            poses[:, :3, :3] = turned @ start.T @ poses[:, :3, :3]
        poses[:, :3, 3] -= self.tool_offset * poses[:, :3, 2]
        return poses

    def describe_node(self, index: int) -> str:
        """Describe where a node lies: arc length and position."""
        x, y, z = self.positions[index]
        return f"at s = {self.lengths[index]:.3f} m ({x:.3f}, {y:.3f}, {z:.3f})"

    def describe_control_point(self, s: float) -> str:
        """Name the control point with most influence on the path at arc length `s` [m]."""
        shares = control_point_weights(self.curve, float(self.arc.parameters(np.array([s]))[0]))
        return f"control point {int(np.argmax(shares)) + 1} of {len(shares)}"


def sample_tool_path(
    curve: Curve, settings: MotionSettings, *, orientation: Curve | None = None, tool_offset: float = 0.0
) -> ToolPath:
    """Sample a curve at even arc lengths, as densely as its sharpest bend requires.

    Args:
        curve: positions [m].
        settings: spacing of the nodes, and tolerance.
        orientation: quaternions of what is carried, at the same parameter; used where the settings ask for it.
        tool_offset: by which the tool stays behind the curve, along its own z [m].

    Raises:
        PathRefused: the curve is not in 3 dimensions, is too short, or has a cusp.
    """
    arc = arc_length(curve)
    orientation = orientation if settings.orientation == "demonstrated" else None
    count = max(MIN_NODES, int(np.ceil(arc.total / settings.node_spacing)))
    found = ToolPath.at_even_lengths(curve, orientation, arc, count)
    for _ in range(MAX_REFINEMENTS):
        if _spline_error(found) <= settings.path_tolerance / 10:
            break
        count *= 2
        found = ToolPath.at_even_lengths(curve, orientation, arc, count)
    return replace(found, tool_offset=tool_offset)


def control_point_weights(curve: Curve, u: float) -> Array:
    """Return the weight (n,) with which each control point enters the curve's point at parameter `u`.

    Piegl & Tiller, The NURBS Book, eq. (4.2).
    """
    row = BSpline.design_matrix(np.array([min(max(u, 0.0), 1.0)]), curve.knots, curve.degree).toarray()[0]
    return np.asarray(row * curve.weights / (row @ curve.weights), dtype=np.float64)


def arc_length(curve: Curve) -> ArcLength:
    """Return the arc length of a curve that an arm can follow.

    Raises:
        PathRefused: it is not in 3 dimensions, is too short, or has a cusp.
    """
    if curve.control_points.shape[1] != 3:
        raise PathRefused(f"a path in the world has 3 dimensions, this one has {curve.control_points.shape[1]}")
    arc = ArcLength(curve)
    if arc.total < MIN_PATH_LENGTH:
        length, shortest = describe_lengths(arc.total, MIN_PATH_LENGTH)
        raise PathRefused(f"the path is {length} long, the shortest followed is {shortest}")
    still = arc.cusp()
    if still is not None:
        raise PathRefused(
            f"the curve stands still at s = {still:.3f} m: control points coincide there, move them apart"
        )
    return arc


def _spline_error(found: ToolPath) -> float:
    """Return the largest distance [m] of curve and spline through the nodes, halfway between nodes."""
    middle = (found.lengths[1:] + found.lengths[:-1]) / 2
    spline = make_interp_spline(found.lengths, found.positions, k=5)
    wanted = found.curve(found.arc.parameters(middle))
    return float(np.linalg.norm(spline(middle) - wanted, axis=1).max())
