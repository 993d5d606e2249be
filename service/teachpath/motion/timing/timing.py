"""Finds the fastest motion of a candidate along its tool path that all joint limits allow.

First, a guess tells when each point of the curve is reached. The joints become a spline over this guess, which is
smooth because its parameter is nearly time. Then `jerk_limited_topp` finds the rate of the parameter. Last, time is
stretched by a factor that is measured on setpoints, because between samples the joints' jerk has narrow peaks at the
curve's knots.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.ndimage import uniform_filter1d

from teachpath.errors import PathRefused
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.tool_speed import squared_rate_ceiling
from teachpath.motion.paths.ik_branches import Candidate, configurations
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.timing.jerk_limited_topp import minimize_duration
from teachpath.motion.timing.limit_margins import Margins
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.motion.timing.velocity_profile import max_squared_rates, reach_times
from teachpath.nurbs import Curve

GUESS_LIMIT_SHARES: Final = (0.98, 0.90)  # of speed and acceleration limits, which the guess uses
MIN_GUESS_SAMPLES: Final = 400  # of the curve
GUESS_SAMPLES_PER_SPAN: Final = 24  # between two knots, at least
ESTIMATE_SAMPLES: Final = 150  # of the curve, in the estimate of a duration
GUESS_EXTRA_TIME: Final = 0.1  # s, that jerk limits add to the guess, which has none
FILTER_WINDOW: Final = 0.05  # s, of the filter that smooths jumps of acceleration in the guess
GUESS_KNOT_SPACING: Final = 0.05  # s, between two knots of the smoothed guess
MIN_GUESS_INTERVALS: Final = 24  # of the smoothed guess
MAX_GUESS_INTERVALS: Final = 80
RATE_INTERVALS: Final = 10  # of the squared rates, for each interval of the guess
KINKED_RATE_INTERVALS: Final = (
    16  # the same for a curve with kinks of acceleration, which the squared rates must follow
)
SMOOTH_DERIVATIVES: Final = 3  # continuous derivatives of a curve without such kinks
MIN_SPLINE_NODES: Final = 400  # of the joints' spline
SETPOINT_PHASES: Final = (0.0, 0.25, 0.5, 0.75)  # of the first setpoint, in control periods
CHECKED_OVERRIDES: Final = (0.1, 0.3, 0.5, 0.7, 0.9)  # besides full speed
MAX_TIME_SCALINGS: Final = 4  # of time
STRETCH_TOLERANCE: Final = 1e-3  # of the stretch factor; a smaller change is not repeated


def time_tool_path(
    tool_path: ToolPath, candidate: Candidate, limits: MotionLimits, *, rate: float, margins: Margins | None = None
) -> tuple[JointPath, Array]:
    """Find the fastest motion along a tool path.

    Args:
        tool_path: what the tool follows.
        candidate: the branch and roll of the tool.
        limits: to keep, also while the rate changes.
        rate: setpoints a second on which the limits are measured [Hz].
        margins: shares of the limits that the motion may use; the default when None.

    Returns:
        The joints by a parameter from 0 to 1, and the coefficients of its pace (see `timed_trajectory`).

    Raises:
        PathRefused: no motion was found that keeps the limits.
    """
    warp, margins = _guess(tool_path, candidate, limits), margins or Margins()
    intervals = (RATE_INTERVALS if _smoothness(tool_path.curve) >= SMOOTH_DERIVATIVES else KINKED_RATE_INTERVALS) * (
        len(warp.c) - warp.k
    )
    sigma = np.linspace(0.0, 1.0, max(MIN_SPLINE_NODES, intervals) + 1)
    u = np.asarray(warp(sigma), dtype=np.float64)
    path = JointPath(sigma, tool_path.arc.lengths(u), configurations(tool_path, candidate, u))
    arm = candidate.branch.arm
    squared_rates = minimize_duration(path, limits, intervals, margins, arm=arm)
    for _ in range(MAX_TIME_SCALINGS):
        factor = _time_stretch(time_joint_path(path, squared_rates, limits), rate, margins, arm)
        squared_rates = squared_rates / factor**2
        if abs(factor - 1.0) < STRETCH_TOLERANCE:
            break
    if not np.all(np.isfinite(squared_rates)):
        raise PathRefused("the path turns too sharply for the joints; smooth it by moving its control points apart")
    return path, squared_rates


def duration_lower_bound(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits) -> float:
    """Return the shortest duration [s] that limits of speed and acceleration alone allow: no jerk limit, no margins."""
    u = _guess_samples(tool_path, 4 * MIN_GUESS_SAMPLES)
    spline = make_interp_spline(u, configurations(tool_path, candidate, u), k=5)
    free = squared_rate_ceiling(spline(u), spline(u, 1), limits.tool_speed, candidate.branch.arm)
    return float(
        reach_times(u, max_squared_rates(u, spline(u, 1), spline(u, 2), limits.speed, limits.acceleration, free))[-1]
    )


def estimate_duration(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits) -> float:
    """Estimate quickly how long the fastest motion takes [s]; `time_tool_path` computes it."""
    return float(_profile(tool_path, candidate, limits, ESTIMATE_SAMPLES)[1][-1] + GUESS_EXTRA_TIME)


def _smoothness(curve: Curve) -> int:
    """Return the number of continuous derivatives of a curve."""
    inner = curve.knots[curve.degree + 1 : -curve.degree - 1]
    return curve.degree - int(np.unique(inner, return_counts=True)[1].max(initial=0))


def _guess(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits) -> BSpline[np.float64]:
    """Return the curve's parameter over a parameter from 0 to 1, nearly time; at both ends it grows with the cube."""
    u, reached = _profile(tool_path, candidate, limits, MIN_GUESS_SAMPLES)
    duration = reached[-1] + GUESS_EXTRA_TIME
    instants = np.linspace(
        0.0,
        duration,
        50 * min(max(MIN_GUESS_INTERVALS, int(np.ceil(duration / GUESS_KNOT_SPACING))), MAX_GUESS_INTERVALS) + 1,
    )
    smooth = np.interp(instants - GUESS_EXTRA_TIME / 2, reached, u)
    width = max(1, round(FILTER_WINDOW / (instants[1] - instants[0])))
    for _ in range(2):
        smooth = uniform_filter1d(smooth, width, mode="nearest")
    knots = np.concatenate([np.zeros(5), np.linspace(0.0, 1.0, len(instants) // 50 + 1), np.ones(5)])
    places = np.convolve(knots[1:-1], np.full(5, 0.2), mode="valid")  # Greville points
    coefficients = np.interp(places * duration, instants, smooth)
    # With limited jerk, x = p'^2 grows with s^(4/3); for a parameter that begins with the cube of time, it does not.
    coefficients[:3], coefficients[-3:] = 0.0, 1.0
    return BSpline(knots, coefficients, 5)


def _profile(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits, places: int) -> tuple[Array, Array]:
    """Return parameters of the curve and the times [s] at which they are reached.

    Jerk is limited only where the curve itself bends.
    """
    u = _guess_samples(tool_path, places)
    spline = make_interp_spline(u, configurations(tool_path, candidate, u), k=5)
    slow = np.min(limits.jerk / np.maximum(np.abs(spline(u, 3)), 1e-9), axis=1) ** (2 / 3)
    tool_speed = GUESS_LIMIT_SHARES[0] * limits.tool_speed
    slow = np.minimum(slow, squared_rate_ceiling(spline(u), spline(u, 1), tool_speed, candidate.branch.arm))
    speed, acceleration = GUESS_LIMIT_SHARES[0] * limits.speed, GUESS_LIMIT_SHARES[1] * limits.acceleration
    reached = reach_times(u, max_squared_rates(u, spline(u, 1), spline(u, 2), speed, acceleration, slow))
    return u, reached


def _guess_samples(tool_path: ToolPath, least: int) -> Array:
    knots = np.unique(tool_path.curve.knots)
    lengths = tool_path.arc.lengths(knots)
    counts = np.maximum(
        min(GUESS_SAMPLES_PER_SPAN, 3 * least // len(knots)), np.ceil(least * np.diff(lengths) / lengths[-1])
    ).astype(np.int64)
    spans = zip(knots[:-1], knots[1:], counts, strict=True)
    return np.unique(np.concatenate([np.linspace(a, b, count + 1) for a, b, count in spans]))


def _time_stretch(trajectory: TimedTrajectory, rate: float, margins: Margins, arm: Arm) -> float:
    """Return the factor by which time must be stretched for joints and tool to keep the limits with their margins."""
    runs = [(phase, 1.0) for phase in SETPOINT_PHASES] + [(0.0, override) for override in CHECKED_OVERRIDES]
    factors = [
        margins.time_stretch(trajectory.setpoints(rate, phase=phase, override=override), trajectory.limits, rate)
        for phase, override in runs
    ]
    if np.isfinite(tool_speed := margins.speed * trajectory.limits.tool_speed):
        factors.append(float(trajectory.speed_bounds(arm).max()) / tool_speed)
    return max(factors)
