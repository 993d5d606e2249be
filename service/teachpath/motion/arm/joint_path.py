"""The path of the joints: one quintic spline through configurations at nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from teachpath.motion.arm.puma560 import Array

SPLINE_DEGREE: Final = 5
SAMPLES_PER_NODE: Final = 4  # of `dense_parameters`, which show what lies between the nodes


@dataclass(frozen=True, eq=False)
class JointPath:
    """Configurations q and arc length s as functions of one parameter.

    Attributes:
        nodes: (n,) strictly increasing parameters.
        lengths: (n,) arc length of the tool's path up to each node [m].
        joints: (n, joints) configurations at the nodes [rad].
    """

    nodes: Array
    lengths: Array
    joints: Array

    @property
    def length(self) -> float:
        """Arc length of the whole path [m]."""
        return float(self.lengths[-1])

    @cached_property
    def spline(self) -> BSpline[np.float64]:
        """The joints and the arc length as functions of the parameter."""
        return make_interp_spline(self.nodes, np.column_stack([self.joints, self.lengths]), k=SPLINE_DEGREE)

    @cached_property
    def _derivatives(self) -> tuple[BSpline[np.float64], ...]:
        return (self.spline, *(self.spline.derivative(k) for k in (1, 2, 3)))

    def __call__(self, parameter: Array | float, order: int = 0) -> Array:
        """Return (..., joints + 1) the joints and the arc length, or their derivative of `order` 1 to 3."""
        at = np.clip(parameter, self.nodes[0], self.nodes[-1])
        return np.asarray(self._derivatives[order](at), dtype=np.float64)

    def dense_parameters(self) -> Array:
        """Return parameters at the nodes and at even places between them."""
        grid = np.arange((len(self.nodes) - 1) * SAMPLES_PER_NODE + 1) / SAMPLES_PER_NODE
        return np.interp(grid, np.arange(len(self.nodes)), self.nodes)
