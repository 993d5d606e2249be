"""The shapes of numbers that the nouns are made of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Matrix = np.ndarray[tuple[int, int], np.dtype[np.float64]]  # an array of rows
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Pose = tuple[Vector, Quaternion]
