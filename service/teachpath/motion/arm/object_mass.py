"""The mass of the object that the arm carries: one number for plans, the live hand and the simulated arm."""

from __future__ import annotations

from math import pi
from typing import Final

import numpy as np

from teachpath.records import Shape

OBJECT_DENSITY: Final = 300.0  # kg/m^3, of an object whose mass is not said: a light wooden block


def object_mass(shape: Shape) -> float:
    """Return the mass of the carried object [kg]: what its scene says, else its volume at `OBJECT_DENSITY`."""
    return OBJECT_DENSITY * _volume(shape) if shape.mass is None else shape.mass


def _volume(shape: Shape) -> float:
    if shape.kind == "mesh":
        from scipy.spatial import ConvexHull  # where there is a mesh

        return float(ConvexHull(shape.size[0] * np.array(shape.vertices)).volume)
    if shape.kind == "sphere":
        return 4 / 3 * pi * shape.size[0] ** 3
    return float(np.prod(shape.size)) if shape.kind == "box" else pi * shape.size[0] ** 2 * shape.size[1]
