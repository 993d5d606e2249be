"""Meshes as convex pieces, by trimesh and CoACD: the hull of a bin would fill it, its pieces leave its inside free."""

from __future__ import annotations

import io
from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Final

import numpy as np
import scipy
from numpy.typing import NDArray

from teachpath.errors import UnusableInput

if TYPE_CHECKING:
    import trimesh

SUFFIXES: Final = (".glb", ".ply")  # of files that trimesh reads; OBJ and STL need it for their triangles alone
SEED: Final = 0
SAMPLES: Final = 20_000  # places on the surface, of which each must be within a piece
LARGEST_OUTSIDE: Final = 0.01  # of the extent; pieces that leave more of the surface out are of another body
# Of CoACD's search: its own ones take much longer, and cut an open box no better.
SEARCH: Final = {
    "mcts_iterations": 30,
    "mcts_nodes": 10,
    "mcts_max_depth": 2,
    "resolution": 1000,
    "preprocess_resolution": 40,
}

Array = NDArray[np.float64]


def read_corners(content: bytes, name: str) -> Array:
    """Return the corners (n, 3) of a mesh in the file's units.

    Raises:
        UnusableInput: trimesh is missing, or the file is none of its kind.
    """
    return np.asarray(_mesh(content, name).vertices, dtype=np.float64)


def convex_pieces(content: bytes, name: str, max_pieces: int) -> list[Array]:
    """Return the corners (n, 3) of convex pieces that hold a mesh's surface together, in the file's units.

    They are grown by what is found outside of them at `SAMPLES` places, so that no obstacle is smaller than its mesh.

    Args:
        content: of the file.
        name: that the mesh goes by, whose end says what it is.
        max_pieces: most pieces, from 2 on.

    Raises:
        UnusableInput: trimesh or CoACD is missing, the file is none of its kind, or pieces do not hold it.
    """
    mesh = _mesh(content, name)
    _need("coacd")
    import coacd
    from trimesh.sample import sample_surface

    if len(mesh.faces) == 0:
        raise UnusableInput(f"mesh {name} has no triangles, so it has no pieces; leave `max_pieces` out for its hull")
    coacd.set_log_level("off")
    body = coacd.Mesh(mesh.vertices, mesh.faces)
    found = coacd.run_coacd(body, max_convex_hull=max_pieces, seed=SEED, **SEARCH)
    pieces = [np.asarray(corners, dtype=np.float64) for corners, _ in found]
    samples, _ = sample_surface(mesh, SAMPLES, seed=SEED)
    return grown_pieces(pieces, np.concatenate([samples, mesh.vertices[np.unique(mesh.faces)]]), name)


def grown_pieces(pieces: Sequence[Array], surface: Array, name: str) -> list[Array]:
    """Return convex pieces, each larger by as much as places of the surface lie outside of all of them.

    Args:
        pieces: corners (n, 3) of each.
        surface: places (m, 3) of the mesh.
        name: of the mesh, for the refusal.

    Raises:
        UnusableInput: a piece is flat, or the surface lies farther outside than `LARGEST_OUTSIDE` of its extent.
    """
    try:
        planes = [scipy.spatial.ConvexHull(piece).equations for piece in pieces]
    except scipy.spatial.QhullError:
        raise UnusableInput(
            f"mesh {name} has a flat piece; a body has three dimensions, ask for fewer pieces"
        ) from None
    outside = np.min([(surface @ p[:, :3].T + p[:, 3]).max(axis=1) for p in planes], axis=0).max()
    extent = np.ptp(surface, axis=0).max()
    if outside > LARGEST_OUTSIDE * extent:
        raise UnusableInput(
            f"the pieces of mesh {name} leave out {outside:.3g} of its extent of {extent:.3g}; close its holes, or "
            "leave `max_pieces` out for its hull"
        )
    return [_grown(piece, p, max(outside, 0.0) + 1e-6 * extent) for piece, p in zip(pieces, planes, strict=True)]


def _grown(piece: Array, planes: Array, distance: float) -> Array:
    """Return a piece made larger about its middle, so that each of its planes lies farther out by a distance."""
    middle = piece.mean(axis=0)
    thinnest = -(planes[:, :3] @ middle + planes[:, 3]).max()
    grown: Array = middle + (piece - middle) * (1.0 + distance / thinnest)
    return grown


def _mesh(content: bytes, name: str) -> trimesh.Trimesh:
    _need("trimesh")
    import trimesh

    try:
        loaded = trimesh.load(io.BytesIO(content), file_type=name.rpartition(".")[2].lower(), force="mesh")
        if isinstance(loaded, trimesh.Trimesh) and np.all(np.isfinite(loaded.vertices)):
            return loaded
    except Exception as error:  # a reader of foreign files raises what it meets
        raise UnusableInput(f"mesh {name} cannot be read: {error or type(error).__name__}") from None
    raise UnusableInput(f"mesh {name} holds no body with finite corners")


def _need(library: str) -> None:
    if find_spec(library) is None:
        raise UnusableInput(f"this mesh needs {library}, which is not installed: pip install 'teachpath[meshes]'")
