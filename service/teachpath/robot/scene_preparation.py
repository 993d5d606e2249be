"""Scenes that somebody gives, made ready: their meshes become convex hulls, and they are built around the arm."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io import meshes
from teachpath.io.meshes import Mesh, convex_hull, joined
from teachpath.motion.arm.convex_pieces import convex_shapes
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.collision.scene_checks import check_scene
from teachpath.records import Scene, Shape, Vector

MAX_TRIANGLES: Final = 10_000  # of what takes the place of a mesh
DIGITS: Final = (
    6  # of the corners of a mesh that is sent on its way into a scene, so that a scene with it may be sent back
)


def prepared_scene(scene: Scene, arm: Arm) -> Scene:
    """Return a scene that somebody gave with the convex hulls of its meshes, after it was built around an arm.

    Raises:
        UnusableInput: a name, a shape or a mesh that cannot be; the sentence names it.
    """
    check_scene(scene)
    prepared = replace(
        scene,
        obstacles=tuple(map(_with_hulls, scene.obstacles)),
        carried=scene.carried and _with_hulls(scene.carried),
        keep_in=tuple(map(_with_hulls, scene.keep_in)),
        keep_out=tuple(map(_with_hulls, scene.keep_out)),
    )
    CollisionModel(prepared, arm)
    return prepared


def read_mesh(file: Path, name: str, max_pieces: int = 1) -> Mesh:
    """Return the convex hull or pieces of a mesh that somebody sent, three corners a triangle, in the file's units.

    The corners are rounded to a millionth of the power of ten below the mesh's extent; the hull of a scene is made
    anew when it is saved.

    Args:
        file: where it is.
        name: that it goes by.
        max_pieces: most convex pieces; 1: its hull.

    Raises:
        UnusableInput: no mesh that can be in a scene.
    """
    mesh = meshes.read_mesh(file, name, max_pieces)
    _check_size(mesh, name)
    extent = float(np.ptp(np.array(mesh.vertices), axis=0).max())
    decimals = DIGITS - int(np.floor(np.log10(extent)))
    vertices = ((round(x, decimals), round(y, decimals), round(z, decimals)) for x, y, z in mesh.vertices)
    return Mesh(tuple(vertices), mesh.pieces)


def _check_size(mesh: Mesh, name: str) -> None:
    if len(mesh.vertices) > 3 * MAX_TRIANGLES:
        raise UnusableInput(
            f"what takes the place of mesh {name} has {len(mesh.vertices) // 3} triangles, limit {MAX_TRIANGLES}; "
            "simplify it, or ask for fewer pieces"
        )


def _with_hulls(shape: Shape) -> Shape:
    """Return a mesh of convex hulls; what is one already stays as it is, to the order of its triangles."""
    if not shape.vertices:
        return shape
    mesh = joined(_hull(piece) for piece in convex_shapes([shape]))
    _check_size(mesh, shape.name)
    return replace(shape, vertices=mesh.vertices, pieces=mesh.pieces)


def _hull(piece: Shape) -> tuple[Vector, ...]:
    hull = convex_hull(piece.vertices, piece.name)
    is_hull = len(hull) == len(piece.vertices) and set(hull) == set(piece.vertices)
    return piece.vertices if is_hull else hull
