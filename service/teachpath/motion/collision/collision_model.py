"""Measures the distances of arm and carried object to the scene and its zones, and between parts of the arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from teachpath.errors import UnusableInput
from teachpath.lengths import describe_lengths
from teachpath.motion.arm.convex_pieces import convex_shapes, whole_name
from teachpath.motion.arm.geometry import collision_solids, grips
from teachpath.motion.arm.kinematics import link_frames, tool_pose
from teachpath.motion.arm.mjcf import CARRIED_BODY, write_mjcf
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import Array
from teachpath.motion.arm.rotations import rotation_matrices
from teachpath.motion.arm.serial_kinematics import lever_arms as serial_lever_arms
from teachpath.motion.collision.boundaries import Boundary, Extent, boundary_distances, scene_boundaries
from teachpath.motion.collision.self_collision import checked_solid_pairs
from teachpath.records import Scene, Shape, Vector

MAX_DISTANCE: Final = 0.3  # m, larger distances are not measured
_ROTATING_COLUMN: Final = "trunk"


@dataclass(frozen=True, slots=True)
class Clearance:
    """A least distance [m] and the two bodies between which it is; negative where they overlap.

    Without names, the distance is at least this.
    """

    distance: float
    body: str
    other_body: str

    def describe_violation(self, distance: float, required: float) -> str:
        """Describe a distance [m] below the required one; a negative required distance is an allowed overlap."""
        measured, limit = describe_lengths(abs(distance), abs(required))
        if distance >= 0.0:
            return f"{self.body} comes within {measured} of {self.other_body}, least allowed {limit}"
        deep = f"{self.body} goes {measured} into {self.other_body}"
        if required < 0.0:
            return f"{deep}, at most {limit} are allowed"
        return f"{deep}, has to stay {limit} away"


@dataclass(frozen=True, eq=False)
class Load:
    """Where the carried object is: in the gripper (`grasp_pose`), or standing in the world (`position`).

    Attributes:
        grasp_pose: (4, 4) pose to tool from object.
        position: centre of the object [m, world].
        rotation: (3, 3) its orientation there, to world from object; None for the one that it has at its start.
    """

    grasp_pose: Array | None = None
    position: Vector | None = None
    rotation: Array | None = None


@dataclass(frozen=True)
class _Pairs:
    """What is measured: pairs of geoms, and geoms with the half-space that each stays in."""

    bodies: list[tuple[int, int]] = field(default_factory=list)
    boundaries: list[tuple[int, Boundary]] = field(default_factory=list)


class CollisionModel:
    """The arm's solids and one scene, ready to measure distances (MuJoCo, `mj_geomDistance`)."""

    def __init__(self, scene: Scene, arm: Arm) -> None:
        """Build the model; raise UnusableInput when a shape has no size, or two have one name."""
        self.scene: Scene = scene
        self.arm: Arm = arm
        try:
            self._model = mujoco.MjModel.from_xml_string(write_mjcf(scene, arm))
        except ValueError as error:
            raise UnusableInput(f"scene {scene.name!r} cannot be built: {' '.join(str(error).split())}") from None
        self._data = mujoco.MjData(self._model)
        self._solids = {self._id(part.name): part for part in collision_solids(arm)}
        self._self_pairs = checked_solid_pairs(self._solids, arm)
        self._names = {geom: part.name for geom, part in self._solids.items()}
        obstacles = {self._id(f"obstacle:{s.name}"): whole_name(s.name) for s in convex_shapes(scene.obstacles)}
        zones = {self._id(f"zone:{s.name}"): whole_name(s.name) for s in convex_shapes(scene.keep_out)}
        self._obstacles, self._zones = list(obstacles), list(zones)
        self._names |= obstacles | {geom: f"the keep-out zone {name}" for geom, name in zones.items()}
        self._boundaries = scene_boundaries(scene)
        self._object = self._id(CARRIED_BODY) if scene.carried else -1
        if scene.carried:
            self._names[self._object] = scene.carried.name
        moving = [*self._solids, *([self._object] if scene.carried else [])]
        self._extents = {geom: self._extent(geom) for geom in moving}
        self._closed = self._model.geom_pos.copy()

    def clearances(self, q: Array, *, load: Load | None = None, gripper_open: bool = False) -> list[Clearance]:
        """Measure the least distance between all bodies that must stay apart, for each configuration.

        Pairs that touch on purpose are left out: gripper and object, and the object and its support (see
        `support_distances`).

        Args:
            q: (n, joints) configurations [rad].
            load: where the carried object is; None when there is none.
            gripper_open: whether the fingers are apart.
        """
        return self._clearances(q, self._pairs(load), load, gripper_open)

    def support_distances(self, q: Array, load: Load) -> list[Clearance]:
        """Measure the distance (n rows) of the carried object to its support, on which it stands at its start."""
        return self._clearances(q, self._supports(), load, False)

    def finger_distances(self, q: Array, load: Load) -> list[Clearance]:
        """Measure the distance (n rows) of the open fingers, or the suction cup, to the object that stands there."""
        fingers = [geom for geom, part in self._solids.items() if grips(part)]
        return self._clearances(q, _Pairs([(finger, self._object) for finger in fingers]), load, True)

    def lever_arms(self, load: Load | None = None) -> Array:
        """Return bounds (joints,) [m] on the distance of any moving point to each joint's axis, wherever the arm is."""
        zero = np.zeros(self.arm.joint_count)
        self._place(zero, None)
        origins = link_frames(zero, self.arm)[:, :3, 3]
        radius = np.zeros(len(origins))
        for geom, part in self._solids.items():
            off = np.linalg.norm(self._data.geom_xpos[geom] - origins[part.link]) + np.linalg.norm(part.opening_offset)
            radius[part.link] = max(radius[part.link], off + self._model.geom_rbound[geom])
        if load is not None and load.grasp_pose is not None:
            off = np.linalg.norm((self.arm.tool_matrix @ load.grasp_pose)[:3, 3])
            radius[-1] = max(radius[-1], off + self._model.geom_rbound[self._object])
        if self.arm.model is not None:
            return serial_lever_arms(radius[1:], self.arm.model)
        lever_arms, far = np.zeros(6), 0.0  # far: from the frame behind a joint to any point that it moves
        for joint in range(5, -1, -1):
            far = max(far, radius[joint + 1])
            link = self.arm.links[joint]
            lever_arms[joint] = link.a + far
            far += float(np.hypot(link.a, link.d))
        return lever_arms

    def _id(self, name: str) -> int:
        return int(self._model.geom(name).id)

    def _extent(self, geom: int) -> Extent:
        kind, size = self._model.geom_type[geom], self._model.geom_size[geom]
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            return Extent(np.zeros((1, 3)), ball=float(size[0]))
        if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            return Extent(np.outer([-size[1], size[1]], [0.0, 0.0, 1.0]), disc=float(size[0]))
        if kind == mujoco.mjtGeom.mjGEOM_BOX:
            return Extent(size * list(product((-1.0, 1.0), repeat=3)))
        mesh = self._model.mesh(self._model.geom_dataid[geom])
        return Extent(self._model.mesh_vert[mesh.vertadr[0] :][: mesh.vertnum[0]].astype(np.float64))

    def _pairs(self, load: Load | None) -> _Pairs:
        supports, pairs = self._supports(), self._arm_pairs()
        if load is not None and load.grasp_pose is not None:
            around = [(self._object, other) for other in self._obstacles + self._zones]
            pairs.bodies.extend(pair for pair in around if pair not in supports.bodies)
            # The last link that is far from all that the fingers can hold.
            near = self.arm.joint_count - (2 if self.arm.model is None else 1)
            pairs.bodies.extend((self._object, geom) for geom, part in self._solids.items() if part.link <= near)
            sides = [(self._object, boundary) for boundary in self._boundaries]
            pairs.boundaries.extend(pair for pair in sides if pair not in supports.boundaries)
        elif load is not None:
            pairs.bodies.extend(
                (geom, self._object) for geom, part in self._solids.items() if part.link >= 2 and not grips(part)
            )
        return pairs

    def _arm_pairs(self) -> _Pairs:
        # The foot stands on the floor, and the column turns about its own axis: where they are, they always are.
        moving = [geom for geom, part in self._solids.items() if part.link >= 1 and part.name != _ROTATING_COLUMN]
        pairs = [(geom, other) for geom in moving for other in self._obstacles + self._zones]
        return _Pairs(pairs + self._self_pairs, [(geom, boundary) for geom in moving for boundary in self._boundaries])

    def _supports(self, touching: float = 0.003) -> _Pairs:
        """Return what the object stands on at its start: obstacles, or the floor."""
        carried = self.scene.carried
        if carried is None:
            return _Pairs()
        places, turns = self._geom_poses(np.zeros((1, self.arm.joint_count)), [shape_pose(carried)])
        floor = (self._object, self._boundaries[0])
        on_floor = boundary_distances([floor], self._extents, places, turns)[0, 0] <= touching
        near = [other for other in self._obstacles if self._distance(self._object, other, MAX_DISTANCE) <= touching]
        return _Pairs([(self._object, other) for other in near], [floor] if on_floor else [])

    def _placed_pose(self, load: Load | None) -> Array | None:
        """Return the pose (4, 4) of an object that stands in the world; None where there is none."""
        carried = self.scene.carried
        if load is None or load.position is None or carried is None:
            return None
        pose = shape_pose(carried)
        pose[:3, 3] = load.position
        if load.rotation is not None:
            pose[:3, :3] = load.rotation
        return pose

    def _place(self, q: Array, pose: Array | None) -> None:
        count, qpos = len(q), self._data.qpos
        qpos[:count] = q
        if pose is not None:
            qpos[count : count + 3] = pose[:3, 3]
            mujoco.mju_mat2Quat(qpos[count + 3 : count + 7], np.ascontiguousarray(pose[:3, :3]).ravel())
        mujoco.mj_kinematics(self._model, self._data)

    def _distance(self, one: int | np.int64, two: int | np.int64, furthest: float) -> float:
        return float(mujoco.mj_geomDistance(self._model, self._data, int(one), int(two), furthest, None))

    def _clearances(self, q: Array, pairs: _Pairs, load: Load | None, gripper_open: bool) -> list[Clearance]:
        self._model.geom_pos[:] = self._closed
        if gripper_open:
            for geom, part in self._solids.items():
                self._model.geom_pos[geom] += part.opening_offset
        q = np.atleast_2d(q)
        held = tool_pose(q, self.arm) @ load.grasp_pose if load is not None and load.grasp_pose is not None else None
        standing = self._placed_pose(load)
        objects = [standing if held is None else held[index] for index in range(len(q))]
        places, turns = self._geom_poses(q, objects)
        rows = self._body_clearances(q, pairs.bodies, objects, places, turns)
        if pairs.boundaries:
            gaps = boundary_distances(pairs.boundaries, self._extents, places, turns)
            for index, column in enumerate(gaps.argmin(axis=1)):
                geom, boundary = pairs.boundaries[column]
                if (gap := float(gaps[index, column])) < rows[index].distance:
                    rows[index] = Clearance(gap, self._names[geom], boundary.name)
        return rows

    def _body_clearances(
        self, q: Array, pairs: list[tuple[int, int]], objects: Sequence[Array | None], places: Array, turns: Array
    ) -> list[Clearance]:
        pair = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        bounds = self._distance_bounds(pair, places, turns)
        rows, nearest = [], 0
        for gap, row, pose in zip(bounds, q, objects, strict=True):
            self._place(row, pose)
            # The nearest pair of the row before is mostly the nearest again; then few others have to be measured.
            best = self._distance(pair[nearest, 0], pair[nearest, 1], MAX_DISTANCE) if len(pair) else MAX_DISTANCE
            close = np.flatnonzero(gap < best)
            for k in close[np.argsort(gap[close])].tolist():
                if gap[k] >= best:
                    break
                distance = self._distance(pair[k, 0], pair[k, 1], max(best, 0.001))
                if distance < best:
                    best, nearest = distance, k
            one, other = (self._names[int(geom)] for geom in pair[nearest]) if best < MAX_DISTANCE else ("", "")
            rows.append(Clearance(best, one, other))
        return rows

    def _geom_poses(self, q: Array, objects: Sequence[Array | None]) -> tuple[Array, Array]:
        """Return positions (n, geoms, 3) and rotations (n, geoms, 3, 3) of all solids."""
        places = np.empty((len(q), self._model.ngeom, 3))
        turns = np.empty((len(q), self._model.ngeom, 9))
        for index, (row, pose) in enumerate(zip(q, objects, strict=True)):
            self._place(row, pose)
            places[index], turns[index] = self._data.geom_xpos, self._data.geom_xmat
        return places, turns.reshape(len(q), -1, 3, 3)

    def _distance_bounds(self, pair: NDArray[np.int64], places: Array, turns: Array) -> Array:
        """Return quick lower bounds (n, pairs) of distances: between bounding spheres, or a bounding sphere and a box.

        Args:
            pair: (pairs, 2) indices of geoms.
            places: (n, geoms, 3) positions of the solids.
            turns: (n, geoms, 3, 3) their rotations.
        """
        radii = self._model.geom_rbound[pair]  # (pairs, 2) of the two bounding spheres
        boxes = np.flatnonzero(self._model.geom_type[pair[:, 1]] == mujoco.mjtGeom.mjGEOM_BOX)  # as large as a table
        apart = places[:, pair[:, 0]] - places[:, pair[:, 1]]
        gaps = np.linalg.norm(apart, axis=2) - radii.sum(axis=1)
        box = pair[boxes, 1]
        inside = np.einsum("npj,npjk->npk", apart[:, boxes], turns[:, box])
        off = np.maximum(np.abs(inside) - self._model.geom_size[box], 0.0)
        gaps[:, boxes] = np.maximum(gaps[:, boxes], np.linalg.norm(off, axis=2) - radii[boxes, 0])
        return np.asarray(gaps, dtype=np.float64)


def grasped_load(model: CollisionModel, start: Array) -> Load | None:
    """Return the load after the scene's object was grasped at configuration `start` (joints,); None without one."""
    carried = model.scene.carried
    if carried is None:
        return None
    return Load(grasp_pose=np.linalg.inv(tool_pose(start, model.arm)) @ shape_pose(carried))


def shape_pose(shape: Shape) -> Array:
    """Return the pose (4, 4) to world from a shape, as its scene has it."""
    pose = np.eye(4)
    pose[:3, :3] = rotation_matrices(np.array([shape.orientation]))[0]
    pose[:3, 3] = shape.position
    return pose
