"""Where and how a demonstration deviates from the others, in words for the person who showed it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import binary_closing, median_filter
from scipy.signal import savgol_filter

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length, smoothed
from teachpath.learning.selection.features import Feature
from teachpath.records import Array, Deviation, Trajectory

MIN_DEFICIT_SHARE = 0.25  # of the largest deficit, from which on a frame deviates too
MAX_BRIDGED_FRAMES = 2  # between deviating frames, that count as deviating
PATH_POINTS = 100  # of the paths that are compared
MIN_JUMP = 0.01  # m, distance of one sample from its neighbours
MIN_REPEATED_READINGS = 5  # in a row
REST_SPEED_SHARE = 0.15  # of the mean speed, below which the hand rests
MIN_STOP_DURATION = 0.2  # s, up to which a stop is not mentioned
MOTION_WINDOW = 0.8  # s, within which an intended motion is nearly a cubic polynomial
MIN_SHAKING_RATE = 1.0  # Hz
MIN_SHAKING_SHARE = 0.4  # of the distance from the others, above which the deviation is shaking and no detour
MIN_TREMOR_RATE = 8  # Hz
SPAN_MARGIN = 0.4  # s, looked at before and after the span


def describe_deviation(
    trajectory: Trajectory,
    others: Sequence[Trajectory],
    feature: Feature,
    *,
    profile: Array,
    times: Array,
    usual: float,
) -> Deviation:
    """Find where a demonstration is least likely, and describe how it deviates there.

    Args:
        trajectory: of the demonstration.
        others: trajectories of the other members of its cluster.
        feature: in which it differs most.
        profile: (frames,) log-likelihoods of its frames in that feature.
        times: (frames,) [s] since the first sample.
        usual: median log-likelihood of a frame of the others.
    """
    since = trajectory.times - trajectory.times[0]
    s = arc_lengths(smoothed(trajectory))
    away, within = _beside(trajectory, others)
    if feature in (Feature.SHAPE, Feature.BENDING) and np.any(away > within):
        # Subtracting the large-scale form spreads a detour along the whole path; the distance tells where it is.
        profile, usual = within - away, 0.0
        times = np.interp(np.linspace(0.0, s[-1], PATH_POINTS), s, since)
    begin, end = _span(profile, times, usual)
    share = (float(np.interp(begin, since, s) / s[-1]), float(np.interp(end, since, s) / s[-1]))
    what = _sentence(trajectory, others, feature, (begin, end), _worst(away, within, share))
    sentence = f"{what}, {begin:.1f} to {end:.1f} s after the grasp, at {share[0]:.0%} to {share[1]:.0%} of its way"
    return Deviation(share, (begin, end), sentence)


def _span(profile: Array, times: Array, usual: float) -> tuple[float, float]:
    """Return the times [s] between which frames are clearly less likely than usual, around the least likely one."""
    deficit = usual - profile
    worst = int(np.argmax(deficit))
    odd = binary_closing(
        np.pad(deficit > MIN_DEFICIT_SHARE * deficit[worst], MAX_BRIDGED_FRAMES), iterations=MAX_BRIDGED_FRAMES
    )[MAX_BRIDGED_FRAMES:-MAX_BRIDGED_FRAMES]
    usual_ones = np.append(np.flatnonzero(~odd), len(profile))
    first = int(np.max(usual_ones[usual_ones < worst], initial=-1)) + 1
    last = int(np.min(usual_ones[usual_ones > worst])) - 1
    edges = np.concatenate([[0.0], (times[1:] + times[:-1]) / 2, times[-1:]])
    return float(edges[first]), float(edges[last + 1])


def _sentence(
    trajectory: Trajectory,
    others: Sequence[Trajectory],
    feature: Feature,
    seconds: tuple[float, float],
    beside: tuple[float, float],
) -> str:
    since = trajectory.times - trajectory.times[0]
    steps = np.diff(since)
    margin, step = max(SPAN_MARGIN, float(steps.max())), float(np.median(steps))
    inside = (since >= seconds[0] - margin) & (since <= seconds[1] + margin)
    positions = trajectory.positions[inside]
    repeated = _longest(np.all(np.diff(positions, axis=0) == 0, axis=1))
    if repeated + 1 >= MIN_REPEATED_READINGS:
        return f"the tracker repeats one reading for {repeated * step:.1f} s"
    jumps = np.linalg.norm(positions - median_filter(positions, size=(5, 1), mode="nearest"), axis=1)
    jitter = float(np.median(jumps))
    if jumps.max() > MIN_JUMP + 5 * jitter:
        return f"jumps by {jumps.max() * 100:.0f} cm"
    away, usual = beside
    path = smoothed(trajectory)
    speed = np.linalg.norm(np.gradient(path, since, axis=0), axis=1)
    still = (
        _longest(
            (speed < REST_SPEED_SHARE * speed.mean())
            & inside
            & (since > SPAN_MARGIN)
            & (since < since[-1] - SPAN_MARGIN)
        )
        * step
    )
    if still > MIN_STOP_DURATION:
        return f"stands still for {still:.1f} s"
    shake, rate = _shaking(trajectory.positions, since, inside)
    normal = float(np.median([_shaking(other.positions, other.times - other.times[0])[0] for other in others]))
    trembles = shake > 1.1 * normal and feature is Feature.SMOOTHNESS
    if trembles or shake > max(2 * normal, MIN_SHAKING_SHARE * away):
        word = "shakes" if rate < MIN_TREMOR_RATE else "trembles"
        return f"{word} by {shake * 100:.1f} cm about {rate:.0f} times a second"
    if away > 1.5 * usual:
        return f"runs up to {away * 100:.1f} cm beside the others, who stay within {usual * 100:.1f} cm"
    if feature is Feature.BENDING:
        return "bends as none of the others does, though not far beside them"
    return "is in another place than the others at that time: quicker, slower or beside them"


def _beside(trajectory: Trajectory, others: Sequence[Trajectory]) -> tuple[Array, Array]:
    """Return the distances of a demonstration and of the farthest other from the others' mean: (100,) [m] each."""
    courses = np.stack([at_equal_arc_length(smoothed(other), PATH_POINTS) for other in others])
    mean = courses.mean(axis=0)
    away = np.linalg.norm(at_equal_arc_length(smoothed(trajectory), PATH_POINTS) - mean, axis=1)
    return away, np.linalg.norm(courses - mean, axis=2).max(axis=0)


