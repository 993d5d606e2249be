"""The unit of a clock's readings: as the file says it, or what its numbers allow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teachpath.io.readers.contract import TIME_UNITS, Integers, OptionNeeded
from teachpath.io.readers.text import number
from teachpath.records import Array

PLAUSIBLE_RATES = (2.0, 2000.0)  # [Hz] of trackers


def time_unit(times: Array, *, said: str, stated: str, name: str) -> str:
    """Return the unit of a clock; only seconds are taken without being named.

    Args:
        times: (n,) as in the file.
        said: by the user, or empty.
        stated: by the file, or empty.
        name: of the file, for errors.

    Raises:
        OptionNeeded: nobody names the unit, and the readings are not those of seconds.
    """
    if said or stated:
        return said or stated
    steps = np.abs(np.diff(times[np.isfinite(times)]))
    steps = steps[steps > 0.0]
    if not len(steps):
        return "s"
    step = float(np.median(steps))
    low, high = PLAUSIBLE_RATES
    rates = {unit: 1e9 / (step * factor) for unit, factor in TIME_UNITS.items()}
    fitting = [unit for unit, rate in rates.items() if low <= rate <= high]
    if fitting == ["s"]:
        return "s"
    if len(fitting) == 1:
        raise OptionNeeded(
            f"{name}: t looks like {fitting[0]}: its steps of {step:g} would be {rates[fitting[0]]:.3g} Hz",
            "time",
            fitting[0],
        )
    raise OptionNeeded(
        f"{name}: the unit of t is open: steps of {step:g} would be {rates['s']:.3g} Hz in s, {rates['ms']:.3g} in ms, "
        f"{rates['us']:.3g} in us",
        "time",
        *TIME_UNITS,
    )


def stamps_of(cells: Sequence[str], times: Array, unit: str, delimiter: str, name: str) -> Integers:
    """Return the stamps (n,) [ns] of the readings of a clock; integers are not rounded.

    Args:
        cells: the readings as texts.
        times: the same as numbers.
        name: of the file, for errors.
    """
    factor = TIME_UNITS[unit]
    farthest = float(np.abs(times).max())
    if not farthest < 2**62 / factor:
        raise OptionNeeded(f"{name}: a time of {farthest:g} {unit} is no time", "time")
    stamps = [
        int(cell) * factor if cell.isdecimal() else round(number(cell, delimiter) * factor)
        for cell, time in zip(cells, times, strict=True)
    ]
    return np.array(stamps, dtype=np.int64)
