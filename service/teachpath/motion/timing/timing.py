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
from teachpath.motion.arm.joint_path import JointPath, Limits
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.paths.ik_branches import Candidate, configurations
from teachpath.motion.paths.tool_path import Route
from teachpath.motion.timing.jerk_limited_topp import fastest_pace
from teachpath.motion.timing.limit_margins import Reserve
from teachpath.motion.timing.timed_trajectory import Track, paced
from teachpath.motion.timing.velocity_profile import squared_rates, times
from teachpath.nurbs import Curve

GUESSED: Final = (0.98, 0.90)  # shares of speed and acceleration limits that the guess uses
PLACES: Final = 400  # of the curve in the guess, at least so many ...
PER_SPAN: Final = 24  # ... and so many between two knots
FEWER: Final = 150  # places of the estimate
MARGIN: Final = 0.1  # s, that the guess is too short for want of jerk limits
WINDOW: Final = 0.05  # s, of the filter that takes the jumps of acceleration out of the guess
KNOT: Final = 0.05  # s, between two knots of the smooth guess
FEWEST: Final = 24  # intervals of the smooth guess, at least
MOST: Final = 80  # and at most
FINER: Final = 10  # intervals of the pace for each interval of the guess
FINEST: Final = 16  # the same where the curve has kinks of acceleration, which the pace must follow
SMOOTH: Final = 3  # derivatives that a curve without such kinks has
NODES: Final = 400  # of the joints' spline, at least
PHASES: Final = (0.0, 0.25, 0.5, 0.75)  # of the first setpoint, in control periods
OVERRIDES: Final = (0.1, 0.3, 0.5, 0.7, 0.9)
STRETCHES: Final = 4  # times that time is stretched at most
EXACT: Final = 1e-3  # relative stretch that is not worth repeating


def timed(
    way: Route, candidate: Candidate, limits: Limits, *, rate: float, reserve: Reserve | None = None
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
    warp, reserve = _guess(way, candidate, limits), reserve or Reserve()
    intervals = (FINER if _smoothness(way.curve) >= SMOOTH else FINEST) * (len(warp.c) - warp.k)
    sigma = np.linspace(0.0, 1.0, max(NODES, intervals) + 1)
    u = np.asarray(warp(sigma), dtype=np.float64)
    path = JointPath(sigma, way.arc.lengths(u), configurations(way, candidate, u))
    pace = fastest_pace(path, limits, intervals, reserve)
    for _ in range(STRETCHES):
        factor = _factor(paced(path, pace, limits), rate, reserve)
        pace = pace / factor**2
        if abs(factor - 1.0) < EXACT:
            break
    if not np.all(np.isfinite(pace)):
        raise PathRefused("the path turns too sharply for the joints; smooth it by moving its control points apart")
    return path, pace


def lower_bound(way: Route, candidate: Candidate, limits: Limits) -> float:
    """Return the shortest time [s] that speed and acceleration limits alone allow: no jerk limit, no reserve."""
    u = _places(way, 4 * PLACES)
    spline = make_interp_spline(u, configurations(way, candidate, u), k=5)
    free = np.full(len(u), np.inf)
    return float(times(u, squared_rates(u, spline(u, 1), spline(u, 2), limits.speed, limits.acceleration, free))[-1])


def estimate(way: Route, candidate: Candidate, limits: Limits) -> float:
    """Guess quickly how long the fastest motion takes [s]; `timed` finds out."""
    return float(_profile(way, candidate, limits, FEWER)[1][-1] + MARGIN)


def _smoothness(curve: Curve) -> int:
    """Return how many derivatives of a curve are continuous."""
    inner = curve.knots[curve.degree + 1 : -curve.degree - 1]
    return curve.degree - int(np.unique(inner, return_counts=True)[1].max(initial=0))


def _guess(way: Route, candidate: Candidate, limits: Limits) -> BSpline[np.float64]:
    """Return the curve's parameter by nearly proportional time, from 0 to 1; it grows with the cube at both ends."""
    u, reached = _profile(way, candidate, limits, PLACES)
    duration = reached[-1] + MARGIN
    instants = np.linspace(0.0, duration, 50 * min(max(FEWEST, int(np.ceil(duration / KNOT))), MOST) + 1)
    smooth = np.interp(instants - MARGIN / 2, reached, u)
    width = max(1, round(WINDOW / (instants[1] - instants[0])))
    for _ in range(2):
        smooth = uniform_filter1d(smooth, width, mode="nearest")
    knots = np.concatenate([np.zeros(5), np.linspace(0.0, 1.0, len(instants) // 50 + 1), np.ones(5)])
    places = np.convolve(knots[1:-1], np.full(5, 0.2), mode="valid")  # Greville points
    coefficients = np.interp(places * duration, instants, smooth)
    # x = p'^2 grows with s^(4/3) when jerk is limited; a parameter that begins with the cube of time takes that out.
    coefficients[:3], coefficients[-3:] = 0.0, 1.0
    return BSpline(knots, coefficients, 5)


def _profile(way: Route, candidate: Candidate, limits: Limits, places: int) -> tuple[Array, Array]:
    """Return places of the curve and when each is reached [s], jerk being limited only where the curve itself bends."""
    u = _places(way, places)
    spline = make_interp_spline(u, configurations(way, candidate, u), k=5)
    slow = np.min(limits.jerk / np.maximum(np.abs(spline(u, 3)), 1e-9), axis=1) ** (2 / 3)
    speed, acceleration = GUESSED[0] * limits.speed, GUESSED[1] * limits.acceleration
    reached = times(u, squared_rates(u, spline(u, 1), spline(u, 2), speed, acceleration, slow))
    return u, reached


def _places(way: Route, least: int) -> Array:
    knots = np.unique(way.curve.knots)
    lengths = way.arc.lengths(knots)
    counts = np.maximum(min(PER_SPAN, 3 * least // len(knots)), np.ceil(least * np.diff(lengths) / lengths[-1])).astype(
        np.int64
    )
    spans = zip(knots[:-1], knots[1:], counts, strict=True)
    return np.unique(np.concatenate([np.linspace(a, b, count + 1) for a, b, count in spans]))


def _factor(track: Track, rate: float, reserve: Reserve) -> float:
    """Return by what time must be stretched so that setpoints keep the limits with the reserve."""
    runs = [(phase, 1.0) for phase in PHASES] + [(0.0, override) for override in OVERRIDES]
    return max(
        reserve.stretch(track.setpoints(rate, phase=phase, override=override), track.limits, rate)
        for phase, override in runs
    )
