"""The page's unit tests compare it with what Python computes, not with what it once computed."""

import json
from typing import Any

import numpy as np
import pytest

from tests.page.fixtures import FIXTURES, FOLDER


@pytest.mark.parametrize("name", FIXTURES)
def test_a_fixture_holds_what_python_computes(name: str) -> None:
    stored = json.loads((FOLDER / f"{name}.json").read_text())
    assert_same(stored, FIXTURES[name](), name)


def test_there_is_no_other_fixture() -> None:
    assert {path.stem for path in FOLDER.iterdir()} == set(FIXTURES)


def assert_same(stored: Any, computed: Any, place: str) -> None:
    """Compare documents: figures to 1e-12, since the last bits of a sum are the processor's, all else exactly."""
    if isinstance(computed, float):
        np.testing.assert_allclose(stored, computed, rtol=1e-12, atol=1e-12, err_msg=place)
    elif isinstance(computed, list | tuple):
        assert len(stored) == len(computed), place
        for i, (left, right) in enumerate(zip(stored, computed, strict=True)):
            assert_same(left, right, f"{place}[{i}]")
    elif isinstance(computed, dict):
        assert stored.keys() == computed.keys(), place
        for key, value in computed.items():
            assert_same(stored[key], value, f"{place}.{key}")
    else:
        assert stored == computed, place
