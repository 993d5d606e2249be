"""Arms from models on the command line."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import NotFound, UnusableInput


def said(data: Path, *words: str) -> str:
    environment = {"COLUMNS": "200"}
    return CliRunner().invoke(app, ["arm", *words, "--data", str(data)], env=environment, catch_exceptions=False).stdout


def test_an_arm_is_added_with_versions_and_listed(tmp_path: Path) -> None:
    assert "arm light@1: 6 joints" in said(tmp_path, "add", "light", "six-axis")
    assert "arm light@1" in said(tmp_path, "add", "light", "six-axis")  # the same one
    assert "arm light@2" in said(tmp_path, "add", "light", "six-axis", "--base", "0,0,0.5")
    assert "teachpath serve --arm seven" in said(tmp_path, "add", "seven", "seven-axis", "--tool", "link7")
    assert "arm light@3" in said(tmp_path, "add", "light", "six-axis", "--base", "0,0,0.5", "--gripper")
    assert re.search(r"light +3 +6 .*\n.*seven +1 +7", said(tmp_path, "list"))


def test_a_check_says_who_gave_limits_and_what_may_collide(tmp_path: Path) -> None:
    said(tmp_path, "add", "seven", "seven-axis")
    checked = said(tmp_path, "check", "seven")
    assert re.search(r"joint4 +-171.9 to -5.7 +1 \(default\) .*87", checked)
    assert "these overlap in some: base and link5, " in checked
    assert "nobody says the speed of 7 joints; taken as 1\n" in checked
    with pytest.raises(NotFound, match="there is no arm 'eight'; list them with: teachpath arm list"):
        said(tmp_path, "check", "eight")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("a/b", "six-axis"), "'a/b' cannot name a"),
        (("light", "six.urdf"), "cannot read the model six.urdf"),
        (("light", "six-axis", "--base", "1,2"), "--base 1,2 is not x,y,z or x,y,z,qw,qx,qy,qz"),
        (("light", "six-axis", "--base", "0,0,0,1,1,0,0"), "write a quaternion"),
        (("light", "six-axis", "--tool", "hand"), "has no body or site 'hand'"),
    ],
)
def test_what_cannot_be_added_is_a_sentence(tmp_path: Path, words: tuple[str, ...], sentence: str) -> None:
    with pytest.raises(UnusableInput, match=sentence):
        said(tmp_path, "add", *words)
    assert said(tmp_path, "list") == ""
