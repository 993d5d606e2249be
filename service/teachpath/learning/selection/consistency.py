"""How consistent the members of a cluster are with one another.

Each part of the measure looks for one kind of fault and gives every member a robust z score against the others. A
member is as consistent as its worst score: there is one limit for each fault instead of a sum, in which faultless
demonstrations would add up small differences.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from teachpath.learning.selection.features import CLOCK_POINTS, DEGREES, PATH_PARTS, POLYNOMIALS, MotionFeatures
from teachpath.learning.selection.shape_residuals import MIN_COURSES, Bending, bending_surprises, measure_bending
from teachpath.records import Array


class Part(StrEnum):
    """A part of the measure, by the kind of fault that it finds."""

    WIGGLE = "wiggle"
    TREMOR = "tremor"
    NOISE = "noise"
    BEND = "bend"
    DETOUR = "detour"
    PAUSE = "pause"
    JUMP = "jump"
    FREEZE = "freeze"


FAULT_OF_FEATURE = {  # what of a demonstration is inconsistent
    Part.WIGGLE: "smoothness",
    Part.TREMOR: "smoothness",
    Part.NOISE: "smoothness",
    Part.BEND: "bending",
    Part.DETOUR: "bending",
    Part.PAUSE: "timing",
    Part.JUMP: "readings",
    Part.FREEZE: "readings",
}
# Usual spreads of faultless demonstrations, in logarithms of amplitudes (BEND: nats, PAUSE: logarithm of a duration),
# such that a score of 3 is the limit. Only BEND and DETOUR leave out more than one in a thousand faultless ones:
# detours and the hand's own bows overlap, and their limit is a compromise (`make experiments`).
USUAL_SPREADS = {
    Part.WIGGLE: 0.1,
    Part.TREMOR: 0.09,
    Part.NOISE: 0.085,
    Part.BEND: 0.6,
    Part.DETOUR: 0.07,
    Part.PAUSE: 0.23,
    Part.JUMP: 0.1,
    Part.FREEZE: 0.2,
}
USUAL_WEIGHT = 6  # members that the usual spread counts for beside the measured one
PACE_SPREAD = 0.2  # of a logarithm of the pace, by which the amplitude of a tremor moves from one band to another
WARP_SPREAD = 13.0  # nats of bending for each share of the duration by which the pace differs
DETOUR_PACE_SPREAD = 0.8  # as PACE_SPREAD, of a detour
DETOUR_WARP_SPREAD = (
    4.2  # of the same logarithm, for each share of the duration by which the pace of the others differs
)
BENDS_OF_MANY = 1.74  # how much more the bends of many vary than those of five
MEDIAN_VARIANCE = 1.57  # of the median of so many values, of their variance
MAX_WITHOUT_OWN = 30  # members up to which each is compared with the others alone; in more its own value is lost
DEGREE_BANDS = {
    Part.WIGGLE: (13, 24),
    Part.TREMOR: (24, 42),
    Part.NOISE: (42, 80),
}  # degrees, first to one behind the last
QUICK_DEGREES = slice(13, 80)  # the degrees of all of them
QUICK_POLYNOMIALS: Array = np.ascontiguousarray(POLYNOMIALS[:, QUICK_DEGREES])
# A hand that goes its way has next to nothing in these degrees, and half a second's turn aside and back has; in lower
# ones it differs from hand to hand, and the degrees above are those of a wiggle.
DETOUR_BAND = (11.5, 14)
DETOUR_DEGREES = slice(4, 17)  # degrees in which a detour differs from the other motions, their ends and drifts do not
SHAKING_WINDOW = CLOCK_POINTS // 12  # over which shaking is averaged
NEGLIGIBLE_AMPLITUDE = 0.001  # of the size of the path: an amplitude far below it says nothing
NEGLIGIBLE_DETOUR = 0.0006
NEGLIGIBLE_BEND = 0.01
NEGLIGIBLE_JUMP = 0.01
NEGLIGIBLE_PAUSE = 0.02  # of the mean duration of a part of the path
MIN_PACE, MAX_PACE = 0.4, 2.3  # share of the median duration, beyond which a band is moved no further


@dataclass(frozen=True, eq=False)
class Measures:
    """What is compared between m members, before it is: it does not depend on who else takes part.

    Attributes:
        amplitudes: for each of the three bands (3 clocks, m) logarithms of amplitudes.
        shaking: (m, 240) see `shaking_profile`.
        shakes: (m,) whether a member departs from its smooth course by more than the bound.
        dwell: (24, m) logarithms of durations beside those of the neighbouring parts of the path.
        jump_sizes, leap_sizes: (m,) logarithms.
        paces: (m,) logarithms of the duration beside the median duration.
        bending: None for fewer than four.
        detours: (4, m) logarithms of amplitudes, of the motions and of their differences from the mean of the others,
            on two clocks.
        differences: (m,) root mean squares of these differences, in sizes of the path.
    """

    amplitudes: dict[Part, Array]
    shaking: Array
    shakes: NDArray[np.bool_]
    dwell: Array
    jump_sizes: Array
    leap_sizes: Array
    paces: Array
    bending: Bending | None
    detours: Array
    differences: Array

    def scores(self, members: Sequence[int] | NDArray[np.int64]) -> dict[Part, Array]:
        """Return for each part and each of these members by how many usual spreads it is worse than the others."""
        at = np.asarray(members)
        usual = {
            part: np.hypot(spread, PACE_SPREAD * self.paces[at]) if part in DEGREE_BANDS else np.full(len(at), spread)
            for part, spread in USUAL_SPREADS.items()
        }
        z = {part: self._band(part, at, usual[part]) for part in DEGREE_BANDS}
        z[Part.BEND] = self._bend(at, usual[Part.BEND])
        z[Part.DETOUR] = self._detour(at)
        z[Part.PAUSE] = robust_z(self._pauses(at), usual[Part.PAUSE])
        z[Part.JUMP] = robust_z(self.jump_sizes[at], usual[Part.JUMP])
        z[Part.FREEZE] = robust_z(self.leap_sizes[at], usual[Part.FREEZE])
        return z

    def _band(self, part: Part, at: NDArray[np.int64], usual: Array) -> Array:
        """Score a band on the clock on which the member is least suspicious: its pace alone says nothing."""
        z = robust_z(self.amplitudes[part][:, at], usual).min(axis=0)
        return np.asarray(np.where(self.shakes[at], z, np.minimum(z, 0.0)))

    def _bend(self, at: NDArray[np.int64], usual: Array) -> Array:
        if self.bending is None or len(at) < MIN_COURSES:
            return np.zeros(len(at))
        warp = float(np.sqrt(np.square(self.bending.warps[at]).mean()))
        m = len(at)
        # The fewer the others, the more of a bend of one's own is in all residuals, and the less they scatter.
        scatter = np.sqrt(BENDS_OF_MANY * (1 - 1 / m) / (1 + MEDIAN_VARIANCE / (m - 1)))
        z = robust_z(bending_surprises(self.bending.energies[at]), scatter * np.hypot(usual, WARP_SPREAD * warp))
        return np.asarray(np.where(self.bending.amplitudes[at] > NEGLIGIBLE_BEND, z, np.minimum(z, 0.0)))

    def _detour(self, at: NDArray[np.int64]) -> Array:
        """Score detours where a member is least suspicious: its own shape or its own pace alone say nothing."""
        m = len(at)
        if self.bending is None or m < MIN_COURSES:
            return np.zeros(m)
        warps = np.square(self.bending.warps[at])
        of_pace = np.hypot(DETOUR_PACE_SPREAD * self.paces[at], USUAL_SPREADS[Part.DETOUR])
        of_warp = DETOUR_WARP_SPREAD * np.sqrt((warps.sum() - warps) / (m - 1))
        z = robust_z(self.detours[:, at], np.hypot(of_pace, of_warp)).min(axis=0)
        return np.asarray(np.where(self.differences[at] > NEGLIGIBLE_BEND, z, np.minimum(z, 0.0)))

    def _pauses(self, at: NDArray[np.int64]) -> Array:
        """Return for each member by how much it dwells longer than the others where it does so most: (m,)."""
        dwell = self.dwell[:, at]
        return np.asarray((dwell - others_median(dwell)[0]).max(axis=0))


def measure(features: Sequence[MotionFeatures], courses: Array, size: float, bound: float) -> Measures:
    """Measure the members of a cluster.

    Args:
        features: of every member.
        courses: (m, n, 3) [m] at n equal shares of the duration.
        size: of the path [m].
        bound: amplitude [m] below which nobody shakes.
    """
    durations = np.array([of.duration for of in features])
    paces = durations / np.median(durations)
    timed = np.stack([of.timed for of in features]) / size
    different = timed - (timed.sum(axis=0) - timed) / max(len(features) - 1, 1)
    energies, even = _cumulative(timed), np.ones_like(paces)
    paced = np.clip(paces, MIN_PACE, MAX_PACE)
    clocks = (
        (energies, even),
        (energies, paced),
        (_cumulative(np.stack([of.spaced for of in features]) / size), even),
    )
    shaking = np.stack([shaking_profile(of) for of in features])
    excess = (shaking - np.median(shaking, axis=0)).max(axis=1)
    spread = np.log(np.stack([np.diff(of.passing) / of.duration for of in features]).T * PATH_PARTS + NEGLIGIBLE_PAUSE)
    return Measures(
        amplitudes={
            part: np.stack([_amplitudes(*clock, *band) for clock in clocks]) for part, band in DEGREE_BANDS.items()
        },
        shaking=shaking,
        shakes=shaking_amplitude(excess) > bound,
        dwell=_beside_neighbours(spread),
        jump_sizes=np.log(np.array([of.jump for of in features]) / size + NEGLIGIBLE_JUMP),
        leap_sizes=np.log(np.array([of.leap for of in features]) / size + NEGLIGIBLE_JUMP),
        paces=np.log(paces),
        bending=measure_bending(courses, size) if len(features) >= MIN_COURSES else None,
        detours=np.stack(
            [
                _amplitudes(of, clock, *DETOUR_BAND, NEGLIGIBLE_DETOUR)
                for of in (energies, _cumulative(different))
                for clock in (even, paced)
            ]
        ),
        differences=np.sqrt(np.square(different[:, DETOUR_DEGREES]).sum(axis=(1, 2))),
    )


def shaking_profile(features: MotionFeatures) -> Array:
    """Return the mean square of what is quicker than the intended motion, over a short window: (240,) [m^2]."""
    quick = np.einsum("nd,kd->nk", QUICK_POLYNOMIALS, np.ascontiguousarray(features.timed[QUICK_DEGREES].T))
    return np.asarray(uniform_filter1d(np.square(quick).sum(axis=1), SHAKING_WINDOW, mode="nearest"))


def shaking_amplitude(excess: Array) -> Array:
    """Return the amplitude [m] of a sine whose mean square [m^2] is so much more than that of the others."""
    return np.asarray(np.sqrt(2 * np.maximum(excess, 0.0)))


def robust_z(values: Array, usual: Array) -> Array:
    """Return by how many spreads each value (..., m) lies above the median of the others.

    The spread is the usual one (m,), or the median absolute deviation where that is larger: that of few values is
    unreliable, so the usual spread counts for some members.
    """
    median, measured = others_median(values)
    others = values.shape[-1] - 1
    mixed = (USUAL_WEIGHT * np.square(usual) + others * np.square(measured)) / (USUAL_WEIGHT + others)
    spread = np.sqrt(np.maximum(mixed, np.square(usual)) * (1 + MEDIAN_VARIANCE / others))
    return np.asarray((values - median) / spread)


def others_median(values: Array) -> tuple[Array, Array]:
    """Return for each value (..., m) median and spread (from the median absolute deviation) of the others."""
    m = values.shape[-1]
    if m > MAX_WITHOUT_OWN:
        median = np.broadcast_to(_median(values)[..., None], values.shape)
        spread = 1.4826 * _median(np.abs(values - median))
        return median, np.broadcast_to(spread[..., None], values.shape)
    others = values[..., np.nonzero(~np.eye(m, dtype=bool))[1].reshape(m, m - 1)]  # (..., m, m - 1)
    medians = _median(others)
    return medians, 1.4826 * _median(np.abs(others - medians[..., None]))


def _median(values: Array) -> Array:
    """Return the medians over the last axis as numpy does, which takes ten times as long for a few values."""
    ordered, middle = np.sort(values, axis=-1), values.shape[-1] // 2
    if values.shape[-1] % 2:
        return np.asarray(ordered[..., middle])
    return np.asarray((ordered[..., middle - 1] + ordered[..., middle]) / 2)


def _cumulative(coefficients: Array) -> Array:
    """Sum energies over the degrees below each degree: (m, degrees + 1)."""
    energies = np.square(coefficients).sum(axis=2)
    return np.concatenate([np.zeros((len(energies), 1)), np.cumsum(energies, axis=1)], axis=1)


def _amplitudes(
    cumulative: Array, paces: Array, low: float, high: float, negligible: float = NEGLIGIBLE_AMPLITUDE
) -> Array:
    """Return the logarithms of the amplitudes in a band whose degrees are multiplied by `paces` (m,)."""
    paces = np.minimum(paces, DEGREES / high)
    below, upto = (_interpolated(cumulative, degree * paces) for degree in (low, high))
    return np.asarray(0.5 * np.log(np.maximum(upto - below, 0.0) + negligible**2))


def _interpolated(cumulative: Array, degrees: Array) -> Array:
    before = np.minimum(degrees.astype(int), cumulative.shape[1] - 2)
    rows = np.arange(len(cumulative))
    part = degrees - before
    return np.asarray((1 - part) * cumulative[rows, before] + part * cumulative[rows, before + 1])


def _beside_neighbours(dwell: Array) -> Array:
    """Subtract from each row (24, m) the mean of the four around it; the first and the last are left out."""
    padded = np.concatenate([dwell[:1], dwell[:1], dwell, dwell[-1:], dwell[-1:]])
    count = len(dwell)
    around = (padded[:count] + padded[1 : count + 1] + padded[3 : count + 3] + padded[4 : count + 4]) / 4
    return np.asarray((dwell - around)[1:-1])
