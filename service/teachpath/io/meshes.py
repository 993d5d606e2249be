"""Meshes from files, as their convex hull or as convex pieces."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import chain
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from teachpath.errors import UnusableInput
from teachpath.io import mesh_pieces
from teachpath.records import Vector

MAX_FILE_SIZE: Final = 50_000_000  # bytes
HEADER: Final = 84  # bytes before the triangles of a binary STL: a comment and their number
FILE_SUFFIXES: Final = tuple(sorted((".obj", ".stl", *mesh_pieces.SUFFIXES)))
MAX_PIECES: Final = 32
TRIANGLE: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class Mesh(NamedTuple):
    """What takes a mesh's place: three corners a triangle, counter-clockwise from outside, in the file's units.

    Attributes:
        vertices: of its convex hull, or of its convex pieces, one after the other.
        pieces: number of triangles of each; empty: it is one hull.
    """

    vertices: tuple[Vector, ...]
    pieces: tuple[int, ...] = ()


def read_mesh(file: Path, name: str = "", max_pieces: int = 1) -> Mesh:
    """Read a mesh's convex hull, or the convex pieces that it is cut into.

    Args:
        file: to read.
        name: that the mesh goes by, whose end says what it is; that of the file when empty.
        max_pieces: most pieces, to `MAX_PIECES`; 1: its hull.

    Raises:
        UnusableInput: the file is missing, too large, of no known kind, torn, or flat; a library is missing; there
            cannot be so many pieces.
    """
    name = name or str(file)
    if not 1 <= max_pieces <= MAX_PIECES:
        raise UnusableInput(f"mesh {name} in {max_pieces} pieces; 1 to {MAX_PIECES} are possible")
    try:
        if file.stat().st_size > MAX_FILE_SIZE:
            raise UnusableInput(f"mesh {name} has {file.stat().st_size} bytes, limit {MAX_FILE_SIZE}; simplify it")
        content = file.read_bytes()
    except OSError as error:
        raise UnusableInput(f"cannot read the mesh {name}: {error.strerror}") from None
    if max_pieces == 1:
        return Mesh(convex_hull(_corners(content, name), name))
    _suffix(name)
    return joined(convex_hull(piece, name) for piece in mesh_pieces.convex_pieces(content, name, max_pieces))


def joined(hulls: Iterable[tuple[Vector, ...]]) -> Mesh:
    """Return hulls as the pieces of one mesh; one alone is no piece."""
    found = list(hulls)
    pieces = tuple(len(hull) // 3 for hull in found)
    return Mesh(tuple(chain.from_iterable(found)), pieces if len(pieces) > 1 else ())


def convex_hull(corners: ArrayLike, name: str) -> tuple[Vector, ...]:
    """Return the convex hull of points (n, 3): three corners a triangle, counter-clockwise from outside.

    Args:
        corners: in any unit.
        name: of the mesh, for the refusal.

    Raises:
        UnusableInput: fewer than 4 points, one that is not finite, or all of them in a plane.
    """
    points = np.asarray(corners, dtype=np.float64)
    if len(points) < 4:
        raise UnusableInput(f"mesh {name} has {len(points)} corners; a body needs 4 at least")
    if not np.all(np.isfinite(points)):
        raise UnusableInput(f"mesh {name} has a corner that is not finite")
    try:
        hull = scipy.spatial.ConvexHull(points)
    except scipy.spatial.QhullError:
        raise UnusableInput(f"mesh {name} is flat; a body has three dimensions") from None
    triangles = points[hull.simplices]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return tuple((float(x), float(y), float(z)) for x, y, z in triangles.reshape(-1, 3))


def _corners(content: bytes, name: str) -> NDArray[np.float64]:
    kind = _suffix(name)
    if kind in mesh_pieces.SUFFIXES:
        return mesh_pieces.read_corners(content, name)
    if kind == ".obj":
        found = re.findall(rb"^v\s+(\S+)\s+(\S+)\s+(\S+)", content, re.MULTILINE)
    elif kind == ".stl" and content[:5] == b"solid" and b"facet" in content[:1000]:
        found = re.findall(rb"^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)", content, re.MULTILINE)
    else:
        return _binary_stl(content, name)
    try:
        return np.array(found, dtype=np.float64).reshape(-1, 3)
    except ValueError:
        raise UnusableInput(f"mesh {name} has a corner that is no number") from None


def _suffix(name: str) -> str:
    kind = Path(name).suffix.lower()
    if kind not in FILE_SUFFIXES:
        raise UnusableInput(f"mesh {name} ends in {kind!r}; known: {', '.join(FILE_SUFFIXES)}")
    return kind


def _binary_stl(content: bytes, name: str) -> NDArray[np.float64]:
    count = int.from_bytes(content[HEADER - 4 : HEADER], "little")
    if len(content) < HEADER or len(content) != HEADER + count * TRIANGLE.itemsize:
        raise UnusableInput(
            f"mesh {name} is torn: {count} triangles need {HEADER + 50 * count} bytes, {len(content)} are there"
        )
    triangles = np.frombuffer(content, TRIANGLE, offset=HEADER)
    return triangles["corners"].reshape(-1, 3).astype(np.float64)
