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


def test_a_cylinder_stands_upright() -> None:
    sent = umsgpack.unpackb(commands.solid("/c", "cylinder", (0.1, 0.4), pose=commands.pose_of((1.0, 2.0, 3.0))))
    matrix = np.reshape(sent["object"]["object"]["matrix"], (4, 4)).T
    assert np.allclose(matrix @ [0, 0.2, 0, 1], [1, 2, 3.2, 1])  # three.js's y end is up


def test_an_unknown_shape_is_refused_with_its_name() -> None:
    with pytest.raises(UnusableInput, match="/x cannot be drawn: 'cone'"):
        commands.solid("/x", "cone", (1.0,))
