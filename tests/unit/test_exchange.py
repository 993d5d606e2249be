"""Knots go in and out without changing the shape; geomdl's own files are read and written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from geomdl import exchange as geomdl_exchange

from teachpath.errors import UnusableInput
from teachpath.exchange import from_geomdl, from_json, insert_knot, remove_knot, to_geomdl, to_json
from teachpath.nurbs import Curve

U = np.linspace(0.0, 1.0, 301)


def random_curve(seed: int, degree: int = 3, count: int = 8) -> Curve:
    rng = np.random.default_rng(seed)
    interior = np.sort(rng.uniform(0.05, 0.95, count - degree - 1))
    knots = np.concatenate([np.zeros(degree + 1), interior, np.ones(degree + 1)])
    return Curve(degree, knots, rng.normal(size=(count, 3)), rng.uniform(0.3, 3.0, count))


def test_a_curve_survives_the_way_to_geomdl_and_back() -> None:
    curve = random_curve(1)
    back = from_geomdl(to_geomdl(curve))
    np.testing.assert_allclose(back.control_points, curve.control_points, atol=1e-14)
    np.testing.assert_allclose(back.weights, curve.weights, atol=1e-14)
    np.testing.assert_array_equal(back.knots, curve.knots)


@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("u", [0.013, 0.5, 0.97])
def test_an_inserted_knot_leaves_the_shape(degree: int, u: float) -> None:
    curve = random_curve(degree, degree)
    more = insert_knot(curve, u)
    assert len(more.control_points) == len(curve.control_points) + 1
    assert u in more.knots
    np.testing.assert_allclose(more(U), curve(U), atol=1e-12)


def test_a_knot_may_be_inserted_up_to_the_degree_and_no_further() -> None:
    curve = random_curve(4)
    for _ in range(3):
        curve = insert_knot(curve, 0.5)
    with pytest.raises(UnusableInput, match="3 times already"):
        insert_knot(curve, 0.5)


@pytest.mark.parametrize("u", [0.0, 1.0, -0.2, float("nan")])
def test_a_knot_outside_is_refused(u: float) -> None:
    with pytest.raises(UnusableInput, match="outside the curve"):
        insert_knot(random_curve(5), u)


def test_an_inserted_knot_can_be_removed_again() -> None:
    curve = random_curve(6)
    back = remove_knot(insert_knot(curve, 0.4321), 0.4321)
    np.testing.assert_allclose(back.control_points, curve.control_points, atol=1e-9)
    np.testing.assert_allclose(back(U), curve(U), atol=1e-9)


def test_a_needed_knot_is_not_removed_unless_the_tolerance_allows() -> None:
    curve = random_curve(7)
    needed = float(curve.knots[5])
    with pytest.raises(UnusableInput, match="moves by"):
        remove_knot(curve, needed)
    assert len(remove_knot(curve, needed, tolerance=100.0).control_points) == 7


def test_removing_what_is_no_knot_names_the_knots() -> None:
    with pytest.raises(UnusableInput, match="no inner knot"):
        remove_knot(random_curve(8), 0.123456)


def test_json_goes_round_exactly() -> None:
    curve = random_curve(9)
    back = from_json(to_json(curve))
    for name in ("knots", "control_points", "weights"):
        np.testing.assert_array_equal(getattr(back, name), getattr(curve, name))


def test_geomdl_reads_what_we_write_and_we_read_what_geomdl_writes(tmp_path: Path) -> None:
    curve = random_curve(10)
    ours = tmp_path / "ours.json"
    ours.write_text(to_json(curve), encoding="utf-8")
    (twin,) = geomdl_exchange.import_json(str(ours))
    np.testing.assert_allclose(from_geomdl(twin)(U), curve(U), atol=1e-12)
    theirs = tmp_path / "theirs.json"
    geomdl_exchange.export_json(to_geomdl(curve), str(theirs))
    np.testing.assert_allclose(from_json(theirs.read_text(encoding="utf-8"))(U), curve(U), atol=1e-12)


@pytest.mark.parametrize("text", ["", "{}", '{"shape": 3}', '{"shape": {"type": "surface"}}', "[1"])
def test_what_is_no_curve_is_refused(text: str) -> None:
    with pytest.raises(UnusableInput):
        from_json(text)
