"""Curves as DXF and IGES: read back, they are the same curve."""

import io

import ezdxf
import numpy as np
import pytest

from teachpath.io.curve_dxf import curve_dxf
from teachpath.io.curve_iges import curve_iges
from teachpath.nurbs import Curve

PARAMETERS = np.linspace(0.0, 1.0, 501)


def a_curve(degree: int, count: int, *, rational: bool = True) -> Curve:
    chance = np.random.default_rng(degree)
    inner = np.linspace(0.0, 1.0, count - degree + 1)[1:-1] ** 1.3
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    weights = chance.uniform(0.3, 3.0, size=count) if rational else np.ones(count)
    return Curve(degree, knots, chance.normal(size=(count, 3)) * [1.0, 1e-7, 0.3], weights)


CURVES = [a_curve(1, 2), a_curve(3, 9), a_curve(3, 60, rational=False), a_curve(7, 20)]


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: f"degree {curve.degree}")
def test_dxf_holds_the_curve(curve: Curve) -> None:
    drawing = ezdxf.read(io.StringIO(curve_dxf(curve)))
    assert drawing.header["$INSUNITS"] == ezdxf.units.M
    (spline,) = drawing.modelspace()
    assert (spline.dxftype(), spline.dxf.degree) == ("SPLINE", curve.degree)
    assert spline.dxf.flags & spline.RATIONAL
    for read, own in ((spline.knots, curve.knots), (spline.weights, curve.weights)):
        np.testing.assert_array_equal(list(read), own)
    np.testing.assert_array_equal(np.array(list(spline.control_points)), curve.control_points)
    stored = Curve(spline.dxf.degree, list(spline.knots), np.array(list(spline.control_points)), list(spline.weights))
    np.testing.assert_allclose(stored(PARAMETERS), curve(PARAMETERS), rtol=0, atol=1e-9)
    drawn = np.array([tuple(point) for point in spline.construction_tool().points(PARAMETERS.tolist())])
    np.testing.assert_allclose(drawn, curve(PARAMETERS), rtol=0, atol=1e-7)  # ezdxf draws with knots of ten digits


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: f"degree {curve.degree}")
def test_iges_holds_the_curve(curve: Curve) -> None:
    again = read_iges(curve_iges(curve, "way"))
    np.testing.assert_array_equal(again.knots, curve.knots)
    np.testing.assert_array_equal(again.weights, curve.weights)
    np.testing.assert_array_equal(again.control_points, curve.control_points)
    np.testing.assert_allclose(again(PARAMETERS), curve(PARAMETERS), rtol=0, atol=1e-9)


def read_iges(content: str) -> Curve:
    """Read the only entity 126 of a file, as IGES 5.3 describes it."""
    lines = content.splitlines()
    assert {len(line) for line in lines} == {80}
    sections = {letter: [line for line in lines if line[72] == letter] for letter in "SGDPT"}
    assert sum(map(len, sections.values())) == len(lines)
    for numbered in sections.values():
        assert [int(line[73:]) for line in numbered] == list(range(1, len(numbered) + 1))
    assert sections["T"][0][:32] == "".join(f"{letter}{len(sections[letter]):7d}" for letter in "SGDP")
    heads = "".join(line[:72] for line in sections["G"]).split(",")
    assert heads[14:16] == ["6", "1HM"]  # behind the delimiters, of which the comma itself is split in two
    first, second = sections["D"]
    assert (int(first[:8]), int(first[8:16]), int(second[24:32])) == (126, 1, len(sections["P"]))
    assert all(int(line[64:72]) == 1 for line in sections["P"])
    text = "".join(line[:64].rstrip() for line in sections["P"])
    assert text.endswith(";")
    values = [float(value.replace("D", "e")) for value in text[:-1].split(",")]
    kind, upper, degree, _, _, polynomial, _ = map(int, values[:7])
    assert kind == 126
    knots, rest = np.split(np.array(values[7:]), [upper + degree + 2])
    weights, rest = np.split(rest, [upper + 1])
    points, rest = np.split(rest, [3 * (upper + 1)])
    assert rest.tolist() == [knots[0], knots[-1], 0.0, 0.0, 0.0]
    assert bool(polynomial) == bool(np.all(weights == weights[0]))
    return Curve(degree, knots, points.reshape(-1, 3), weights)
