"""What a sentence says of a length is true in its digits."""

from __future__ import annotations

import re

import numpy as np
import pytest

from teachpath.lengths import describe_length, describe_lengths

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "µm": 1e-6}
LENGTHS = [
    *(10 ** np.random.default_rng(1).uniform(-8, 3, 300)),
    0.00995,
    0.00996,
    0.0999,
    0.995,
    0.999,
    1e-5,
    0.01,
    1.0,
]


def told(sentence: str) -> float:
    """Read a length back [m]."""
    number, unit = sentence.split()
    assert re.fullmatch(r"-?\d+(\.\d+)?", number), sentence
    return float(number) * METRES[unit]


@pytest.mark.parametrize("digits", [2, 3, 5])
def test_a_length_is_told_to_its_digits(digits: int) -> None:
    for length in LENGTHS:
        assert told(describe_length(length, digits=digits)) == pytest.approx(length, rel=0.51 * 10 ** (1 - digits))
        assert told(describe_length(-length, digits=digits)) == -told(describe_length(length, digits=digits))


def test_a_limit_is_never_told_too_low_nor_a_digit_too_high() -> None:
    for length in LENGTHS:
        limit = told(describe_length(length, up=True))
        assert length * (1 - 1e-9) <= limit <= length * 1.11


def test_no_length_but_none_is_told_as_nothing() -> None:
    assert min(told(describe_length(length)) for length in LENGTHS) > 0
    assert describe_length(0.0) == "0 mm"


def test_lengths_that_differ_are_told_apart() -> None:
    for length in LENGTHS:
        one, other = describe_lengths(length, length * 1.0003)
        assert one != other
        assert told(one) < told(other)
    assert len(set(describe_lengths(0.005, 0.005))) == 1
