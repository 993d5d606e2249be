"""The shapes that the viewer is sent."""

import numpy as np
import pytest
import umsgpack

from teachpath.errors import UnusableInput
from teachpath.live.preview import commands


def outward(vertices: np.ndarray, faces: np.ndarray) -> float:
    """Signed volume of a mesh: positive when its faces look outwards."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.sum(a * np.cross(b, c))) / 6


def test_a_prism_is_closed_and_looks_outwards() -> None:
    square = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    vertices, faces = commands.prism_mesh(square, 2.0, bevel=0.1)
    # a bevelled end is a frustum of height 0.1 between squares of 1.0 and 0.8
    assert outward(vertices, faces) == pytest.approx(1.8 + 2 * 0.1 / 3 * (1.0 + 0.64 + 0.8))
    assert np.allclose([vertices.min(axis=0), vertices.max(axis=0)], [[-0.5, -0.5, -1.0], [0.5, 0.5, 1.0]])


def test_a_tube_keeps_its_distance_from_the_curve() -> None:
    t = np.linspace(0, 4, 120)
    spiral = np.column_stack([np.cos(t), np.sin(t), 0.2 * t])
    vertices, faces = commands.tube_mesh(spiral, 0.05)
    rings = vertices.reshape(len(spiral), -1, 3)
    assert np.allclose(np.linalg.norm(rings - spiral[:, None], axis=2), 0.05)
    length = np.sum(np.linalg.norm(np.diff(spiral, axis=0), axis=1))
    assert outward(vertices, faces) == pytest.approx(np.pi * 0.05**2 * length, rel=0.1)
    # neighbouring rings are not twisted against each other
    assert np.max(np.linalg.norm(np.diff(rings, axis=0), axis=2)) < 0.06


def test_a_straight_tube_needs_no_special_case() -> None:
    line = np.linspace([0.0, 0, 0], [0, 0, 1.0], 5)
    vertices, _ = commands.tube_mesh(line, 0.1)
    assert np.all(np.isfinite(vertices))


def test_a_cylinder_stands_upright() -> None:
    sent = umsgpack.unpackb(commands.solid("/c", "cylinder", (0.1, 0.4), pose=commands.pose_of((1.0, 2.0, 3.0))))
    matrix = np.reshape(sent["object"]["object"]["matrix"], (4, 4)).T
    assert np.allclose(matrix @ [0, 0.2, 0, 1], [1, 2, 3.2, 1])  # three.js's y end is up


def test_an_unknown_shape_is_refused_with_its_name() -> None:
    with pytest.raises(UnusableInput, match="/x cannot be drawn: 'cone'"):
        commands.solid("/x", "cone", (1.0,))
