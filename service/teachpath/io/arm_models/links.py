"""The links of an arm: all bodies that a joint moves together, with their pose, mass and solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import mujoco
import numpy as np
import scipy

from teachpath.errors import UnusableInput
from teachpath.io.arm_models.chain import Chain, joints_to, last_joint
from teachpath.io.arm_models.model_file import ModelFile
from teachpath.records import Array, Pose, Shape, Vector
from teachpath.records.serial_arms import NO_POSE

GEOM: Final = mujoco.mjtGeom
MAX_HULL_CORNERS: Final = 200  # of a mesh's hull; one with more is bounded by fewer planes
MAX_PLANES: Final = 120
MAX_PLANE_COSINE: Final = 0.97  # of the angle between two of them, 14 degrees
PLANE_MARGIN: Final = 1e-7  # m, more than rounding


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg], its centre (3,) [m], and moments of inertia (3, 3) about the centre [kg m^2], along a link's axes."""

    mass: float
    center: Array
    inertia: Array


def bodies_of(file: ModelFile, chain: Chain) -> list[list[int]]:
    """Return the bodies that do not move, and for each joint of the arm those that move with its link."""
    groups: list[list[int]] = [[] for _ in range(len(chain.joints) + 1)]
    for body in range(file.model.nbody):
        way = joints_to(file.model, last_joint(file.model, body))
        groups[sum(joint in chain.joints for joint in way)].append(body)
    return groups


def relative_pose(model: mujoco.MjModel, body: int, ancestor: int) -> Pose:
    """Return the pose to the frame of an ancestor (0: the model's own) from that of a body, as the model stands."""
    pose = NO_POSE
    while body != ancestor:
        pose = product(_pose(model.body_pos[body], model.body_quat[body]), pose)
        body = int(model.body_parentid[body])
    return pose


def link_pose(model: mujoco.MjModel, chain: Chain, number: int) -> Pose:
    """Return the pose to the link before (the model's frame for the first) from link `number`, 0 the first."""
    body = int(model.jnt_bodyid[chain.joints[number]])
    before = int(model.jnt_bodyid[chain.joints[number - 1]]) if number else 0
    return relative_pose(model, body, before)


def tool_pose(model: mujoco.MjModel, chain: Chain) -> Pose:
    """Return the pose to the last link from the tool that the model has."""
    pose = relative_pose(model, chain.tool_body, int(model.jnt_bodyid[chain.joints[-1]]))
    if chain.tool_site is None:
        return pose
    return product(pose, _pose(model.site_pos[chain.tool_site], model.site_quat[chain.tool_site]))


def joined_inertial(model: mujoco.MjModel, bodies: Sequence[int], link: int) -> Inertial:
    """Return mass, centre and inertia of bodies together, in the frame of the body `link`."""
    parts = [_inertial(model, body, link) for body in bodies if model.body_mass[body] > 0.0]
    mass = sum(part.mass for part in parts)
    if mass == 0.0:
        return Inertial(0.0, np.zeros(3), np.zeros((3, 3)))
    center = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        off = part.center - center
        inertia += part.inertia + part.mass * (off @ off * np.eye(3) - np.outer(off, off))
    return Inertial(mass, center, inertia)


def solids_of(file: ModelFile, bodies: Sequence[int], link: int) -> tuple[Shape, ...]:
    """Return what may collide of bodies, in the frame of the body `link`."""
    model, solids = file.model, list[Shape]()
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        collides = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if body not in bodies or not collides or model.geom_type[geom] == int(GEOM.mjGEOM_PLANE):
            continue
        pose = relative_pose(model, body, link)
        name = f"{model.body(body).name or 'base'} {len(solids) + 1}"
        solids += _solids(file, geom, name, product(pose, _pose(model.geom_pos[geom], model.geom_quat[geom])))
    return tuple(solids)


