"""Parameters of a curve at equal arc lengths."""

from __future__ import annotations

import numpy as np

from teachpath.learning.resampling import arc_lengths
from teachpath.nurbs import Curve
from teachpath.records import Array

CURVE_SAMPLES = 2000


def even_parameters(curve: Curve, count: int) -> Array:
    """Return the parameters (count,) of points at equal arc length."""
    fine = np.linspace(0.0, 1.0, CURVE_SAMPLES)
    s = arc_lengths(curve(fine))
    return np.asarray(np.interp(np.linspace(0.0, s[-1], count), s, fine))
