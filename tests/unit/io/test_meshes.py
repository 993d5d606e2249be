"""Meshes become the corners of their convex hull, and what is none is said to be none."""

import struct
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.io.meshes import read_mesh

CORNERS = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 3.0) for z in (0.0, 4.0)])
TRIANGLES = [[0, 1, 2], [1, 3, 2], [4, 6, 5], [5, 6, 7], [0, 4, 1], [1, 4, 5], [2, 3, 6], [3, 7, 6]]
INNER_SIZES = [1.0, 1.5, 2.0]


def obj() -> bytes:
    lines = ["# a box with a corner inside", *(f"v {x} {y} {z}" for x, y, z in [*CORNERS, INNER_SIZES])]
    return "\n".join([*lines, "vn 0 0 1", *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in TRIANGLES)]).encode()


def text_stl() -> bytes:
    facets = [
        "facet normal 0 0 0\nouter loop\n" + "\n".join(f"vertex {x} {y} {z}" for x, y, z in CORNERS[t]) + "\nendloop"
        for t in TRIANGLES
    ]
    return ("solid box\n" + "\nendfacet\n".join(facets) + "\nendfacet\nendsolid box\n").encode()


def binary_stl() -> bytes:
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[t].ravel(), 0) for t in TRIANGLES)
    return b"box".ljust(80) + struct.pack("<I", len(TRIANGLES)) + rows


@pytest.mark.parametrize(("name", "content"), [("a.obj", obj()), ("b.stl", text_stl()), ("c.STL", binary_stl())])
def test_a_mesh_is_read_as_its_hull(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    corners = np.array(read_mesh(tmp_path / name).vertices)
    assert {tuple(corner) for corner in corners} == {tuple(corner) for corner in CORNERS}
    triangles = corners.reshape(-1, 3, 3)
    outward = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert np.all(np.einsum("ij,ij->i", outward, triangles[:, 0] - INNER_SIZES) > 0)
    # By the divergence theorem the triangles enclose the box.
    assert np.einsum("ij,ij->", outward, triangles[:, 0]) / 6 == pytest.approx(24.0)


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("a.step", b"", "known: .glb, .obj, .ply, .stl"),
        ("a.obj", b"", "has 0 corners"),
        ("a.obj", b"v 1 2 nan\n" * 5, "not finite"),
        ("a.obj", b"v 1 2 three\n" * 5, "no number"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n", "is flat"),
        ("a.stl", binary_stl()[:-7], "is torn"),
        ("a.stl", b"short", "is torn"),
    ],
)
def test_what_is_no_mesh_is_refused_with_its_name(tmp_path: Path, name: str, content: bytes, sentence: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UnusableInput, match=sentence):
        read_mesh(tmp_path / name)
    with pytest.raises(UnusableInput, match="No such file"):
        read_mesh(tmp_path / "missing.stl")
