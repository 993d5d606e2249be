"""Meshes in convex pieces hold all of the surface, and leave free what is hollow."""

import itertools
from pathlib import Path

import numpy as np
import pytest
import scipy
import trimesh

from teachpath.errors import UnusableInput
from teachpath.io.mesh_pieces import grown_pieces
from teachpath.io.meshes import MAX_PIECES, Mesh, read_mesh

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])


def plate(size: tuple[float, float, float], middle: tuple[float, float, float]) -> trimesh.Trimesh:
    made = trimesh.creation.box(size)
    made.apply_translation(middle)
    return made


def hulls(mesh: Mesh) -> list[np.ndarray]:
    bounds = np.cumsum([0, *(3 * triangles for triangles in mesh.pieces)])
    corners = np.array(mesh.vertices)
    return [corners[begin:end] for begin, end in itertools.pairwise(bounds)]


def outside(places: np.ndarray, pieces: list[np.ndarray]) -> np.ndarray:
    """How far places are outside of the nearest plane of the piece that holds them best; negative: inside."""
    planes = [scipy.spatial.ConvexHull(piece).equations for piece in pieces]
    return np.min([(places @ p[:, :3].T + p[:, 3]).max(axis=1) for p in planes], axis=0)


def test_a_trough_in_pieces_holds_its_surface_and_leaves_its_inside_free(tmp_path: Path) -> None:
    walls = [plate((0.02, 0.1, 0.1), (side, 0.0, 0.05)) for side in (-0.09, 0.09)]
    trough = trimesh.util.concatenate([plate((0.2, 0.1, 0.02), (0.0, 0.0, 0.01)), *walls])
    for file in (tmp_path / "trough.glb", tmp_path / "trough.ply"):
        trough.export(file)
        whole = read_mesh(file)
        assert whole.pieces == ()
        np.testing.assert_allclose(np.ptp(whole.vertices, axis=0), (0.2, 0.1, 0.1), rtol=1e-6)
    cut = read_mesh(file, max_pieces=3)
    assert 2 <= len(cut.pieces) <= 3
    surface, _ = trimesh.sample.sample_surface(trough, 5000, seed=7)  # other places than it was judged at
    assert outside(surface, hulls(cut)).max() < 1e-5
    inside = np.random.default_rng(1).uniform((-0.07, -0.04, 0.04), (0.07, 0.04, 0.09), (500, 3))
    assert outside(inside, hulls(cut)).min() > 0.0
    assert outside(inside, [np.array(whole.vertices)]).max() < 0.0


def test_pieces_grow_by_what_they_leave_out_and_refuse_to_be_another_body() -> None:
    rng = np.random.default_rng(2)
    surface = CUBE + rng.uniform(-0.004, 0.004, (100, 8, 3))
    places = surface.reshape(-1, 3)
    (grown,) = grown_pieces([CUBE], places, "cube")
    assert outside(places, [CUBE]).max() > 0.003
    assert outside(places, [grown]).max() < 0.0
    with pytest.raises(UnusableInput, match="close its holes"):
        grown_pieces([CUBE], 1.1 * places, "cube")
    with pytest.raises(UnusableInput, match="flat piece"):
        grown_pieces([CUBE[:4]], places, "cube")


@pytest.mark.parametrize(
    ("name", "content", "max_pieces", "sentence"),
    [
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 900000000\n", 1, "mesh .*a.ply cannot be read"),
        ("a.glb", b"glTF\x02\0\0\0\xff\xff\xff\x7f", 1, "mesh .*a.glb cannot be read"),
        ("a.glb", b"", 3, "mesh .*a.glb cannot be read"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n", 3, "no triangles|cannot be read|holds no body"),
        ("a.stl", b"short", 3, "no triangles|cannot be read"),
        ("a.step", b"", 3, "known: .glb, .obj, .ply, .stl"),
        ("a.stl", b"", 0, f"1 to {MAX_PIECES} are possible"),
        ("a.stl", b"", MAX_PIECES + 1, f"1 to {MAX_PIECES} are possible"),
    ],
)
def test_what_is_no_mesh_is_refused_with_its_name(
    tmp_path: Path, name: str, content: bytes, max_pieces: int, sentence: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UnusableInput, match=sentence):
        read_mesh(tmp_path / name, max_pieces=max_pieces)
