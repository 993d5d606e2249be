"""Commands for meshcat's viewer, as bytes, from shapes, lines and poses.

meshcat (R. Deits, MIT) builds the commands and its viewer draws them. Its own server is never started, because it
listens on every interface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import umsgpack

from teachpath.errors import UnusableInput
from teachpath.live.preview.bare_package import without_init
from teachpath.records import Array, Quaternion, Vector

with without_init("meshcat"):  # which imports the server, and with it tornado, pyzmq, IPython and Pillow
    from meshcat import commands, geometry
    from meshcat.path import Path as TreePath

Outline = Sequence[tuple[float, float]]

BEVEL = 0.006  # [m] width of the broken edges of prisms

# three.js lays a cylinder along y; ours stand along z.
_Z_UP_ROTATION = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def solid(
    path: str,
    kind: str,
    size: Sequence[float],
    *,
    pose: Array | None = None,
    color: int = 0x8090A0,
    outline: Outline = (),
    vertices: Sequence[Vector] = (),
) -> bytes:
    """Draw one solid body.

    Args:
        path: place in the tree, e.g. `/scene/table`.
        kind: `box` (size: edges x, y, z), `cylinder` (radius, height; along z), `sphere` (radius), `prism`
            (thickness along z, with a convex, counter-clockwise `outline` in its xy plane) or `mesh` (factor to
            metres, with `vertices`, three a triangle) [m].
        pose: (4, 4) to the frame of `path` from the body's centre; None is the identity.
        color: 0xRRGGBB.

    Raises:
        UnusableInput: the kind is unknown.
    """
    pose = np.eye(4) if pose is None else pose
    shape: geometry.Geometry
    if kind == "box":
        shape = geometry.Box([float(edge) for edge in size])
    elif kind == "cylinder":
        shape = geometry.Cylinder(float(size[1]), float(size[0]))
        pose = pose @ _Z_UP_ROTATION
    elif kind == "sphere":
        shape = geometry.Sphere(float(size[0]))
    elif kind == "prism":
        shape = geometry.TriangularMeshGeometry(*prism_mesh(outline, size[0]))
    elif kind == "mesh":
        corners = size[0] * np.array(vertices)
        shape = geometry.TriangularMeshGeometry(corners, np.arange(len(corners)).reshape(-1, 3))
    else:
        raise UnusableInput(f"{path} cannot be drawn: {kind!r} is no box, cylinder, sphere, prism or mesh")
    return _object(path, geometry.Mesh(shape, _paint(color)), pose)


def line(path: str, points: Array, *, color: int) -> bytes:
    """Draw a thin line through `points`: (n, 3) [m], frame of `path`."""
    material = geometry.LineBasicMaterial(color=color)
    return _object(path, geometry.Line(geometry.PointsGeometry(points.T.astype(np.float32)), material))


def prism_mesh(outline: Outline, thickness: float, bevel: float = BEVEL) -> tuple[Array, Array]:
    """Return (8 n, 3) vertices and (m, 3) faces of a convex prism with broken edges, centred in z.

    Walls, bevels and caps have vertices of their own, so that the viewer's normals are sharp between them and smooth
    around.

    Args:
        outline: n corners in its xy plane, counter-clockwise [m].
        thickness: along z [m].
        bevel: width of the broken edges [m]; the outer measures stay as they are.
    """
    n, half = len(outline), thickness / 2
    ring = np.asarray(outline, dtype=np.float64)
    inner = _inset(ring, bevel)
    low, high = -half + bevel, half - bevel
    levels = [(ring, low), (ring, high), (ring, high), (inner, half), (inner, -half), (ring, low)]
    levels += [(inner, -half), (inner, half)]
    vertices = np.concatenate([np.column_stack([points, np.full(n, z)]) for points, z in levels])
    here = np.arange(n)
    beside = np.roll(here, -1)
    faces = []
    for one in (0, 2, 4):  # wall, upper bevel, lower bevel: from one ring up to the next
        a, b = here + one * n, beside + one * n
        faces += [np.stack([a, b, a + n], axis=-1), np.stack([b, b + n, a + n], axis=-1)]
    fan = np.stack([np.zeros(n - 2, dtype=int), here[1:-1], here[2:]], axis=-1)
    return vertices, np.concatenate([*faces, fan[:, ::-1] + 6 * n, fan + 7 * n])


def _inset(ring: Array, width: float) -> Array:
    """Move every corner of a convex outline (n, 2) inwards, by `width` from both of its sides."""
    ahead = np.roll(ring, -1, axis=0) - ring
    normals = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / np.linalg.norm(ahead, axis=1)[:, None]
    middle = normals + np.roll(normals, 1, axis=0)
    return np.asarray(ring + 2 * width * middle / np.sum(middle**2, axis=1)[:, None])


def pose_of(position: Vector, orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)) -> Array:
    """Return the (4, 4) pose of a position [m] and a unit quaternion."""
    w, x, y, z = orientation
    pose = np.eye(4)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    pose[:3, 3] = position
    return pose


def transform(path: str, pose: Array) -> bytes:
    """Put what is at `path` to `pose`: (4, 4), to the frame of the path above."""
    return _pack(commands.SetTransform(pose, _tree(path)).lower())


def delete(path: str) -> bytes:
    """Remove all at and below `path`."""
    return _pack(commands.Delete(_tree(path)).lower())


def _object(path: str, drawn: geometry.Object, pose: Array | None = None) -> bytes:
    command = commands.SetObject(drawn, path=_tree(path)).lower()
    if pose is not None:
        command["object"]["object"]["matrix"] = pose.T.ravel().tolist()  # three.js reads column by column
    return _pack(command)


def _paint(color: int) -> geometry.Material:
    return geometry.MeshPhongMaterial(color=color, side=0, shininess=28, specular=0x2A2A2A)


def _tree(path: str) -> TreePath:
    return TreePath(tuple(name for name in path.split("/") if name))


def _pack(command: dict[str, object]) -> bytes:
    packed: bytes = umsgpack.packb(command)
    return packed
