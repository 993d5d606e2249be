"""The lower bound of a duration beside that of toppra, the TOPP-RA of its authors: speed and acceleration limits alone.

toppra has wheels for Linux on x86-64 only, and is left out elsewhere.
"""

import numpy as np

from teachpath.motion.arm.limits import MotionLimits
from teachpath.motion.paths.ik_branches import Candidate, configurations
from teachpath.motion.paths.tool_path import ToolPath
from tests.bench.report import Figure, against

POINTS = 1600  # of the curve, even in its parameter


def measure(label: str, way: ToolPath, candidate: Candidate, limits: MotionLimits, bound: float) -> list[Figure]:
    """Return our bound [s] beside toppra's on as many points, or nothing where it is not installed."""
    try:
        from toppra import SplineInterpolator
        from toppra.algorithm import TOPPRA
        from toppra.constraint import DiscretizationType, JointAccelerationConstraint, JointVelocityConstraint
    except ImportError:
        return []
    u = np.linspace(0.0, 1.0, POINTS + 1)
    speed, acceleration = (np.column_stack([-most, most]) for most in (limits.speed, limits.acceleration))
    constraints = [
        JointVelocityConstraint(speed),
        JointAccelerationConstraint(acceleration, discretization_scheme=DiscretizationType.Interpolation),
    ]
    path = SplineInterpolator(u, configurations(way, candidate, u))
    _, rates, _ = TOPPRA(constraints, path, gridpoints=u, solver_wrapper="seidel").compute_parameterization(0.0, 0.0)
    theirs = float(np.sum(2.0 * np.diff(u) / (rates[1:] + rates[:-1])))
    return [against(f"{label}: lower bound of a duration", [bound], "s", name="toppra", value=theirs)]
