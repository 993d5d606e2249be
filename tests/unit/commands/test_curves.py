"""The formats in which `teachpath curve export` writes."""

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.commands.curves import FORMATS, curve_writer
from teachpath.errors import UnusableInput
from teachpath.exchange import from_json
from tests.unit.io.test_curve_files import CURVES, read_iges


def test_an_unknown_format_is_refused_before_anything_is_asked() -> None:
    with pytest.raises(UnusableInput, match="no format 'step' of curves; known: json, dxf, iges"):
        CliRunner().invoke(app, ["curve", "export", "path", "--format", "step"], catch_exceptions=False)


def test_every_format_is_a_whole_text_of_the_curve() -> None:
    texts = {name: curve_writer(name)(CURVES[1]) for name in FORMATS}
    assert all(text.endswith("\n") for text in texts.values())
    assert texts["dxf"].splitlines()[-1] == "EOF"
    for read in (from_json(texts["json"]), read_iges(texts["iges"])):
        assert read.control_points.tobytes() == CURVES[1].control_points.tobytes()
