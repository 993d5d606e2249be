"""A curve as an IGES file with one entity 126 (rational B-spline curve), exact to the last bit of every number.

US Product Data Association: Initial Graphics Exchange Specification 5.3, sections 2.2 (the five sections of lines of 80
characters) and 4.23 (entity 126).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from teachpath.nurbs import Curve

ENTITY: Final = 126
PARAMETER_WIDTH: Final = 64  # columns of a line of parameters, in front of its directory entry
GLOBAL_WIDTH: Final = 72
METRES: Final = "6,1HM"  # flag and name of the unit


def curve_iges(curve: Curve, name: str = "path") -> str:
    """Write a curve of positions [m] as a file in metres.

    Args:
        curve: to write.
        name: of the product, ASCII.
    """
    parameters = _wrapped(_parameters(curve), PARAMETER_WIDTH)
    sections = {
        "S": ["A learned path of teachpath, in metres."],
        "G": _wrapped(_globals(name, curve), GLOBAL_WIDTH),
        "D": _directory(len(parameters)),
        "P": [f"{line:<{PARAMETER_WIDTH}}{1:8d}" for line in parameters],
    }
    lines = [
        f"{line:<72}{letter}{number:7d}" for letter, texts in sections.items() for number, line in enumerate(texts, 1)
    ]
    counts = "".join(f"{letter}{len(texts):7d}" for letter, texts in sections.items())
    return "".join(f"{line}\n" for line in [*lines, f"{counts:<72}T{1:7d}"])


def _parameters(curve: Curve) -> list[str]:
    """Return the parameters of entity 126."""
    polynomial = int(np.all(curve.weights == curve.weights[0]))
    closed = int(np.array_equal(curve.control_points[0], curve.control_points[-1]))
    whole = [ENTITY, len(curve.control_points) - 1, curve.degree, 0, closed, polynomial, 0]
    numbers = np.concatenate(
        [curve.knots, curve.weights, curve.control_points.ravel(), curve.knots[[0, -1]], np.zeros(3)]
    )
    return [*map(str, whole), *map(_number, numbers.tolist())]


def _globals(name: str, curve: Curve) -> list[str]:
    """Return the parameters of the global section: the units, and how fine and how large numbers are."""
    largest = float(np.abs(curve.control_points).max())
    texts = [_text(name), _text(f"{name}.igs"), _text("teachpath"), _text("teachpath")]
    numbers = ["32", "38", "6", "308", "15", _text(name), "1.0", METRES, "1", "0.001"]
    made = [_text("20000101.000000"), "1.0E-9", _number(largest), _text("teachpath"), _text("teachpath"), "11", "0"]
    return [_text(","), _text(";"), *texts, *numbers, *made, _text("20000101.000000")]


def _directory(parameter_lines: int) -> list[str]:
    """Return the two lines of the entity's entry."""
    first = [ENTITY, 1, 0, 0, 0, 0, 0, 0]
    second = [ENTITY, 0, 0, parameter_lines, 0]
    return [
        "".join(f"{value:8d}" for value in first) + "00000000",
        "".join(f"{value:8d}" for value in second) + " " * 16 + "PATH".rjust(8) + f"{0:8d}",
    ]


def _wrapped(parameters: Iterable[str], width: int) -> list[str]:
    """Return parameters on lines of at most `width` characters, with delimiters, none of them broken."""
    lines = [""]
    pieces = [f"{parameter}," for parameter in parameters]
    pieces[-1] = f"{pieces[-1][:-1]};"
    for piece in pieces:
        if len(lines[-1]) + len(piece) > width:
            lines.append("")
        lines[-1] += piece
    return lines


def _number(value: float) -> str:
    text = repr(value).replace("e", "D")  # D: double precision
    return text if "." in text else text.replace("D", ".0D")


def _text(text: str) -> str:
    return f"{len(text)}H{text}"
