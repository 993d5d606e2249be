"""What the joints do along a path, one quintic spline through nodes, and what they may do."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from teachpath.motion.arm.puma560 import Array

SPLINE_DEGREE: Final = 5
SAMPLES_PER_NODE: Final = 4  # samples per node that show what lies between the nodes


@dataclass(frozen=True, eq=False)
class JointPath:
    """Configurations q and the tool's length s as functions of one parameter.

    Attributes:
        nodes: (n,) strictly increasing parameters.
        lengths: (n,) of the tool's way up to each node [m].
        joints: (n, 6) configurations at the nodes [rad].
    """

    nodes: Array
    lengths: Array
    joints: Array

    @property
    def length(self) -> float:
        """Length of the whole way [m]."""
        return float(self.lengths[-1])

    @cached_property
    def spline(self) -> BSpline[np.float64]:
        """The six joints and the length by the parameter."""
        return make_interp_spline(self.nodes, np.column_stack([self.joints, self.lengths]), k=SPLINE_DEGREE)

    @cached_property
    def _derivatives(self) -> tuple[BSpline[np.float64], ...]:
        return (self.spline, *(self.spline.derivative(k) for k in (1, 2, 3)))

    def __call__(self, parameter: Array | float, order: int = 0) -> Array:
        """Evaluate (..., 7) the six joints and the length, or their derivative of `order` 0 to 3."""
        at = np.clip(parameter, self.nodes[0], self.nodes[-1])
        return np.asarray(self._derivatives[order](at), dtype=np.float64)

    def dense_parameters(self) -> Array:
        """Return parameters several times denser than the nodes."""
        grid = np.arange((len(self.nodes) - 1) * SAMPLES_PER_NODE + 1) / SAMPLES_PER_NODE
        return np.interp(grid, np.arange(len(self.nodes)), self.nodes)
