"""Scenes on the command line, against a service on a real port: from files, by name, and back again."""

import json
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import TeachpathError
from teachpath_client import Station
from teachpath_client.errors import ClientError, Refused

SCENE = """
name = "shelf"
floor = -0.2
carried = {name = "cup", kind = "cylinder", size = [0.03, 0.1], position = [0.5, 0.1, 0.55], color = 0xE8C547}

[[obstacles]]
name = "bracket"
kind = "mesh"
size = [0.001]
position = [0.6, 0, 0.5]
file = "bracket.obj"

[[keep_in]]
name = "cell"
kind = "box"
size = [3, 3, 3]
position = [0, 0, 1]
"""


@pytest.fixture
def url(port: int) -> str:
    return f"http://127.0.0.1:{port}"


@pytest.fixture
def file(tmp_path: Path, url: str) -> Iterator[Path]:
    """A scene in a file, which no station has before or after the test."""
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in product((0, 90), repeat=3))
    (tmp_path / "bracket.obj").write_text(corners)
    file = tmp_path / "shelf.toml"
    file.write_text(SCENE)
    yield file
    with Station(url) as station:
        for scene in station.scenes():
            if scene.name not in ("paper", "empty"):
                station.remove_scene(scene.name)


def said(url: str, *words: str) -> str:
    return CliRunner().invoke(app, ["scene", *words, "--url", url], catch_exceptions=False).stdout


def test_a_scene_goes_from_a_file_to_the_station_and_back(file: Path, url: str) -> None:
    assert said(url, "add", str(file), "--note", "measured").startswith("scene shelf, version ")
    shown = said(url, "show", "shelf")
    assert all(word in shown for word in ("measured", "bracket", "mesh", "0.600, 0.000, 0.500", "cup", "0.03 x 0.1"))
    written = json.loads(said(url, "show", "shelf", "--json"))
    assert (written["floor"], len(written["obstacles"][0]["vertices"])) == (-0.2, 36)
    back = file.with_suffix(".json")
    back.write_text(json.dumps(written))
    before = said(url, "versions", "shelf")
    said(url, "add", str(back))
    assert said(url, "versions", "shelf") == before
    said(url, "add", str(back), "--name", "second")
    assert json.loads(said(url, "show", "second", "--json")) == written | {"name": "second"}


def test_a_scene_is_copied_removed_and_brought_back(file: Path, url: str) -> None:
    said(url, "add", str(file))
    with Station(url) as station:
        first = station.scene_versions("shelf")[0].number
        document = station.get_scene("shelf").scene
        station.save_scene("shelf", {"floor": -0.5})
        assert "bring it back with: teachpath scene restore shelf" in said(url, "remove", "shelf")
        with pytest.raises(Refused, match="there is no scene 'shelf' any more"):
            station.get_scene("shelf")
        assert "removed" in said(url, "versions", "shelf")
        said(url, "restore", "shelf")
        assert station.get_scene("shelf").scene.floor == -0.5
        restored = json.loads(said(url, "restore", "shelf", "--version", str(first), "--json"))
        assert restored["number"] == station.scene_versions("shelf")[0].number
        assert station.get_scene("shelf").scene == document
        assert station.get_scene("shelf", first).version.number == first
        copy = f"shelf-{first}"  # a name is copied to once
        assert json.loads(said(url, "copy", "shelf", copy, "--json"))["scene"] == copy
        assert station.get_scene(copy).scene.obstacles == document.obstacles


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("s.toml", "name = ", "s.toml is not TOML; a file in JSON ends in .json: "),
        ("s.json", "name = 3", "s.json is not JSON: "),
        ("s.json", "3", "s.json holds no scene"),
        ("s.json", "[]", "s.json holds no scene"),
        ("s.toml", "[[scenes]]\nfloor = 0\n[[scenes]]\n", "scene 1 of .*s.toml has no name"),
        ("s.toml", 'obstacles = [{name = "m", kind = "mesh", file = "none.stl"}]', "cannot read the mesh .*none.stl"),
        ("s.toml", "flor = 0", "there is no field 'flor'; did you mean floor?"),
        ("s.toml", "obstacles = 3", "body.obstacles: it should be a valid list"),
        ("--.toml", "floor = 0", "'--' cannot name a scene"),
    ],
)
def test_a_file_that_is_no_scene_is_a_sentence(tmp_path: Path, url: str, name: str, text: str, sentence: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises((TeachpathError, ClientError), match=sentence):
        said(url, "add", str(tmp_path / name))
    with pytest.raises(TeachpathError, match=r"cannot read the scene .*: No such file"):
        said(url, "add", str(tmp_path / "none.toml"))
