"""From a route and a branch of the arm to the fastest motion along it that all joint limits allow.

First a guess at the time each place of the curve is reached; then the joints as a spline over this guess, which is
smooth because its parameter is nearly time; then the pace at which the parameter really runs (`pace`); last a stretch
of time that is measured on setpoints, because between samples the joints' jerk has needles where the curve has knots.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline
from scipy.ndimage import uniform_filter1d

from teachpath.errors import PathRefused
from teachpath.motion.arm.joint_path import JointPath
from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.paths.ik_branches import Candidate, configurations
from teachpath.motion.paths.tool_path import ToolPath
from teachpath.motion.timing.jerk_limited_topp import minimize_duration
from teachpath.motion.timing.limit_margins import Margins
from teachpath.motion.timing.timed_trajectory import TimedTrajectory, time_joint_path
from teachpath.motion.timing.velocity_profile import max_squared_rates, reach_times
from teachpath.nurbs import Curve

GUESS_LIMIT_SHARES: Final = (0.98, 0.90)  # shares of speed and acceleration limits that the guess uses
MIN_GUESS_SAMPLES: Final = 400  # of the curve in the guess, at least so many ...
GUESS_SAMPLES_PER_SPAN: Final = 24  # ... and so many between two knots
ESTIMATE_SAMPLES: Final = 150  # places of the estimate
GUESS_EXTRA_TIME: Final = 0.1  # s, that the guess is too short for want of jerk limits
FILTER_WINDOW: Final = 0.05  # s, of the filter that takes the jumps of acceleration out of the guess
GUESS_KNOT_SPACING: Final = 0.05  # s, between two knots of the smooth guess
MIN_GUESS_INTERVALS: Final = 24  # intervals of the smooth guess, at least
MAX_GUESS_INTERVALS: Final = 80  # and at most
RATE_INTERVALS: Final = 10  # intervals of the pace for each interval of the guess
KINKED_RATE_INTERVALS: Final = 16  # the same where the curve has kinks of acceleration, which the pace must follow
SMOOTH_DERIVATIVES: Final = 3  # derivatives that a curve without such kinks has
MIN_SPLINE_NODES: Final = 400  # of the joints' spline, at least
SETPOINT_PHASES: Final = (0.0, 0.25, 0.5, 0.75)  # of the first setpoint, in control periods
CHECKED_OVERRIDES: Final = (0.1, 0.3, 0.5, 0.7, 0.9)
MAX_STRETCHES: Final = 4  # times that time is stretched at most
STRETCH_TOLERANCE: Final = 1e-3  # relative stretch that is not worth repeating


def time_tool_path(
    tool_path: ToolPath, candidate: Candidate, limits: MotionLimits, *, rate: float, margins: Margins | None = None
) -> tuple[JointPath, Array]:
    """Find the fastest motion along a route on one branch of the arm.

    Args:
        way: the route.
        candidate: the branch and the roll of the tool.
        limits: to keep, also while the rate is being changed.
        rate: setpoints a second on which they are measured [Hz].
        reserve: shares of the limits that the motion uses; the default when None.

    Returns:
        The joints by a parameter from 0 to 1, and the coefficients of its pace (see `track.paced`).

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
    pace = minimize_duration(path, limits, intervals, margins)
    for _ in range(MAX_STRETCHES):
        factor = _time_stretch(time_joint_path(path, pace, limits), rate, margins)
        pace = pace / factor**2
        if abs(factor - 1.0) < STRETCH_TOLERANCE:
            break
    if not np.all(np.isfinite(pace)):
        raise PathRefused("the path turns too sharply for the joints; smooth it by moving its control points apart")
    return path, pace


def duration_lower_bound(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits) -> float:
    """Return the shortest time [s] that speed and acceleration limits alone allow: no jerk limit, no reserve."""
    u = _guess_samples(tool_path, 4 * MIN_GUESS_SAMPLES)
    spline = make_interp_spline(u, configurations(tool_path, candidate, u), k=5)
    free = np.full(len(u), np.inf)
    return float(
        reach_times(u, max_squared_rates(u, spline(u, 1), spline(u, 2), limits.speed, limits.acceleration, free))[-1]
    )


def estimate_duration(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits) -> float:
    """Guess quickly how long the fastest motion takes [s]; `timed` finds out."""
    return float(_profile(tool_path, candidate, limits, ESTIMATE_SAMPLES)[1][-1] + GUESS_EXTRA_TIME)


def _smoothness(curve: Curve) -> int:
    """Return how many derivatives of a curve are continuous."""
    inner = curve.knots[curve.degree + 1 : -curve.degree - 1]
    return curve.degree - int(np.unique(inner, return_counts=True)[1].max(initial=0))


def _guess(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits) -> BSpline[np.float64]:
    """Return the curve's parameter by nearly proportional time, from 0 to 1; it grows with the cube at both ends."""
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
    # x = p'^2 grows with s^(4/3) when jerk is limited; a parameter that begins with the cube of time takes that out.
    coefficients[:3], coefficients[-3:] = 0.0, 1.0
    return BSpline(knots, coefficients, 5)


def _profile(tool_path: ToolPath, candidate: Candidate, limits: MotionLimits, places: int) -> tuple[Array, Array]:
    """Return places of the curve and when each is reached [s], jerk being limited only where the curve itself bends."""
    u = _guess_samples(tool_path, places)
    spline = make_interp_spline(u, configurations(tool_path, candidate, u), k=5)
    slow = np.min(limits.jerk / np.maximum(np.abs(spline(u, 3)), 1e-9), axis=1) ** (2 / 3)
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


def _time_stretch(trajectory: TimedTrajectory, rate: float, margins: Margins) -> float:
    """Return by what time must be stretched so that setpoints keep the limits with the reserve."""
    runs = [(phase, 1.0) for phase in SETPOINT_PHASES] + [(0.0, override) for override in CHECKED_OVERRIDES]
    return max(
        margins.time_stretch(trajectory.setpoints(rate, phase=phase, override=override), trajectory.limits, rate)
        for phase, override in runs
    )
