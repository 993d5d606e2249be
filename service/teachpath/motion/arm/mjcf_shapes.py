"""Shapes of a scene or an arm as attributes of MJCF elements."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.records import Shape


def mesh_asset(shape: Shape, name: str) -> str:
    """Return the mesh of a shape of this kind, under a name."""
    return f'<mesh name={quoteattr(name)} vertex="{numbers(shape.size[0] * np.ravel(shape.vertices))}"/>'


def shape_attributes(shape: Shape, name: str) -> str:
    """Return kind and size of a shape; a mesh has the name of its asset.

    Raises:
        UnusableInput: it is neither box, cylinder, sphere nor mesh.
    """
    if shape.kind == "box" and len(shape.size) == 3:
        return f'type="box" size="{numbers(np.array(shape.size) / 2)}"'
    if shape.kind == "cylinder" and len(shape.size) == 2:
        return f'type="cylinder" size="{shape.size[0]!r} {shape.size[1] / 2!r}"'
    if shape.kind == "sphere" and len(shape.size) == 1:
        return f'type="sphere" size="{shape.size[0]!r}"'
    if shape.kind == "mesh" and len(shape.size) == 1 and len(shape.vertices) > 3:
        return f'type="mesh" mesh={quoteattr(name)}'
    raise UnusableInput(
        f"{shape.name!r} is a {shape.kind} of {len(shape.size)} sizes and {len(shape.vertices)} vertices; a scene has "
        "boxes of 3, cylinders of 2, spheres of 1 and meshes of 1 and 4 vertices at least"
    )


def color_text(color: int) -> str:
    """Return a colour with its opacity."""
    return f"{(color >> 16 & 255) / 255:.4f} {(color >> 8 & 255) / 255:.4f} {(color & 255) / 255:.4f} 1"


def numbers(values: object) -> str:
    """Return numbers to the last bit."""
    return " ".join(repr(float(v)) for v in np.ravel(np.asarray(values, dtype=np.float64)))
