"""Scenes that somebody gives, made ready: their meshes become convex hulls, and they are built around the arm."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.io.meshes import convex_hull
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.collision_model import CollisionModel
from teachpath.motion.collision.scene_checks import check_scene
from teachpath.records import Scene, Shape

MAX_TRIANGLES: Final = 10_000  # of the hull of a mesh


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


def _with_hull(shape: Shape) -> Shape:
    """Return a mesh with its convex hull; one that is a hull already stays as it is, to the order of its triangles."""
    if not shape.vertices:
        return shape
    hull = convex_hull(shape.vertices, shape.name)
    if len(hull) > 3 * MAX_TRIANGLES:
        raise UnusableInput(
            f"the convex hull of mesh {shape.name} has {len(hull) // 3} triangles, limit {MAX_TRIANGLES}; simplify it"
        )
    is_hull = len(hull) == len(shape.vertices) and set(hull) == set(shape.vertices)
    return shape if is_hull else replace(shape, vertices=hull)
