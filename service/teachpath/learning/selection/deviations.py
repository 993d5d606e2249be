"""Where and how a demonstration deviates from the others, in words for the person who showed it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_closing

from teachpath.learning.resampling import arc_lengths, at_equal_arc_length
from teachpath.learning.selection.consistency import Part, shaking_amplitude, shaking_profile
from teachpath.learning.selection.features import CLOCK_POINTS, MotionFeatures
from teachpath.lengths import describe_length, describe_lengths
from teachpath.records import Array, Deviation, Trajectory

MIN_DEFICIT_SHARE = 0.25  # of the largest deviation, from which on a point deviates too
BRIDGED_PARTS = 12  # of the points: gaps of two of them between deviating points are bridged
PATH_POINTS = 100  # of the paths that are compared
REST_SPEED_SHARE = 0.15  # of the mean speed, below which the hand rests
MIN_STOP_DURATION = 0.2  # s, below which a stop is told by what the others take there
MOTION_WINDOW = 0.8  # s, within which an intended motion is nearly a cubic polynomial
TREND_DEGREE = 3
MIN_SHAKING_RATE = 1.0  # Hz
MIN_TREMOR_RATE = 8  # Hz
UNUSUAL_PACE = 1.5  # of the median duration, from which on a pace is told

Seconds = tuple[float, float]


@dataclass(frozen=True, eq=False)
class ComparedMembers:
    """What k members of a cluster do, with which another one is compared.

    Attributes:
        durations: (k, 24) of the equal parts of the path, in shares of the whole.
        courses: (k, 100, 3) [m] their paths at equal arc lengths.
        shaking: (k, 240) [m^2] see `shaking_profile`.
    """

    durations: Array
    courses: Array
    shaking: Array


def describe_deviation(
    trajectory: Trajectory, features: MotionFeatures, others: ComparedMembers, part: Part
) -> Deviation:
    """Find where a demonstration deviates most in one part of the measure, and describe how.

    Args:
        trajectory: of the demonstration.
        features: of the demonstration.
        others: members of its cluster.
        part: in which it is worst.
    """
    since = trajectory.times - trajectory.times[0]
    match part:
        case Part.FREEZE:
            seconds = (float(since[features.frozen[0]]), float(since[features.frozen[1]]))
            what = f"the tracker repeats one reading for {seconds[1] - seconds[0]:.2g} s"
        case Part.JUMP:
            seconds = _around(since, features.jump_at)
            what = f"jumps by {describe_length(features.jump)}"
        case Part.PAUSE:
            seconds, what = _pause(trajectory, features, others.durations)
        case Part.BEND | Part.DETOUR:
            seconds, what = _bend(since, features, others.courses)
        case _:
            seconds, what = _shaking(trajectory, features, others.shaking)
    s = arc_lengths(features.path)
    share = tuple(float(np.interp(at, since, s) / s[-1]) if s[-1] > 0 else 0.0 for at in seconds)
    where = f"{seconds[0]:.1f} to {seconds[1]:.1f} s after the grasp, at {share[0]:.0%} to {share[1]:.0%} of its way"
    return Deviation((share[0], share[1]), seconds, f"{what}, {where}")


def describe_pace(duration: float, usual: float) -> Deviation | None:
    """Say when a demonstration is much quicker or slower than the others, who take `usual` [s]; its path counts."""
    pace = usual / duration
    if 1 / UNUSUAL_PACE < pace < UNUSUAL_PACE:
        return None
    word = f"{pace:.1f} times as fast" if pace > 1 else f"{1 / pace:.1f} times as slowly"
    sentence = f"shown {word} as the others, which changes nothing: the path has no time"
    return Deviation((0.0, 1.0), (0.0, duration), sentence)


def _around(since: Array, at: int) -> Seconds:
    return float(since[max(at - 1, 0)]), float(since[min(at + 1, len(since) - 1)])


def _pause(trajectory: Trajectory, features: MotionFeatures, theirs: Array) -> tuple[Seconds, str]:
    """Tell the part of the path on which the hand dwells longest beside the others, and for how long it rests there."""
    own = np.diff(features.passing)
    usual = np.median(theirs * features.duration, axis=0)
    worst = 1 + int(np.argmax((own / np.maximum(usual, 1e-9))[1:-1]))
    seconds = float(features.passing[worst]), float(features.passing[worst + 1])
    since = trajectory.times - trajectory.times[0]
    speed = np.linalg.norm(np.gradient(features.path, since, axis=0), axis=1)
    still = speed < REST_SPEED_SHARE * speed.mean()
    still &= (since >= seconds[0]) & (since <= seconds[1])
    rest = float(still.sum() * np.median(np.diff(since)))
    if rest > MIN_STOP_DURATION:
        return seconds, f"stands still for {rest:.1f} s"
    digits = next(
        digits for digits in range(2, 9) if f"{own[worst]:.{digits}g}" != f"{usual[worst]:.{digits}g}" or digits == 8
    )
    return seconds, f"takes {own[worst]:.{digits}g} s where the others take {usual[worst]:.{digits}g} s"


def _bend(since: Array, features: MotionFeatures, courses: Array) -> tuple[Seconds, str]:
    mean = courses.mean(axis=0)
    away = np.linalg.norm(at_equal_arc_length(features.path, PATH_POINTS) - mean, axis=1)
    within = np.linalg.norm(courses - mean, axis=2).max(axis=0)
    s = arc_lengths(features.path)
    beside = np.any(away > within)
    begin, end = _span(away - within if beside else away)
    seconds = tuple(float(np.interp(at / (PATH_POINTS - 1) * s[-1], s, since)) for at in (begin, end))
    worst = begin + int(np.argmax((away - within)[begin : end + 1]))
    if beside:
        far, near = describe_lengths(float(away[worst]), float(within[worst]))
        what = f"runs up to {far} beside the others, who stay within {near}"
    else:
        what = "bends as none of the others does, though not far beside them"
    return (seconds[0], seconds[1]), what


def _shaking(trajectory: Trajectory, features: MotionFeatures, theirs: Array) -> tuple[Seconds, str]:
    """Tell where a motion is quicker than the intended motion, by what amplitude and how often."""
    from scipy.signal import savgol_filter  # here, because it loads scipy.stats, which takes longer than learning

    excess = shaking_profile(features) - np.median(theirs, axis=0)
    begin, end = _span(excess)
    seconds = begin / CLOCK_POINTS * features.duration, (end + 1) / CLOCK_POINTS * features.duration
    since = trajectory.times - trajectory.times[0]
    step = float(np.median(np.diff(since)))
    width = min(round(MOTION_WINDOW / step), len(since) - 1) // 2 * 2 + 1
    quick = trajectory.positions
    if width > TREND_DEGREE:
        quick = quick - savgol_filter(quick, width, TREND_DEGREE, axis=0)
    inside = (since >= seconds[0]) & (since <= seconds[1])
    quick = quick[inside] if inside.sum() > 1 else quick
    power = np.square(np.abs(np.fft.rfft(quick, axis=0))).sum(axis=1)
    rates = np.fft.rfftfreq(len(quick), step)
    power[rates < MIN_SHAKING_RATE] = 0.0
    rate = float(rates[np.argmax(power)])
    word = "shakes" if rate < MIN_TREMOR_RATE else "trembles"
    amplitude = float(shaking_amplitude(excess.max()))
    if rate == 0 or amplitude == 0:
        return seconds, "is less smooth than the others on the whole, though at no place by much"
    return seconds, f"{word} by {describe_length(amplitude)} about {rate:.0f} times a second"


def _span(excess: Array) -> tuple[int, int]:
    """Return first and last point around the largest excess that have at least a quarter of it; gaps are bridged."""
    worst = int(np.argmax(excess))
    gap = len(excess) // BRIDGED_PARTS
    odd = binary_closing(np.pad(excess >= MIN_DEFICIT_SHARE * excess[worst], gap), iterations=gap)[gap:-gap]
    usual = np.flatnonzero(~odd)
    first = int(np.max(usual[usual < worst], initial=-1)) + 1
    last = int(np.min(usual[usual > worst], initial=len(excess))) - 1
    return first, last
