import numpy as np
import pytest

from teachpath import nurbs
from teachpath_client.curve_points import curve_points
from teachpath_client.models import Curve


@pytest.mark.parametrize("degree", range(1, 8))
def test_points_are_those_of_the_service(degree: int) -> None:
    rng = np.random.default_rng(degree)
    inner = np.sort(np.append(rng.uniform(0.1, 0.9, 4), [0.5] * min(degree, 3)))  # also knots that coincide
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    count = len(knots) - degree - 1
    controls, weights = rng.normal(size=(count, 3)), rng.uniform(0.2, 5.0, count)
    expected = nurbs.Curve(degree, knots, controls, weights)
    found = curve_points(Curve(degree, knots.tolist(), controls.tolist(), weights.tolist()), 101)
    np.testing.assert_allclose(found, expected(np.linspace(0.0, 1.0, 101)), rtol=0, atol=1e-12)
    np.testing.assert_allclose(found[[0, -1]], controls[[0, -1]], rtol=0, atol=1e-12)
