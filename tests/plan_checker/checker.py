"""An independent judge of plans: numbers typed anew, its own forward kinematics, geomdl's curve, brute-force sampling.

Nothing here comes from the motion room but the setpoints that are judged and the list of the arm's solids.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from teachpath.exchange import to_geomdl
from teachpath.motion.arm.geometry import collision_solids
from teachpath.nurbs import Curve
from teachpath.records import Scene, Shape

RATE = 250.0  # Hz
# Puma 560: a, d [m] and alpha [deg] of joints 1 to 6 (Corke & Armstrong-Helouvry 1994), shoulder 26.45 in above the
# floor, flange and gripper 56.25 + 130 mm before the wrist; limits [deg], [rad/s], [rad/s^2].
A = (0.0, 0.4318, 0.0203, 0.0, 0.0, 0.0)
D = (26.45 * 0.0254, 0.0, 0.15005, 0.4318, 0.0, 0.05625)
TWIST = (90.0, 0.0, -90.0, 90.0, -90.0, 0.0)
GRIP = 0.13
ELBOW = 0.295  # from the plane in which joint 2 turns to the outer face of the upper arm
LOWER_LIMITS = np.radians([-160, -45, -225, -110, -100, -266])
UPPER_LIMITS = np.radians([160, 225, 45, 170, 100, 266])
SPEED = np.array([1.92, 1.51, 2.40, 5.34, 5.09, 5.74])
ACCELERATION = np.array([10.0, 8.0, 16.0, 40.0, 40.0, 40.0])
JERK = 10.0 * ACCELERATION
SPACING = 0.012  # m, between points on a solid's surface


@dataclass(frozen=True)
class Verdict:
    """What was measured on the streamed setpoints of a plan; uses are shares of the limits."""

    position: float
    speed: float
    acceleration: float
    jerk: float
    tool_speed: float  # m/s, of elbow, wrist and grasp point by differences
    off_path: float  # m, of the grasp point from the curve
    clearance: float  # m, of sampled points of arm and object from the obstacles


def frames(q: np.ndarray) -> list[np.ndarray]:
    """Return the frames (4, 4) of links 0 to 6 for one configuration, each as four elementary moves."""
    found = [np.eye(4)]
    for angle, a, d, twist in zip(q, A, D, np.radians(TWIST), strict=True):
        found.append(found[-1] @ _turn(2, angle) @ _shift(0, 0, d) @ _shift(a, 0, 0) @ _turn(0, twist))
    return found


def judge(setpoints: np.ndarray, curve: Curve, scene: Scene, *, every: int = 12) -> Verdict:
    """Judge the setpoints (n, 6) that follow a curve; clearance is sampled at every so many of them."""
    use = [np.abs(np.diff(setpoints, k, axis=0)).max(axis=0) * RATE**k for k in (1, 2, 3)]
    middle, half = (LOWER_LIMITS + UPPER_LIMITS) / 2, (UPPER_LIMITS - LOWER_LIMITS) / 2
    tools = np.array([(frames(q)[6] @ _shift(0, 0, GRIP))[:3, 3] for q in setpoints])
    bodies = Solids(scene, setpoints[0])
    least = min(bodies.outside(q) for q in setpoints[::every])
    return Verdict(
        float((np.abs(setpoints - middle) / half).max()),
        float((use[0] / SPEED).max()),
        float((use[1] / ACCELERATION).max()),
        float((use[2] / JERK).max()),
        tool_speed(setpoints),
        _off_path(tools, curve),
        least,
    )


def tool_speed(setpoints: np.ndarray) -> float:
    """Return the largest speed [m/s] of elbow, wrist and grasp point in setpoints (n, 6), by differences."""
    marks = ((2, 0.0), (2, ELBOW), (5, 0.0), (6, GRIP))
    chains = [frames(q) for q in setpoints]
    points = np.array([[(chain[link] @ _shift(0, 0, along))[:3, 3] for link, along in marks] for chain in chains])
    return float(np.linalg.norm(np.diff(points, axis=0), axis=2).max() * RATE)


class Solids:
    """The arm's solids as points all over their surfaces, the carried object as it is grasped at `start`, if it is."""

    def __init__(self, scene: Scene, start: np.ndarray | None = None) -> None:
        self._scene = scene
        arm = [part for part in collision_solids() if part.link]
        self._links = np.array([part.link for part in arm])
        self._poses = np.array([_shift(*part.position) @ _rotation(part.orientation) for part in arm])
        self._points = [_surface(part.kind, part.size, part.outline) for part in arm]
        self._radii = np.array([np.linalg.norm(points, axis=1).max() for points in self._points])
        self._held: tuple[np.ndarray, np.ndarray] | None = None
        if scene.carried is not None and start is not None:
            grasp = np.linalg.inv(frames(start)[6]) @ _shift(*scene.carried.position)
            self._held = grasp, _surface(scene.carried.kind, scene.carried.size)

    def outside(self, q: np.ndarray, *, enough: float = np.inf) -> float:
        """Return the least distance [m] of arm and object from the obstacles, up to `enough`; negative inside."""
        chain, least = np.array(frames(q)), enough
        poses = chain[self._links] @ self._poses
        least = min(least, self._within_zones(self.points(q)))
        for shape in self._scene.obstacles:
            for part in np.flatnonzero(_distances(shape, poses[:, :3, 3]) - self._radii < least):
                least = min(least, _outside(shape, _moved(poses[part], self._points[part])))
        if self._held is not None:
            there = _moved(chain[6] @ self._held[0], self._held[1])
            free = [shape for shape in self._scene.obstacles if shape.name != "table"]  # on which it stands at first
            least = min(least, *(_outside(shape, there) for shape in free), np.inf)
        return float(least)

    def points(self, q: np.ndarray) -> np.ndarray:
        """Return points (n, 3) [m, world] on all that moves, the held object with it."""
        chain = np.array(frames(q))
        moving = [_moved(*part) for part in zip(chain[self._links] @ self._poses, self._points, strict=True)]
        if self._held is not None:
            moving.append(_moved(chain[6] @ self._held[0], self._held[1]))
        return np.concatenate(moving)

    def _within_zones(self, points: np.ndarray) -> float:
        """Return the least distance [m] of points from the floor, and from where the zones forbid to be."""
        inside = [-_inside_box(zone, points).max() for zone in self._scene.keep_in]
        outside = [_distances(zone, points).min() for zone in self._scene.keep_out]
        return float(min([points[:, 2].min() - self._scene.floor, *inside, *outside]))


