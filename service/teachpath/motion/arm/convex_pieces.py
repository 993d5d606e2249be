"""Shapes apart: a mesh of several convex pieces becomes one shape for each, which planner and simulator can take."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import accumulate, pairwise

from teachpath.records import Shape

SEPARATOR = "/"  # in no name of a shape


def convex_shapes(shapes: Iterable[Shape]) -> Iterator[Shape]:
    """Yield shapes, a mesh of several pieces as several, named `NAME/1`, `NAME/2` and so on."""
    for shape in shapes:
        if not shape.pieces:
            yield shape
            continue
        bounds = pairwise(accumulate((3 * triangles for triangles in shape.pieces), initial=0))
        for number, (begin, end) in enumerate(bounds, start=1):
            name = f"{shape.name}{SEPARATOR}{number}"
            yield replace(shape, name=name, vertices=shape.vertices[begin:end], pieces=())


def whole_name(piece: str) -> str:
    """Return the name of the shape that a piece belongs to."""
    return piece.partition(SEPARATOR)[0]
