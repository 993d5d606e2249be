"""What an operator says of demonstrations on the command line, against a service on a real port."""

import pytest
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import TeachpathError
from teachpath_client import ClientError
from tests.contract.desk import Desk, csv

TASK = "amended"


@pytest.fixture
def url(port: int) -> str:
    return f"http://127.0.0.1:{port}"


def said(url: str, *words: str) -> str:
    return CliRunner().invoke(app, [*words, "--url", url], catch_exceptions=False).stdout


def test_a_demonstration_is_marked_trimmed_discarded_and_all_is_taken_back(desk: Desk, url: str) -> None:
    (before,) = desk.import_(TASK, csv())
    one = ("amend", TASK, "1")
    assert "good" in said(url, *one, "--mark", "good")
    assert "good, trimmed" in said(url, *one, "--trim", "0.2,0.1")
    (trimmed,) = desk.get(f"/tasks/{TASK}/demonstrations").json()
    assert trimmed["trim"] == [before["grasp"] + 10, before["release"] - 5]
    assert "good, trimmed, discarded" in said(url, *one, "--discard")
    assert "trimmed, discarded" in said(url, "demonstrations", TASK)
    assert said(url, *one, "--restore", "--trim", "0,0", "--mark", "none") == f"{TASK} 1: clean; nothing said\n"
    assert desk.get(f"/tasks/{TASK}/demonstrations").json() == [before]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("7", "--mark", "bad"), "no demonstration 7; list them with: teachpath demonstrations refused"),
        (("1", "--trim", "0.7,0.7"), "--trim 0.7,0.7: together they must be under the 1.20 s from grasp to release"),
        (("1", "--trim", "-1,0"), "must be under"),
        (("1", "--trim", "1.1,0"), "needs at least 8 of them"),
        (("1", "--trim", "a"), "--trim a is not BEGIN,END in seconds"),
        ((("1",)), "say what is to be changed"),
    ],
)
def test_what_cannot_be_said_of_it_is_a_sentence(desk: Desk, url: str, words: tuple[str, ...], sentence: str) -> None:
    if not desk.get("/tasks/refused/demonstrations").is_success:
        desk.import_("refused", csv())
    with pytest.raises((TeachpathError, ClientError), match=sentence):
        said(url, "amend", "refused", *words)