def _inside_box(zone: Shape, points: np.ndarray) -> np.ndarray:
    """Return how far (n,) [m] points stick out of an upright box; negative inside."""
    return (np.abs(points - np.array(zone.position)) - np.array(zone.size) / 2).max(axis=1)


def _off_path(tools: np.ndarray, curve: Curve, count: int = 6000) -> float:
    twin = to_geomdl(curve)
    points = np.array(twin.evaluate_list(np.linspace(0.0, 1.0, count).tolist()))
    start, ahead = points[:-1], np.diff(points, axis=0)
    worst = 0.0
    for tool in tools:
        near = int(np.argmin(np.linalg.norm(points - tool, axis=1)))
        pieces = [k for k in (near - 1, near) if 0 <= k < len(start)]
        shares = [np.clip((tool - start[k]) @ ahead[k] / (ahead[k] @ ahead[k]), 0.0, 1.0) for k in pieces]
        offs = (np.linalg.norm(start[k] + t * ahead[k] - tool) for k, t in zip(pieces, shares, strict=True))
        worst = max(worst, min(offs))
    return float(worst)


def _surface(kind: str, size: Sequence[float], outline: Sequence[tuple[float, float]] = ()) -> np.ndarray:
    """Return points (n, 3) all over the surface of a solid, in its frame."""
    if kind == "sphere":
        k = np.arange(80) + 0.5
        polar, around = np.arccos(1 - 2 * k / 80), np.pi * (1 + np.sqrt(5)) * k
        return size[0] * np.column_stack(
            [np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar), np.cos(polar)]
        )
    if kind == "box":
        x, y = size[0] / 2, size[1] / 2
        outline, height = [(-x, -y), (x, -y), (x, y), (-x, y)], size[2]
    elif kind == "prism":
        height = size[0]
    else:
        angles = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
        outline, height = [(size[0] * np.cos(a), size[0] * np.sin(a)) for a in angles], size[1]
    corners = np.array([*outline, outline[0]])
    rim = np.concatenate([_between(a, b) for a, b in pairwise(corners)])
    centre = corners[:-1].mean(axis=0)
    disc = np.concatenate([centre + share * (rim - centre) for share in np.linspace(0.0, 1.0, 6)])
    levels = np.linspace(-height / 2, height / 2, 2 + int(height / SPACING))
    wall = np.concatenate([np.column_stack([rim, np.full(len(rim), level)]) for level in levels])
    caps = [np.column_stack([disc, np.full(len(disc), level)]) for level in levels[[0, -1]]]
    return np.concatenate([wall, *caps])


def _between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    count = 1 + int(np.linalg.norm(b - a) / SPACING)
    return a + np.linspace(0.0, 1.0, count, endpoint=False)[:, None] * (b - a)


def _outside(shape: Shape, points: np.ndarray) -> float:
    """Return the least distance [m] of points from an upright shape; negative inside."""
    return float(_distances(shape, points).min())


def _distances(shape: Shape, points: np.ndarray) -> np.ndarray:
    local = points - np.array(shape.position)
    if shape.kind == "sphere":
        return np.linalg.norm(local, axis=1) - shape.size[0]
    if shape.kind == "box":
        off = np.abs(local) - np.array(shape.size) / 2
    else:
        off = np.column_stack(
            [np.hypot(local[:, 0], local[:, 1]) - shape.size[0], np.abs(local[:, 2]) - shape.size[1] / 2]
        )
    return np.linalg.norm(np.maximum(off, 0.0), axis=1) + np.minimum(off.max(axis=1), 0.0)


def _moved(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ pose[:3, :3].T + pose[:3, 3]


def _shift(x: float, y: float, z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def _turn(axis: int, angle: float) -> np.ndarray:
    pose = np.eye(4)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    pose[i, i] = pose[j, j] = np.cos(angle)
    pose[j, i], pose[i, j] = np.sin(angle), -np.sin(angle)
    return pose


def _rotation(quaternion: Sequence[float]) -> np.ndarray:
    w, *v = quaternion
    cross = np.cross(np.eye(3), v)  # its product with a vector u is v x u
    pose = np.eye(4)
    pose[:3, :3] += 2 * w * cross + 2 * cross @ cross
    return pose
