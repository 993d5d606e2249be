"""Lengths in sentences: true in the digits that are shown."""

from __future__ import annotations

from math import ceil, floor, log10

# The least length [m] that is told in a unit, the unit [m], and its name.
UNITS = ((1.0, 1.0, "m"), (0.01, 0.01, "cm"), (1e-5, 0.001, "mm"), (1e-9, 1e-6, "µm"), (0.0, 0.001, "mm"))
ROUNDING = 1e-9  # [m] below which a length is none
DIGITS = 2


def describe_length(length: float, *, digits: int = DIGITS, up: bool = False) -> str:
    """Return a length [m] with so many significant digits, in m, cm, mm or µm.

    Args:
        length: to tell [m].
        digits: how many of it.
        up: round up, as a limit that is to be set or kept.
    """
    rounded = _rounded(abs(length), digits, up)
    size, unit = next((size, unit) for least, size, unit in UNITS if rounded >= least)
    sign = "-" if length < 0 and rounded else ""
    return f"{sign}{_rounded(rounded / size, digits + 1, False):.12g} {unit}"


def describe_lengths(one: float, other: float) -> tuple[str, str]:
    """Return two lengths [m] with as many digits as it takes to tell them apart."""
    for digits in range(DIGITS, 8):
        told = describe_length(one, digits=digits), describe_length(other, digits=digits)
        if told[0] != told[1]:
            break
    return told


def _rounded(value: float, digits: int, up: bool) -> float:
    if value < ROUNDING:
        return 0.0
    step = digits - 1 - floor(log10(value))
    if not up:
        return round(value, step)
    scaled = value * 10.0**step
    return float(ceil(scaled * (1 - 1e-12)) / 10.0**step)
