"""An independent judge of refusals: is there any way at all to hold the arm along a curve, however the tool is rolled?

Places along the curve, turns of the tool about its axis and all branches make a graph. Nothing comes from the motion
room: the inverse kinematics here are another derivation, and each configuration is put through the checker's chain.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from teachpath.exchange import to_geomdl
from teachpath.nurbs import Curve
from teachpath.records import Scene
from tests.plan_checker.checker import GRIP, LOWER_LIMITS, UPPER_LIMITS, A, D, Solids, frames

PLACES = 41  # along the curve
ROLLS = np.radians(np.arange(0, 360, 15))
MIN_CLEARANCE = 0.005  # m, from obstacles
MIN_SINGULAR_VALUE = 0.03
STEP = 0.6  # rad, that a joint may turn from a place to the next


@dataclass(frozen=True)
class Finding:
    """Whether a way was found; otherwise the share of the curve's parameter up to which there was one."""

    possible: bool
    up_to: float


def search(curve: Curve, scene: Scene) -> Finding:
    """Look for a way to hold the arm along a curve, the tool pointing down and rolled as is needed from place to place.

    Clearance is that of sampled surfaces, never less than the true one, so what is not found is hardly possible.
    """
    points = to_geomdl(curve).evaluate_list(np.linspace(0.0, 1.0, PLACES).tolist())
    bodies, before = Solids(scene), None
    for place, point in enumerate(points):
        here = [q for roll in ROLLS for q in _held(np.array(point), roll, bodies, before)]
        if not here:
            return Finding(False, max(place - 1, 0) / (PLACES - 1))
        before = np.array(here)
    return Finding(True, 1.0)


def _held(point: np.ndarray, roll: float, bodies: Solids, before: np.ndarray | None) -> list[np.ndarray]:
    """Return the configurations at a point and roll that are clear, regular and near to one of the place before."""
    found = []
    free: dict[tuple[float, ...], bool] = {}
    for q in configurations(point, roll):
        if before is not None and not np.any(np.abs(before - q).max(axis=1) <= STEP):
            continue
        same = tuple(np.round(np.mod(q, 2 * np.pi), 6))  # whole turns of a joint change nothing in the world
        if same not in free:
            free[same] = (
                _least_singular(q) >= MIN_SINGULAR_VALUE and bodies.outside(q, enough=MIN_CLEARANCE) >= MIN_CLEARANCE
            )
        if free[same]:
            found.append(q)
    return found


def configurations(point: np.ndarray, roll: float) -> list[np.ndarray]:
    """Return all configurations within the joint limits that hold the tool down at a point, rolled by an angle."""
    wanted = np.array([[np.cos(roll), np.sin(roll), 0], [np.sin(roll), -np.cos(roll), 0], [0, 0, -1.0]])
    wrist = point + np.array([0.0, 0.0, GRIP + D[5]])
    found = []
    for arm in _arms(wrist):
        turn = frames(np.array([*arm, 0.0, 0.0, 0.0]))[3][:3, :3].T @ wanted
        for sign in (1.0, -1.0):
            # Links 4 to 6: turns about z, y (joint 5, the other way round) and z again.
            q5 = -sign * np.arctan2(np.hypot(turn[0, 2], turn[1, 2]), turn[2, 2])
            if abs(np.sin(q5)) < 1e-9:
                continue
            q4 = np.arctan2(sign * turn[1, 2], sign * turn[0, 2])
            q6 = np.arctan2(sign * turn[2, 1], -sign * turn[2, 0])
            base = np.array([*arm, q4, q5, q6])
            reached = frames(base)[6]
            assert np.abs(reached[:3, :3] - wanted).max() < 1e-9, (reached, wanted)
            assert np.abs(reached[:3, 3] + GRIP * reached[:3, 2] - point).max() < 1e-9
            found += _turned(base)
    return found


def _arms(wrist: np.ndarray) -> list[tuple[float, float, float]]:
    """Return the angles of joints 1 to 3 that bring the wrist to a place, by the law of cosines."""
    far = np.hypot(wrist[0], wrist[1])
    if far <= D[2]:
        return []
    angles = []
    forearm, bend = np.hypot(A[2], D[3]), np.arctan2(D[3], A[2])
    for side in (1.0, -1.0):
        ahead = side * np.sqrt(far**2 - D[2] ** 2)
        q1 = np.arctan2(wrist[1], wrist[0]) + np.arctan2(D[2], ahead)
        up = wrist[2] - D[0]
        cosine = (ahead**2 + up**2 - A[1] ** 2 - forearm**2) / (2 * A[1] * forearm)
        if abs(cosine) > 1.0:
            continue
        for knee in (1.0, -1.0):
            inside = knee * np.arccos(cosine)
            q2 = np.arctan2(up, ahead) - np.arctan2(forearm * np.sin(inside), A[1] + forearm * np.cos(inside))
            angles.append((q1, q2, inside - bend))
    return angles


def _turned(base: np.ndarray) -> list[np.ndarray]:
    """Return a configuration with every joint turned by whole turns in all ways that its limits allow."""
    ways = []
    for angle, low, high in zip(base, LOWER_LIMITS, UPPER_LIMITS, strict=True):
        ways.append([turned for turned in angle + 2 * np.pi * np.array([-1, 0, 1]) if low <= turned <= high])
    return [np.array(q) for q in product(*ways)]


def _least_singular(q: np.ndarray) -> float:
    chain = frames(q)
    tool = chain[6][:3, 3] + GRIP * chain[6][:3, 2]
    axes = np.array([frame[:3, 2] for frame in chain[:6]])
    arms = np.array([tool - frame[:3, 3] for frame in chain[:6]])
    return float(np.linalg.svd(np.vstack([np.cross(axes, arms).T, axes.T]), compute_uv=False)[-1])
