"""How far the arm and what it carries stay away from the scene, from each other and from the arm itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Final

import mujoco
import numpy as np

from teachpath.errors import UnusableInput
from teachpath.motion.drawing import Part, drawing
from teachpath.motion.kinematics import tool_pose
from teachpath.motion.mjcf import CARRIED, mjcf
from teachpath.motion.puma560 import Array
from teachpath.records import Scene, Vector

FAR: Final = 0.5  # m, distances are not looked at beyond this
# Neighbours touch by design, and of these pairs of links the distance hardly changes: their joints' limits keep them.
_NEVER_MEET: Final = {(0, 1), (0, 2), (1, 2), (2, 3), (3, 4), (3, 5), (4, 5), (4, 6), (5, 6)}
_TURNS_IN_PLACE: Final = "trunk"


@dataclass(frozen=True, slots=True)
class Clearance:
    """A least distance [m] (negative: how deep they overlap), at which of the configurations, and between whom."""

    distance: float
    index: int
    part: str
    other: str


@dataclass(frozen=True, eq=False)
class Load:
    """Where the carried object is: in the gripper (`grasp`), or standing in the world (`placed`).

    Attributes:
        grasp: (4, 4) pose to tool from object.
        placed: centre of the object, upright [m].
    """

    grasp: Array | None = None
    placed: Vector | None = None


class CollisionModel:
    """The arm's solids and one scene, ready to measure distances (MuJoCo, `mj_geomDistance`)."""

    def __init__(self, scene: Scene) -> None:
        """Build the model; raises UnusableInput when the scene has a shape without size, or two of one name."""
        self.scene = scene
        try:
            self._model = mujoco.MjModel.from_xml_string(mjcf(scene))
        except ValueError as error:
            raise UnusableInput(f"scene {scene.name!r} cannot be built: {error}") from None
        self._data = mujoco.MjData(self._model)
        self._parts = {self._id(part.name): part for part in drawing()}
        self._names = {geom: part.name for geom, part in self._parts.items()}
        self._obstacles = []
        for shape in scene.obstacles:
            self._obstacles.append(self._id(f"obstacle:{shape.name}"))
            self._names[self._obstacles[-1]] = shape.name
        self._object = self._id(CARRIED) if scene.carried else -1
        if scene.carried:
            self._names[self._object] = scene.carried.name
        self._closed = self._model.geom_pos.copy()

    def clearance(self, q: Array, *, load: Load | None = None, gripper_open: bool = False) -> Clearance:
        """Measure the least distance of everything that should stay apart.

        Left out are pairs that touch on purpose: gripper and object, and the object on what it stands on at its
        start (see `support`).

        Args:
            q: (n, 6) configurations [rad].
            load: where the carried object is; None when there is none.
            gripper_open: whether the fingers are apart.
        """
        return min(self._rows(q, self._pairs(load), load, gripper_open, alone=False), key=lambda row: row.distance)

    def profile(self, q: Array, *, load: Load | None = None, gripper_open: bool = False) -> list[Clearance]:
        """Measure the same for each configuration by itself."""
        return list(self._rows(q, self._pairs(load), load, gripper_open, alone=True))

    def support(self, q: Array, load: Load) -> Clearance:
        """Measure the least distance of the carried object to what it stands on at its start (0: they touch)."""
        return min(self.supports(q, load), key=lambda row: row.distance)

    def supports(self, q: Array, load: Load) -> list[Clearance]:
        """Measure the same for each configuration by itself."""
        pairs = [(self._object, other) for other in self._standing_on()]
        return list(self._rows(q, pairs, load, False, alone=True))

    def straddle(self, q: Array, load: Load) -> Clearance:
        """Measure the least distance of the open fingers to the object that stands between them."""
        fingers = [geom for geom, part in self._parts.items() if part.opens[1]]
        pairs = [(finger, self._object) for finger in fingers]
        return min(self._rows(q, pairs, load, True, alone=False), key=lambda row: row.distance)

    def _id(self, name: str) -> int:
        return int(self._model.geom(name).id)

    def _pairs(self, load: Load | None) -> list[tuple[int, int]]:
        supports, pairs = self._standing_on(), self._arm_pairs()
        if load is not None and load.grasp is not None:
            pairs += [(self._object, other) for other in self._obstacles if other not in supports]
            pairs += [(self._object, geom) for geom, part in self._parts.items() if part.link <= 4]
        elif load is not None:
            pairs += [
                (geom, self._object) for geom, part in self._parts.items() if part.link >= 2 and not part.opens[1]
            ]
        return pairs

    def _arm_pairs(self) -> list[tuple[int, int]]:
        moving = [geom for geom, part in self._parts.items() if part.link >= 1 and part.name != _TURNS_IN_PLACE]
        pairs = [(geom, obstacle) for geom in moving for obstacle in self._obstacles]
        for (one, a), (two, b) in combinations(self._parts.items(), 2):
            if _may_meet(a, b):
                pairs.append((one, two))
        return pairs

    def _standing_on(self, touching: float = 0.003) -> set[int]:
        carried = self.scene.carried
        if carried is None:
            return set()
        self._place(np.zeros(6), None, carried.position)
        return {other for other in self._obstacles if self._distance(self._object, other, FAR) <= touching}

    def _place(self, q: Array, held: Array | None, placed: Vector | None) -> None:
        data = self._data
        data.qpos[:6] = q
        if held is not None:
            data.qpos[6:9] = held[:3, 3]
            mujoco.mju_mat2Quat(data.qpos[9:13], np.ascontiguousarray(held[:3, :3]).ravel())
        elif placed is not None:
            data.qpos[6:9] = placed
            data.qpos[9:13] = (1.0, 0.0, 0.0, 0.0)
        mujoco.mj_kinematics(self._model, data)

    def _distance(self, one: int, two: int, furthest: float) -> float:
        return float(mujoco.mj_geomDistance(self._model, self._data, one, two, furthest, None))

    def _rows(
        self, q: Array, pairs: Iterable[tuple[int, int]], load: Load | None, gripper_open: bool, *, alone: bool
    ) -> Iterator[Clearance]:
        """Measure row by row; unless each stands `alone`, a row that is farther than one before says only that."""
        self._model.geom_pos[:] = self._closed
        if gripper_open:
            for geom, part in self._parts.items():
                self._model.geom_pos[geom] += part.opens
        q = np.atleast_2d(q)
        held = None
        if load is not None and load.grasp is not None:
            held = tool_pose(q) @ load.grasp
        pair = np.array(list(pairs), dtype=np.int64).reshape(-1, 2)
        reach = self._model.geom_rbound[pair].sum(axis=1)  # (pairs,) of the two bounding spheres
        furthest = FAR
        for index, row in enumerate(q):
            self._place(row, None if held is None else held[index], None if load is None else load.placed)
            centres = self._data.geom_xpos[pair]
            gap = np.linalg.norm(centres[:, 0] - centres[:, 1], axis=1) - reach
            best = Clearance(furthest, index, "", "")
            for k in np.argsort(gap):
                if gap[k] >= best.distance:
                    break
                distance = self._distance(int(pair[k, 0]), int(pair[k, 1]), max(best.distance, 0.001))
                if distance < best.distance:
                    best = Clearance(distance, index, *(self._names[int(g)] for g in pair[k]))
            furthest = FAR if alone else best.distance
            yield best


def grasp_of(scene: Scene, start: Array) -> Load | None:
    """Return how the scene's object is held once it was grasped at configuration `start` (6,); None without one."""
    if scene.carried is None:
        return None
    upright = np.eye(4)
    upright[:3, 3] = scene.carried.position
    return Load(grasp=np.linalg.inv(tool_pose(start)) @ upright)


def _may_meet(a: Part, b: Part) -> bool:
    low, high = sorted((a.link, b.link))
    return low != high and (low, high) not in _NEVER_MEET
