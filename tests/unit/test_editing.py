"""Operations leave the shape, what cannot be edited is refused in a sentence, and differences are distances."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from teachpath.editing import (
    MAX_CONTROL_POINTS,
    MAX_COORDINATE,
    MIN_KNOT_SPACING,
    WEIGHT_LIMITS,
    check_editable,
    difference,
    elevate_degree,
    insert_knot,
    remove_knot,
)
from teachpath.errors import UnusableInput
from teachpath.exchange import SAME_SHAPE_TOLERANCE, from_json, to_json
from teachpath.nurbs import Curve

U = np.linspace(0.0, 1.0, 401)
TIGHT_TOLERANCE = 1e-9  # m, of operations that are exact but for rounding


@st.composite
def curves(draw: st.DrawFn, degrees: tuple[int, int] = (1, 6)) -> Curve:
    """Any curve about the size of a table, its inner knots at least a thousandth apart or the same."""
    degree = draw(st.integers(*degrees))
    inner = sorted(draw(st.lists(st.integers(1, 999), max_size=8)))
    kept = [k for i, k in enumerate(inner) if i < degree or inner[i - degree] != k]
    count = degree + 1 + len(kept)
    knots = np.r_[np.zeros(degree + 1), np.array(kept) / 1000, np.ones(degree + 1)]
    points = draw(arrays(np.float64, (count, 3), elements=st.floats(-1.0, 1.0, width=32)))
    points[-1] = points[0] + [0.5, 0.0, 0.0]
    weights = draw(arrays(np.float64, count, elements=st.floats(0.25, 4.0, width=32)))
    return Curve(degree, knots, points, weights)


PARAMETERS = st.floats(0.0, 1.0, exclude_min=True, exclude_max=True).filter(lambda u: 1e-4 < u < 1 - 1e-4)


def inserted(curve: Curve, u: float) -> Curve | None:
    nearest = float(curve.knots[np.argmin(np.abs(curve.knots - u))])
    if abs(nearest - u) < MIN_KNOT_SPACING and np.sum(curve.knots == nearest) >= curve.degree:
        with pytest.raises(UnusableInput, match="times already"):
            insert_knot(curve, u)
        return None
    return insert_knot(curve, u).curve


@settings(max_examples=60, deadline=None)
@given(curve=curves(), u=PARAMETERS)
def test_an_inserted_knot_adds_a_control_point_and_leaves_the_shape(curve: Curve, u: float) -> None:
    more = inserted(curve, u)
    if more is not None:
        assert len(more.control_points) == len(curve.control_points) + 1
        assert np.abs(more(U) - curve(U)).max() <= TIGHT_TOLERANCE


@settings(max_examples=60, deadline=None)
@given(curve=curves(), u=PARAMETERS)
def test_an_inserted_knot_can_be_removed_again(curve: Curve, u: float) -> None:
    more = inserted(curve, u)
    if more is not None:
        knot = float(more.knots[np.argmin(np.abs(more.knots - u))])
        back = remove_knot(more, knot)
        assert back.deviation <= SAME_SHAPE_TOLERANCE
        assert np.array_equal(back.curve.knots, curve.knots)
        assert np.abs(back.curve(U) - curve(U)).max() <= SAME_SHAPE_TOLERANCE


@settings(max_examples=60, deadline=None)
@given(curve=curves(degrees=(2, 5)), pick=st.integers(0, 20), millimetres=st.sampled_from([0.001, 1.0, 30.0, 100.0]))
def test_a_removed_knot_moves_the_curve_by_its_tolerance_at_most(curve: Curve, pick: int, millimetres: float) -> None:
    inner = curve.knots[curve.degree + 1 : -curve.degree - 1]
    if len(inner):
        u = float(inner[pick % len(inner)])
        try:
            fewer = remove_knot(curve, u, tolerance=millimetres / 1000)
        except UnusableInput:
            return
        assert len(fewer.curve.control_points) == len(curve.control_points) - 1
        assert np.linalg.norm(fewer.curve(U) - curve(U), axis=1).max() <= millimetres / 1000 * 1.02


@settings(max_examples=60, deadline=None)
@given(curve=curves())
def test_a_raised_degree_leaves_the_shape_and_every_corner(curve: Curve) -> None:
    raised = elevate_degree(curve)
    assert raised.curve.degree == curve.degree + 1
    assert raised.deviation <= TIGHT_TOLERANCE
    before = dict(zip(*np.unique(curve.knots, return_counts=True), strict=True))
    after = dict(zip(*np.unique(raised.curve.knots, return_counts=True), strict=True))
    assert after == {u: count + 1 for u, count in before.items()}


@settings(max_examples=30, deadline=None)
@given(curve=curves(), u=PARAMETERS)
def test_operations_on_different_knots_can_be_exchanged(curve: Curve, u: float) -> None:
    more = inserted(curve, u)
    if more is not None:
        assert np.abs(elevate_degree(more).curve(U) - elevate_degree(curve).curve(U)).max() <= TIGHT_TOLERANCE


@settings(max_examples=40, deadline=None)
@given(curve=curves())
def test_a_curve_survives_geomdls_file_to_the_last_bit(curve: Curve) -> None:
    again = from_json(to_json(curve))
    for name in ("degree", "knots", "control_points", "weights"):
        assert np.array_equal(getattr(again, name), getattr(curve, name))


# differences


def straight(height: float = 0.5, count: int = 6) -> Curve:
    points = np.column_stack([np.linspace(0.2, 0.8, count), np.zeros(count), np.full(count, height)])
    knots = np.r_[np.zeros(3), np.linspace(0, 1, count - 2), np.ones(3)]
    return Curve(3, knots, points, np.ones(count))


@settings(max_examples=10, deadline=None)
@given(curve=curves(), u=PARAMETERS)
def test_what_leaves_the_shape_is_no_difference(curve: Curve, u: float) -> None:
    for same in (curve, elevate_degree(curve).curve, inserted(curve, u) or curve):
        found = difference(curve, same)
        assert found.largest < SAME_SHAPE_TOLERANCE
        assert (found.moved, found.sentence) == ((), "the shape is the same; no control point was moved")


def test_two_parallel_lines_lie_as_far_apart_as_they_do() -> None:
    found = difference(straight(0.5), straight(0.53))
    assert found.largest == pytest.approx(0.03, abs=1e-9)
    assert found.mean == pytest.approx(0.03, abs=1e-9)
    assert [m.number for m in found.moved or ()] == [1, 2, 3, 4, 5, 6]
    assert all(m.distance == pytest.approx(0.03) for m in found.moved or ())


@settings(max_examples=20, deadline=None)
@given(a=curves(), b=curves())
def test_the_distance_is_the_same_from_both_sides_and_no_less_than_the_mean(a: Curve, b: Curve) -> None:
    there, back = difference(a, b), difference(b, a)
    assert there.largest == pytest.approx(back.largest, abs=1e-12)
    assert there.mean == pytest.approx(back.mean, abs=1e-12)
    assert 0 <= there.mean <= there.largest
    along = np.linalg.norm(np.diff(b(np.linspace(0.0, 1.0, 8001)), axis=0), axis=1).sum()
    assert 0 <= there.s <= along + 1e-12


def test_one_moved_control_point_and_one_weight_are_named_even_behind_a_new_knot() -> None:
    curve = straight()
    points, weights = np.array(curve.control_points), np.array(curve.weights)
    points[2, 2] += 0.04
    weights[4] = 2.0
    edited = Curve(3, curve.knots, points, weights)
    found = difference(curve, edited)
    assert [(m.number, round(m.distance, 9), m.weights) for m in found.moved or ()] == [
        (3, 0.04, (1.0, 1.0)),
        (5, 0.0, (1.0, 2.0)),
    ]
    assert 0 < found.largest < 0.04
    assert found.sentence.endswith("changed: control points 3, 5 of the second")
    assert {
        m.number for m in difference(insert_knot(curve, 0.9).curve, insert_knot(edited, 0.9).curve).moved or ()
    } >= {3, 5}


def test_where_a_knot_was_removed_there_are_no_counterparts() -> None:
    curve = straight()
    fewer = remove_knot(curve, float(curve.knots[4]), tolerance=0.02).curve
    found = difference(curve, fewer)
    assert found.moved is None
    assert "no counterparts" in found.sentence
    assert difference(fewer, insert_knot(fewer, 0.5).curve).moved == ()


# what cannot be edited


def changed(**fields: object) -> Curve:
    curve = straight()
    values = {"degree": 3, "knots": curve.knots, "control_points": curve.control_points, "weights": curve.weights}
    return Curve(**{**values, **fields})  # type: ignore[arg-type]


NAN, FAR_CURVE, POINTS = float("nan"), np.array([1e300, 0, 0]), straight().control_points
INVALID_CURVES = {
    "has a knot, control point or weight that is not finite": {"weights": [1, 1, NAN, 1, 1, 1]},
    "need 6 weights, got 5": {"weights": np.ones(5)},
    "need 10 knots, got 9": {"knots": straight().knots[1:]},
    "must not decrease": {"knots": [0, 0, 0, 0, 0.7, 0.4, 1, 1, 1, 1]},
    "begins with 4 knots 0": {"knots": np.linspace(0, 1, 10)},
    "weights are positive": {"weights": [1, 1, 0, 1, 1, 1]},
    f"limits {WEIGHT_LIMITS[0]:g} to {WEIGHT_LIMITS[1]:g}; move": {"weights": [1, 1, 1e4, 1, 1, 1]},
    f"control point 1 is 1e+300 m away, limit {MAX_COORDINATE:g}; use metres": {"control_points": POINTS + FAR_CURVE},
    "a path has 3 (x, y, z)": {"control_points": POINTS[:, :2]},
    "all control points lie in one place": {"control_points": np.zeros((6, 3))},
    "outside 1 to 7": {"degree": 9},
}


@pytest.mark.parametrize("sentence", INVALID_CURVES)
def test_what_cannot_be_edited_is_refused_in_a_sentence(sentence: str) -> None:
    with pytest.raises(UnusableInput) as caught:
        check_editable(changed(**INVALID_CURVES[sentence]))
    assert sentence in str(caught.value)


def test_a_torn_curve_and_a_huge_one_are_refused() -> None:
    torn = np.r_[np.zeros(2), 0.5, 0.5, np.ones(2)]
    with pytest.raises(UnusableInput, match=r"u = 0\.5 is a knot 2 times; more than degree 1 tears"):
        check_editable(Curve(1, torn, POINTS[:4], np.ones(4)))
    with pytest.raises(UnusableInput, match=f"501 control points are over the limit of {MAX_CONTROL_POINTS}"):
        check_editable(straight(count=MAX_CONTROL_POINTS + 1))
    with pytest.raises(UnusableInput, match="which is the limit"):
        insert_knot(straight(count=MAX_CONTROL_POINTS), 0.5)
    with pytest.raises(UnusableInput, match="remove knots"):
        elevate_degree(straight(count=400))


@pytest.mark.parametrize("tolerance", [0.0, -1.0, NAN, 1.0])
def test_a_tolerance_that_is_none_is_refused(tolerance: float) -> None:
    with pytest.raises(UnusableInput, match=r"outside 0 to 0\.1"):
        remove_knot(straight(), 0.5, tolerance=tolerance)


def test_the_highest_degree_is_not_raised() -> None:
    with pytest.raises(UnusableInput, match="degree 7 is the highest"):
        elevate_degree(Curve(7, np.r_[np.zeros(8), np.ones(8)], straight(count=8).control_points, np.ones(8)))