def _worst(away: Array, within: Array, share: tuple[float, float]) -> tuple[float, float]:
    begin, end = int(share[0] * (PATH_POINTS - 1)), int(np.ceil(share[1] * (PATH_POINTS - 1))) + 1
    worst = begin + int(np.argmax(away[begin:end]))
    return float(away[worst]), float(within[worst])


def _shaking(positions: Array, since: Array, inside: Array | None = None) -> tuple[float, float]:
    """Return amplitude [m] and rate [Hz] of the part of a motion that no cubic polynomial follows over 0.8 s."""
    step = float(np.median(np.diff(since)))
    width = min(round(MOTION_WINDOW / step), len(positions) - 1) // 2 * 2 + 1
    quick = positions - savgol_filter(positions, max(width, 5), 3, axis=0)
    quick = quick if inside is None else quick[inside]
    power = np.square(np.abs(np.fft.rfft(quick, axis=0))).sum(axis=1)
    rates = np.fft.rfftfreq(len(quick), step)
    power[rates < MIN_SHAKING_RATE] = 0.0
    return float(np.sqrt(2 * np.square(quick).sum(axis=1).mean())), float(rates[np.argmax(power)])


def _longest(flags: Array) -> int:
    """Return the length of the longest run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(flags, dtype=int), [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))
