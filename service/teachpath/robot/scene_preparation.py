"""Scenes that somebody gives, made ready: their meshes become convex hulls, and they are built around the arm."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.meshes import convex_hull, read_hull
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.collision.scene_checks import check_scene
from teachpath.records import Scene, Shape, Vector

MAX_TRIANGLES: Final = 10_000  # of the hull of a mesh
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
        obstacles=tuple(map(_with_hull, scene.obstacles)),
        carried=scene.carried and _with_hull(scene.carried),
        keep_in=tuple(map(_with_hull, scene.keep_in)),
        keep_out=tuple(map(_with_hull, scene.keep_out)),
    )
    CollisionModel(prepared, arm)
    return prepared


def read_mesh(file: Path, name: str) -> tuple[Vector, ...]:
    """Return the convex hull of a mesh that somebody sent, three corners a triangle, in the file's units.

    The corners are rounded to a millionth of the power of ten below the mesh's extent; the hull of a scene is made
    anew when it is saved.

    Args:
        file: where it is.
        name: that it goes by.

    Raises:
        UnusableInput: no mesh that can be in a scene.
    """
    hull = read_hull(file, name)
    _check_size(hull, name)
    extent = float(np.ptp(np.array(hull), axis=0).max())
    decimals = DIGITS - int(np.floor(np.log10(extent)))
    return tuple((round(x, decimals), round(y, decimals), round(z, decimals)) for x, y, z in hull)


def _check_size(hull: tuple[Vector, ...], name: str) -> None:
    if len(hull) > 3 * MAX_TRIANGLES:
        raise UnusableInput(
            f"the convex hull of mesh {name} has {len(hull) // 3} triangles, limit {MAX_TRIANGLES}; simplify it"
        )


def _with_hull(shape: Shape) -> Shape:
    """Return a mesh with its convex hull; one that is a hull already stays as it is, to the order of its triangles."""
    if not shape.vertices:
        return shape
    hull = convex_hull(shape.vertices, shape.name)
    _check_size(hull, shape.name)
    is_hull = len(hull) == len(shape.vertices) and set(hull) == set(shape.vertices)
    return shape if is_hull else replace(shape, vertices=hull)