def bounding_corners(corners: Array, hull: scipy.spatial.ConvexHull) -> Array:
    """Return the corners (k, 3) of a polyhedron around a convex hull, which touches it at few planes.

    Args:
        corners: (n, 3) of which it is the hull.
        hull: with more corners than distances are measured of quickly.
    """
    sides = hull.simplices
    edges = corners[sides[:, 1:]] - corners[sides[:, :1]]
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    normals = [*np.eye(3), *-np.eye(3)]  # with which every hull is bounded
    for normal in hull.equations[np.argsort(-areas), :3]:
        if len(normals) < MAX_PLANES and max(normal @ other for other in normals) < MAX_PLANE_COSINE:
            normals.append(normal)
    planes = np.array(normals)
    offsets = (corners @ planes.T).max(axis=0) + PLANE_MARGIN
    inside = corners[hull.vertices].mean(axis=0)
    found = scipy.spatial.HalfspaceIntersection(np.column_stack([planes, -offsets]), inside).intersections
    return np.asarray(found, dtype=np.float64)


def product(one: Pose, two: Pose) -> Pose:
    """Return the pose that comes of two, one behind the other."""
    position, turn = np.zeros(3), np.zeros(4)
    mujoco.mju_mulPose(position, turn, *(np.array(part) for pose in (one, two) for part in pose))
    return _pose(position, turn)


def _pose(position: Array, orientation: Array) -> Pose:
    w, x, y, z = (float(v) for v in orientation / np.linalg.norm(orientation))
    return _vector(position), (w, x, y, z)


def _vector(values: Array) -> Vector:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _inertial(model: mujoco.MjModel, body: int, link: int) -> Inertial:
    position, turn = product(relative_pose(model, body, link), _pose(model.body_ipos[body], model.body_iquat[body]))
    rows = np.zeros(9)
    mujoco.mju_quat2Mat(rows, np.array(turn))
    axes = rows.reshape(3, 3)
    return Inertial(float(model.body_mass[body]), np.array(position), axes * model.body_inertia[body] @ axes.T)


def _solids(file: ModelFile, geom: int, name: str, pose: Pose) -> list[Shape]:
    """Return the shapes that fill the place of a solid, an ellipsoid the box around it."""
    kind, (a, b, c) = GEOM(int(file.model.geom_type[geom])), (float(v) for v in file.model.geom_size[geom])
    position, turn = pose
    if kind == GEOM.mjGEOM_SPHERE:
        return [Shape(name, "sphere", (a,), position, orientation=turn)]
    if kind == GEOM.mjGEOM_CYLINDER:
        return [Shape(name, "cylinder", (a, 2 * b), position, orientation=turn)]
    if kind == GEOM.mjGEOM_CAPSULE:
        ends = [product(pose, ((0.0, 0.0, side * b), NO_POSE[1]))[0] for side in (-1.0, 1.0)]
        balls = [Shape(f"{name} end {k + 1}", "sphere", (a,), end) for k, end in enumerate(ends)]
        return [Shape(name, "cylinder", (a, 2 * b), position, orientation=turn), *balls]
    if kind in (GEOM.mjGEOM_BOX, GEOM.mjGEOM_ELLIPSOID):
        return [Shape(name, "box", (2 * a, 2 * b, 2 * c), position, orientation=turn)]
    if kind == GEOM.mjGEOM_MESH:
        return [Shape(name, "mesh", (1.0,), position, orientation=turn, vertices=_hull(file, geom))]
    raise UnusableInput(
        f"{file.path}: {name} is of kind {kind.name.removeprefix('mjGEOM_').lower()}; the links of an arm take boxes, "
        "cylinders, capsules, spheres, ellipsoids and meshes"
    )


def _hull(file: ModelFile, geom: int) -> tuple[Vector, ...]:
    """Return the convex hull of a mesh, or what bounds it: three corners a triangle, counter-clockwise from outside."""
    mesh = file.model.mesh(int(file.model.geom_dataid[geom]))
    corners = file.model.mesh_vert[mesh.vertadr[0] :][: mesh.vertnum[0]].astype(np.float64)
    try:
        hull = scipy.spatial.ConvexHull(corners)
        if len(hull.vertices) > MAX_HULL_CORNERS:
            corners = bounding_corners(corners, hull)
            hull = scipy.spatial.ConvexHull(corners)
    except scipy.spatial.QhullError:
        raise UnusableInput(f"{file.path}: the mesh {mesh.name} is flat; a link has three dimensions") from None
    triangles = corners[hull.simplices]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return tuple(_vector(corner) for corner in triangles.reshape(-1, 3))
