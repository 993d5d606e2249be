"""The rules of a scene: names, and the kinds, sizes and orientations of its shapes."""

from __future__ import annotations

import math
from typing import Final

from teachpath.errors import UnusableInput
from teachpath.records import Scene, Shape
from teachpath_proto.display_names import checked_display_name
from teachpath_proto.keys import is_name, name_refusal

SIZES: Final = {"box": 3, "cylinder": 2, "sphere": 1, "mesh": 1}  # numbers in the size of a shape
MIN_MASS, MAX_MASS = 1e-4, 100.0  # [kg] of the object


def check_scene(scene: Scene) -> None:
    """Raise UnusableInput where no scene can be so; the sentence names the shape."""
    if not is_name(scene.name):
        raise UnusableInput(name_refusal("scene", scene.name))
    try:
        checked_display_name(scene.display_name)
    except ValueError as error:
        raise UnusableInput(f"scene {scene.name}: {error}") from None
    known: set[str] = set()
    for shape in scene.bodies:
        what = f"body of scene {scene.name}"
        if not is_name(shape.name):
            raise UnusableInput(name_refusal(what, shape.name))
        if shape.name in known:
            raise UnusableInput(f"there are two bodies {shape.name} in scene {scene.name}; rename one of them")
        known.add(shape.name)
        _check_shape(shape, scene.name)
        _check_mass(shape, scene)
        if shape.pieces and shape is scene.carried:
            raise UnusableInput(
                f"{shape.name} in scene {scene.name} is carried and has {len(shape.pieces)} pieces; a carried mesh is "
                "its hull, leave `max_pieces` out"
            )
    for zone in scene.keep_in:
        if zone.kind != "box":
            raise UnusableInput(f"keep-in zone {zone.name} in scene {scene.name} is a {zone.kind}; use a box")


def _check_shape(shape: Shape, scene: str) -> None:
    who = f"{shape.name} in scene {scene}"
    if shape.kind not in SIZES:
        raise UnusableInput(f"{who} is a {shape.kind!r}; known are {', '.join(SIZES)}")
    if len(shape.size) != SIZES[shape.kind] or min(shape.size) <= 0:
        raise UnusableInput(f"{who} has size {shape.size}; a {shape.kind} has {SIZES[shape.kind]} lengths over 0")
    if not math.isclose(norm := math.hypot(*shape.orientation), 1.0, abs_tol=1e-6):
        raise UnusableInput(f"{who} has an orientation of length {norm:g}; a unit quaternion has 1")
    if (shape.kind == "mesh") != bool(shape.vertices):
        raise UnusableInput(f"{who} is a {shape.kind}; a mesh, and only a mesh, has a file")
    if shape.pieces and (min(shape.pieces) < 4 or 3 * sum(shape.pieces) != len(shape.vertices)):
        raise UnusableInput(
            f"{who} has pieces of {', '.join(map(str, shape.pieces))} triangles and {len(shape.vertices)} vertices; a "
            "piece has 4 triangles at least, a triangle 3 vertices"
        )


def _check_mass(shape: Shape, scene: Scene) -> None:
    if shape.mass is None:
        return
    if shape is not scene.carried:
        raise UnusableInput(
            f"{shape.name} in scene {scene.name} has a mass; only the carried object has one, leave it out here"
        )
    if not MIN_MASS <= shape.mass <= MAX_MASS:
        raise UnusableInput(
            f"{shape.name} in scene {scene.name} has a mass of {shape.mass:g} kg; an object has {MIN_MASS:g} to "
            f"{MAX_MASS:g} kg"
        )
